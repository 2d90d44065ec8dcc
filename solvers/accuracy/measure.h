// SPDX-License-Identifier: BSD-3-Clause
// How wrong one way to interpolate a tool space is, and what it costs.
//
// The relative error of the force [P08, eq. 2] is |h − h*| / max(|h*|, f) with the exact force h*.
// The floor f is a thousandth of the largest force of the tool space within its limit: without it,
// tiny errors near rest would count as large ones.
//
// Where a rigid tool begins to touch, the force falls to zero and its error does not: relative
// errors there have a figure of their own.
//
// The cells of a rigid tool's space do not fill a box. A closed path is a slide of the test points,
// and back with the tool lifted; faces and places to time are those of the cells. A path or face
// counts where nothing is extrapolated.
//
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <string>
#include <vector>

#include "interpolation/interpolator.h"
#include "state_space/field_cache.h"
#include "state_space/test_point.h"
#include "state_space/touch_space.h"

namespace palpate {

/// The floor of relative errors, as a share of the largest force.
inline constexpr double kErrorFloor = 1e-3;
/// What a hand notices: the just noticeable difference of forces is about 10 %.
inline constexpr double kNoticeable = 0.1;

/// A method with its settings, on a grid.
struct Variant {
  Method method = Method::energy_hermite;
  InterpolationOptions options;
  /// The tool space is coarsened by this factor, see coarsen.h.
  std::int32_t factor = 1;
};

/// The name of a variant, such as 'RBF cubic, no intermediate states'.
[[nodiscard]] std::string to_string(const Variant& variant);

/// All variants that serve a tool space; none, where none of the methods does.
/// @param methods The methods they are of; empty: all.
[[nodiscard]] std::vector<Variant> variants(const TouchToolSpace& tool_space,
                                            const std::vector<Method>& methods);

/// What is known of one test point.
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
  /// The number of configurations and intermediate states, of all tool spaces.
  double samples = 0;
  /// The time that it took to find these, s on one core, as it is recorded with each of them.
  double precompute_seconds = 0;
  /// The time to make what is evaluated, s, and its memory, bytes.
  double setup_seconds = 0;
  double bytes = 0;
  /// Check-points along an axis, and their distance, m, as if all cells were as the smallest.
  std::int32_t resolution = 0;
  double spacing = 0;
  int tool_spaces = 0;

  /// The number of test points of each class, by the number of the class.
  std::vector<int> points = std::vector<int>(5, 0);
  /// Errors of the force at the points that count, relative and absolute, N; the relative ones are
  /// without those where a rigid tool begins to touch.
  std::vector<double> relative;
  std::vector<double> absolute;
  /// The largest exact force at these, N.
  double largest_force = 0;
  /// Errors of the stiffness where `relative` is, |k − k*| / |k*|, with a floor as that of the
  /// force.
  std::vector<double> stiffness;
  /// The largest error of the displacement at any of sample_points(), as a share of the largest
  /// displacement in the space; of a rigid tool, of the largest at a test point. It is that of what
  /// is shown, by the modes or, of a rigid tool, from the fields in the file of the space, so that
  /// it is the same for all methods. None where a rigid tool's space has no file.
  std::vector<double> displacement;
  /// Relative errors of the force in marked regions, and at points near rest or where a rigid tool
  /// begins to touch.
  std::vector<double> marked;
  std::vector<double> near_rest;
  /// Relative errors at points that are regular, but beyond the configurations.
  std::vector<double> extrapolated;
  /// For each closed path |∮ h·dt| over the largest energy on it.
  std::vector<double> loop_work;
  /// Jumps across faces between cells, as a share of the largest force and stiffness.
  std::vector<double> force_jump;
  std::vector<double> stiffness_jump;
  /// Times of one evaluation, ns.
  std::vector<double> nanoseconds;

  Measurement& operator+=(const Measurement& other);
};

/// What is measured at a test point.
struct PointError {
  PointClass point_class = PointClass::failed;
  Support support = Support::none;
  /// Relative error; NaN where the point failed.
  double error = 0;
};

/// Measures one variant on one tool space. Of a tool space with levels, memory and time are those
/// of the branch of rest; errors are those of the branch that the body is on.
/// @param whole The tool space before it is coarsened.
/// @param points Test points of the tool space, solved.
/// @param errors Is set to the error at each of them [points.size()].
/// @param fields Of the file of the space; null: there is none.
/// @throws InputError, BackendError as FieldCache::add_up.
[[nodiscard]] Measurement measure(const TouchSpace& space, const TouchToolSpace& whole,
                                  const Variant& variant, const std::vector<TestPoint>& points,
                                  std::vector<PointError>& errors, FieldCache* fields = nullptr);

}  // namespace palpate
