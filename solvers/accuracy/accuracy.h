// SPDX-License-Identifier: BSD-3-Clause
// Error against run time: of every method to interpolate a state space, at test points where the
// equilibrium is solved for exactly, what it costs and how wrong it is.
#pragma once

#include <string>
#include <vector>

#include "accuracy/exact.h"
#include "accuracy/measure.h"

namespace palpate {

struct AccuracyOptions {
  ExactOptions exact;
  /// Empty: all.
  std::vector<Method> methods;
};

/// Figures of one method on one grid; NaN where nothing was measured. Errors are shares, not per
/// cent, and of test points that count: inside the space, not marked and regular.
struct AccuracyRow {
  std::string method;
  /// −1: all together.
  Index active_node = -1;
  /// Check-points along an axis; of the smallest cells where there are several sizes.
  std::int32_t resolution = 0;
  /// A site: configurations and intermediate states, s on one core, bytes, s.
  double samples = 0;
  double precompute_seconds = 0;
  double bytes = 0;
  double setup_seconds = 0;
  /// Test points: all, by what became of them, see PointClass.
  int test_points = 0;
  int counted = 0;
  int marked = 0;
  int extrapolated = 0;
  int irregular = 0;
  int failed = 0;
  /// Relative error of the force, see measure.h, and absolute, N.
  double mean_error = 0;
  double p99_error = 0;
  double largest_error = 0;
  double mean_absolute_error = 0;
  double p99_absolute_error = 0;
  double largest_absolute_error = 0;
  /// Share of points whose relative error a hand notices, kNoticeable.
  double noticeable = 0;
  /// Largest relative error within kNearRest half-widths from rest.
  double near_rest_error = 0;
  /// Relative error in marked regions.
  double mean_marked_error = 0;
  double largest_marked_error = 0;
  double largest_extrapolated_error = 0;
  double mean_stiffness_error = 0;
  /// Of a surface point, as a share of the largest displacement in the space.
  double mean_displacement_error = 0;
  double largest_displacement_error = 0;
  /// The largest of random closed paths, over the largest energy on each.
  double loop_work = 0;
  /// The largest at random points of faces between cells, over the largest force and stiffness.
  double force_jump = 0;
  double stiffness_jump = 0;
  /// One evaluation of force, stiffness and energy, ns.
  double p50_nanoseconds = 0;
  double p999_nanoseconds = 0;
};

/// A test point, and the errors there of the methods on the whole grid.
struct AccuracyPoint {
  Index active_node = 0;
  TestPoint exact;
  Support support = Support::none;
  PointClass point_class = PointClass::failed;
  /// Relative, in the order of AccuracyResult::methods; NaN where the point failed or the method
  /// does not serve the site.
  std::vector<double> errors;
};

struct AccuracyResult {
  /// A row for each method and grid, of all sites together.
  std::vector<AccuracyRow> rows;
  /// The same for each site.
  std::vector<AccuracyRow> rows_of_sites;
  /// Without settings that were only compared: with all that the space has, on the whole grid.
  std::vector<std::string> methods;
  std::vector<AccuracyPoint> points;
  std::int64_t num_solved = 0;
  std::int64_t num_reused = 0;
  /// Time of the exact solves and of the measurements, s.
  double exact_seconds = 0;
  double measure_seconds = 0;
  /// Of the exact solves, on one core each, s.
  double mean_solve_seconds = 0;
  /// It was not aborted; the same on every rank.
  bool complete = false;
};

/// @param scene The same on every rank.
/// @param space Whole on rank 0; elsewhere it is not looked at.
/// @returns Whole on rank 0, empty elsewhere.
/// @note Collective
/// @throws InputError the space is not of this scene, or has no site; as solve_test_points().
[[nodiscard]] AccuracyResult measure_accuracy(const Scene& scene, const TouchSpace& space,
                                              const AccuracyOptions& options,
                                              Communicator& communicator, const Progress& progress);

}  // namespace palpate
