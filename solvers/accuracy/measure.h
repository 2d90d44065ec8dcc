// SPDX-License-Identifier: BSD-3-Clause
// Measures the errors and the cost of one variant of interpolation on a tool space.
//
// The relative error of the force [P08, eq. 2] is |h − h*| / max(|h*|, f) with the exact force h*.
// The floor f is a thousandth of the largest force of the tool space within its limit: without it,
// tiny errors near rest would count as large ones.
//
// Where a rigid tool begins to touch, the force goes to zero and its error does not, so relative
// errors there are reported apart.
//
// The cells of a rigid tool's space do not fill a box. So closed paths are slides of the test
// points, with the tool lifted on the way back; faces, and places for timing, are those of the
// cells. A path or face counts only if nothing on it is extrapolated.
//
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "interpolation/interpolator.h"
#include "state_space/test_point.h"
#include "state_space/touch_space.h"
#include "storage/field_cache.h"

namespace palpate {

/// The floor of relative errors, as a share of the largest force.
inline constexpr double kErrorFloor = 1e-3;
/// The relative error that a hand can notice: the just noticeable difference of forces is about 10
/// %.
inline constexpr double kNoticeable = 0.1;

/// A method with its options, on a grid.
struct Variant {
  Method method = Method::energy_hermite;
  InterpolationOptions options;
  /// The factor by which the tool space is coarsened, see coarsen.h.
  std::int32_t factor = 1;
};

/// The name of a variant, such as 'RBF cubic, no intermediate states'.
[[nodiscard]] std::string to_string(const Variant& variant);

/// All variants that serve a tool space; empty: no chosen method serves it.
/// @param methods The methods to choose from; empty: all.
[[nodiscard]] std::vector<Variant> variants(const TouchToolSpace& tool_space,
                                            const std::vector<Method>& methods);

/// The class of a test point.
enum class PointClass {
  /// The point counts: it is regular, and the space says that it is inside.
  inside,
  /// The point is regular, in a marked region of the space.
  marked,
  /// The point is regular, beyond the configurations of the space.
  extrapolated,
  /// The point is not regular: it is inverted, unstable, or beyond a jump.
  irregular,
  /// The solve did not converge: nothing is known.
  failed,
};

/// Raw figures of a tool space, or of several together.
struct Measurement {
  /// The number of configurations and intermediate states, over all tool spaces.
  double samples = 0;
  /// The time to compute these, s on one core, as recorded with each of them.
  double precompute_seconds = 0;
  /// Setup time of the interpolation, s, and its memory, bytes.
  double setup_seconds = 0;
  double bytes = 0;
  /// Check-points along an axis, and their distance, m, as if all cells had the smallest size.
  std::int32_t resolution = 0;
  double spacing = 0;
  int tool_spaces = 0;

  /// The number of test points of each class, by the number of the class.
  std::vector<int> points = std::vector<int>(5, 0);
  /// Errors of the force at the points that count, relative and absolute, N. The relative ones
  /// leave out points where a rigid tool begins to touch.
  std::vector<double> relative;
  std::vector<double> absolute;
  /// The largest exact force at these points, N.
  double largest_force = 0;
  /// The errors that the mesh makes in the force there, as the space estimates them, N, and the
  /// number of estimates that are reliable; empty where the space or the method has none.
  std::vector<double> mesh;
  int reliable_mesh = 0;
  /// The same errors as they are measured, where the force on a finer mesh is known, and what is
  /// left of them where a reliable estimate is taken off, N.
  std::vector<double> measured_mesh;
  std::vector<double> left_mesh;
  /// Errors of the stiffness at the points of `relative`, |k − k*| / |k*|, with a floor like that
  /// of the force.
  std::vector<double> stiffness;
  /// The largest error of the displacement at any of sample_points(), as a share of the largest
  /// displacement in the space, or for a rigid tool of the largest at a test point. It is the error
  /// of the displayed field: from the modes, or for a rigid tool from the fields in the file of the
  /// space. So it is the same for all methods. It is empty if a rigid tool's space has no file.
  std::vector<double> displacement;
  /// Relative errors of the force in marked regions, and at points near rest or where a rigid tool
  /// begins to touch.
  std::vector<double> marked;
  std::vector<double> near_rest;
  /// Relative errors at points that are regular, but beyond the configurations.
  std::vector<double> extrapolated;
  /// |∮ h·dt| of each closed path, divided by the largest energy on it.
  std::vector<double> loop_work;
  /// Jumps across faces between cells, as shares of the largest force and stiffness.
  std::vector<double> force_jump;
  std::vector<double> stiffness_jump;
  /// Times of one evaluation, ns.
  std::vector<double> nanoseconds;

  Measurement& operator+=(const Measurement& other);
};

/// Solved test points of a tool space.
struct SolvedPoints {
  const std::vector<TestPoint>& exact;
  /// The force at each on a finer mesh [exact.size()], N; nothing: it is not known.
  const std::vector<std::optional<Vec3>>& finer;
};

/// What is measured at a test point.
struct PointError {
  PointClass point_class = PointClass::failed;
  Support support = Support::none;
  /// Relative error; NaN: the point failed.
  double error = 0;
};

/// Measures one variant on one tool space. For a tool space with levels, memory and time are those
/// of the branch of rest, and errors are those of the branch that the body is on.
/// @param whole The tool space before it is coarsened.
/// @param errors Set to the error at each of the points [points.exact.size()].
/// @param fields The fields in the file of the space; null: there is no file.
/// @throws InputError, BackendError as FieldCache::add_up.
[[nodiscard]] Measurement measure(const TouchSpace& space, const TouchToolSpace& whole,
                                  const Variant& variant, const SolvedPoints& points,
                                  std::vector<PointError>& errors, FieldCache* fields = nullptr);

}  // namespace palpate
