// SPDX-License-Identifier: BSD-3-Clause
// Error against run time: measures for every method of interpolation what it costs, and how large
// its errors are at test points where the equilibrium is solved for exactly. The state space is
// that of active nodes, or of a rigid tool that presses the body anywhere.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "accuracy/exact.h"
#include "accuracy/measure.h"

namespace palpate {

struct AccuracyOptions {
  ExactOptions exact;
  /// The methods that are compared; empty: all.
  std::vector<Method> methods;
  /// Whether the error of the mesh is measured too, by solves on finer meshes (finer_mesh.h). A
  /// solve there takes some twenty times as long.
  bool measures_mesh_error = false;
};

/// Figures of one method on one grid; NaN: nothing was measured. Errors are shares, not per cent,
/// and are taken at the test points that count: inside the space, not marked, and regular.
struct AccuracyRow {
  std::string method;
  /// The tool of the row: ToolSpaceSetup::name(), or "all".
  std::string tool;
  /// −1: the row is of all active nodes together, or of a rigid tool.
  Index active_node = -1;
  /// Check-points along an axis, and their distance, m; those of the smallest cells if there are
  /// several sizes.
  std::int32_t resolution = 0;
  double spacing = 0;
  /// Means over the tool spaces: the number of configurations and intermediate states; the time to
  /// compute them, s on one core; the memory of the method, bytes; and its setup time, s.
  double samples = 0;
  double precompute_seconds = 0;
  double bytes = 0;
  double setup_seconds = 0;
  /// The number of test points, and of those in each class, see PointClass.
  int test_points = 0;
  int counted = 0;
  int marked = 0;
  int extrapolated = 0;
  int irregular = 0;
  int failed = 0;
  /// Errors of the force, relative (see measure.h) and absolute, N. Relative errors, also of the
  /// stiffness, leave out points where a rigid tool begins to touch.
  double mean_error = 0;
  double p99_error = 0;
  double largest_error = 0;
  double mean_absolute_error = 0;
  double p99_absolute_error = 0;
  double largest_absolute_error = 0;
  /// The largest exact force at the test points that count, N. Divide absolute errors by it for
  /// shares of the largest force.
  double largest_force = 0;
  /// The error that the mesh makes in the force, as the space estimates it, N: it is no error of
  /// the interpolation, and comes on top of that. NaN where there is no estimate. And the share of
  /// points at which it is reliable.
  double mean_mesh_error = 0;
  double largest_mesh_error = 0;
  double reliable_mesh_error = 0;
  /// The same error as it is measured on finer meshes, and what is left of it where the estimate is
  /// reliable and taken off, N. NaN where that was not asked for.
  double mean_measured_mesh_error = 0;
  double largest_measured_mesh_error = 0;
  double mean_left_mesh_error = 0;
  double largest_left_mesh_error = 0;
  /// The share of points whose relative error a hand can notice: it exceeds kNoticeable.
  double noticeable = 0;
  /// Largest relative error within kNearRest half-widths from rest, or where a rigid tool begins
  /// to touch.
  double near_rest_error = 0;
  /// Relative error in marked regions.
  double mean_marked_error = 0;
  double largest_marked_error = 0;
  double largest_extrapolated_error = 0;
  double mean_stiffness_error = 0;
  /// Error of a surface point's displacement, as a share of the largest displacement in the space,
  /// see Measurement; NaN where a rigid tool's space has no file.
  double mean_displacement_error = 0;
  double largest_displacement_error = 0;
  /// The largest ratio of the work along a random closed path to the largest energy on the path.
  double loop_work = 0;
  /// The largest jumps at random points of faces between cells, as shares of the largest force and
  /// stiffness.
  double force_jump = 0;
  double stiffness_jump = 0;
  /// Time of one evaluation of force, stiffness and energy, ns.
  double p50_nanoseconds = 0;
  double p999_nanoseconds = 0;
};

/// A test point, and the errors there of the methods on the whole grid.
struct AccuracyPoint {
  /// −1: a rigid tool.
  Index active_node = 0;
  BodyId body = kFirstBody;
  TestPoint exact;
  /// The force on a finer mesh, N; nothing: it is not known.
  std::optional<Vec3> finer;
  Support support = Support::none;
  PointClass point_class = PointClass::failed;
  /// Relative errors of the force, in the order of AccuracyResult::methods; NaN: the point failed,
  /// or the method does not serve the tool space.
  std::vector<double> errors;
};

struct AccuracyResult {
  /// A row for each method and grid, of all tool spaces together.
  std::vector<AccuracyRow> rows;
  /// The same rows for each tool space separately.
  std::vector<AccuracyRow> rows_of_tool_spaces;
  /// The methods with all data of the space, on the whole grid; variants that are only measured for
  /// comparison are left out.
  std::vector<std::string> methods;
  std::vector<AccuracyPoint> points;
  std::int64_t num_solved = 0;
  std::int64_t num_reused = 0;
  /// Time of the exact solves and of the measurements, s.
  double exact_seconds = 0;
  double measure_seconds = 0;
  /// Mean time of an exact solve on one core, s.
  double mean_solve_seconds = 0;
  /// The run was not aborted; the same on every rank.
  bool complete = false;
};

/// Measures the accuracy of a space by exact solves at test points.
/// @param scenes Those of the bodies, in the order of their numbers; the same on every rank.
/// @param space The space on rank 0; it is ignored on other ranks.
/// @returns The result on rank 0; elsewhere it has no rows and no points.
/// @note Collective
/// @throws InputError the space is not of this scene, has no tool space, or none that a chosen
///   method serves; or as solve_test_points() and FieldCache::add_up.
/// @throws BackendError as FieldCache::add_up.
[[nodiscard]] AccuracyResult measure_accuracy(
    const std::vector<std::shared_ptr<const Scene>>& scenes, const TouchSpace& space,
    const AccuracyOptions& options, Communicator& communicator, const Progress& progress);

}  // namespace palpate
