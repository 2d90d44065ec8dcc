// SPDX-License-Identifier: BSD-3-Clause
// How far one way to interpolate a site is off, and what it takes.
//
// The relative error of the force [P08, eq. 2] is |h − h*| / max(|h*|, f), h* exact; the floor f is
// a thousandth of the largest force of the site within its limit, so that what is nothing at rest
// does not count as everything.
//
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <string>
#include <vector>

#include "interpolation/interpolator.h"
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
  /// The space is coarsened by it, see coarsen.h.
  std::int32_t factor = 1;
};

/// 'RBF cubic, no intermediate states'.
[[nodiscard]] std::string to_string(const Variant& variant);

/// All that serve a site.
/// @param methods Of these; empty: of all.
[[nodiscard]] std::vector<Variant> variants(const TouchSite& site,
                                            const std::vector<Method>& methods);

/// What is known of one test point.
enum class PointClass {
  /// The space says that it is inside, and it is regular: it counts.
  inside,
  /// Regular, in a marked region of the space.
  marked,
  /// Regular, beyond the configurations of the space.
  extrapolated,
  /// Not regular: inverted, unstable, or beyond a jump.
  irregular,
  /// It did not converge: nothing is known.
  failed,
};

/// Raw figures of a site, or of several together.
struct Measurement {
  /// Configurations and intermediate states, of all sites.
  double samples = 0;
  /// The time that finding these took, s, on one core: recorded with each of them.
  double precompute_seconds = 0;
  /// To make what is evaluated, s, and what it holds.
  double setup_seconds = 0;
  double bytes = 0;
  std::int32_t resolution = 0;
  int sites = 0;

  /// Test points of each class, by its number.
  std::vector<int> points = std::vector<int>(5, 0);
  /// Relative and absolute (N) errors of the force at points that count.
  std::vector<double> relative;
  std::vector<double> absolute;
  /// Of the stiffness, |k − k*| / |k*|.
  std::vector<double> stiffness;
  /// Largest error of the displacement at any of sample_points(), as a share of the largest
  /// displacement in the space; it is that of the display field, the same for all methods.
  std::vector<double> displacement;
  /// Relative errors of the force in marked regions, and of points near rest.
  std::vector<double> marked;
  std::vector<double> near_rest;
  /// Relative errors of points that are regular, but beyond the configurations.
  std::vector<double> extrapolated;
  /// |∮ h·dt| over the largest energy on the way, of closed paths.
  std::vector<double> loop_work;
  /// Across faces between cells, as a share of the largest force and stiffness.
  std::vector<double> force_jump;
  std::vector<double> stiffness_jump;
  /// Of one evaluation, ns.
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

/// Of a site with levels, what is held and evaluated is that of the branch of rest; errors are
/// those of the branch that the body is on.
/// @param whole Before it is coarsened. @param points Solved.
/// @param errors At each of them [points.size()].
[[nodiscard]] Measurement measure(const TouchSpace& space, const TouchSite& whole,
                                  const Variant& variant, const std::vector<TestPoint>& points,
                                  std::vector<PointError>& errors);

}  // namespace palpate
