// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy/accuracy.h"

#include <algorithm>
#include <exception>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "accuracy/finer_mesh.h"
#include "accuracy/statistics.h"
#include "base/error.h"
#include "equilibrium/work.h"
#include "exploration/transfer.h"

namespace palpate {
namespace {

/// The tool spaces of rank 0, on every rank.
/// @param holds On rank 0, set to a function that tells whether a place of a rigid tool is in a
///   cell of a tool space.
std::vector<ToolSpaceSetup> share_setups(
    const std::vector<std::shared_ptr<const Scene>>& scenes, const TouchSpace& space,
    const std::vector<Method>& methods,
    std::function<bool(const ToolSpaceKey&, const Vec3&)>& holds, Communicator& communicator) {
  std::vector<ToolSpaceSetup> setups;
  std::map<ToolSpaceKey, std::shared_ptr<const CheckPointGrid>> grids;
  agree(communicator, [&] {
    if (communicator.rank() != 0) return;
    if (space.tool_spaces.empty()) {
      throw InputError("The state space has no active node. Compute it again.");
    }
    if (!space.list_turned().empty()) {
      throw InputError(
          "The state space is that of a tool that is turned freely, at whose orientations no "
          "report "
          "is made. Compare Touch State Space with Solve Equilibrium.");
    }
    std::vector<std::string> hashes;
    for (const auto& scene : scenes) hashes.push_back(hash(*scene));
    if (space.scene_hash != join_hashes(hashes)) {
      throw InputError(
          "The state space is not of this body: its scene (mesh, materials, fixed "
          "points) has the hash " +
          space.scene_hash + ", that of the body is " + join_hashes(hashes) +
          ". Compute the state space again.");
    }
    bool is_served = false;
    for (const TouchToolSpace& tool_space : space.tool_spaces) {
      // The grid checks the tool space before anything is solved for.
      const auto grid = std::make_shared<const CheckPointGrid>(tool_space);
      setups.push_back(tool_space.setup);
      is_served = is_served || !variants(tool_space, methods).empty();
      grids[tool_space.setup.key()] = grid;
    }
    holds = [grids](const ToolSpaceKey& tool_space, const Vec3& q) {
      return grids.at(tool_space)->locate(q).place == CheckPointGrid::Place::cell;
    };
    if (!is_served) {
      throw InputError("None of the chosen methods serves the state space of " +
                       setups.front().name() +
                       ". Choose 'Energy Hermite' or 'Trilinear' among them.");
    }
  });
  return of_first(setups, communicator);
}

double share_above(const std::vector<double>& values, double limit) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto count =
      std::count_if(values.begin(), values.end(), [&](double value) { return value > limit; });
  return static_cast<double>(count) / static_cast<double>(values.size());
}

AccuracyRow row_of(const std::string& method, const std::string& tool, Index active_node,
                   const Measurement& m) {
  AccuracyRow row;
  row.method = method;
  row.tool = tool;
  row.active_node = active_node;
  row.resolution = m.resolution;
  row.spacing = m.spacing;
  const auto tool_spaces = static_cast<double>(m.tool_spaces);
  row.samples = m.samples / tool_spaces;
  row.precompute_seconds = m.precompute_seconds / tool_spaces;
  row.bytes = m.bytes / tool_spaces;
  row.setup_seconds = m.setup_seconds / tool_spaces;
  const auto count = [&](PointClass c) { return m.points[static_cast<std::size_t>(c)]; };
  row.counted = count(PointClass::inside);
  row.marked = count(PointClass::marked);
  row.extrapolated = count(PointClass::extrapolated);
  row.irregular = count(PointClass::irregular);
  row.failed = count(PointClass::failed);
  row.test_points = row.counted + row.marked + row.extrapolated + row.irregular + row.failed;
  row.mean_error = mean(m.relative);
  row.p99_error = quantile(m.relative, 0.99);
  row.largest_error = largest(m.relative);
  row.mean_absolute_error = mean(m.absolute);
  row.p99_absolute_error = quantile(m.absolute, 0.99);
  row.largest_absolute_error = largest(m.absolute);
  row.largest_force = m.largest_force;
  row.mean_mesh_error = mean(m.mesh);
  row.largest_mesh_error = largest(m.mesh);
  row.reliable_mesh_error = m.reliable_mesh / static_cast<double>(m.mesh.size());
  row.mean_measured_mesh_error = mean(m.measured_mesh);
  row.largest_measured_mesh_error = largest(m.measured_mesh);
  row.mean_left_mesh_error = mean(m.left_mesh);
  row.largest_left_mesh_error = largest(m.left_mesh);
  row.noticeable = share_above(m.relative, kNoticeable);
  row.near_rest_error = largest(m.near_rest);
  row.mean_marked_error = mean(m.marked);
  row.largest_marked_error = largest(m.marked);
  row.largest_extrapolated_error = largest(m.extrapolated);
  row.mean_stiffness_error = mean(m.stiffness);
  row.mean_displacement_error = mean(m.displacement);
  row.largest_displacement_error = largest(m.displacement);
  row.loop_work = largest(m.loop_work);
  row.force_jump = largest(m.force_jump);
  row.stiffness_jump = largest(m.stiffness_jump);
  row.p50_nanoseconds = quantile(m.nanoseconds, 0.5);
  row.p999_nanoseconds = quantile(m.nanoseconds, 0.999);
  return row;
}

bool is_plain(const Variant& variant) {
  const InterpolationOptions& o = variant.options;
  return variant.factor == 1 && o.linear_polynomial && o.intermediate_states && o.third_derivatives;
}

/// Runs the body on rank 0 while the other ranks sleep: ranks that poll would disturb the times
/// that are measured.
/// @note Collective. An exception of the body is thrown on all ranks.
void run_on_first_rank(Communicator& communicator, const std::function<void()>& body) {
  constexpr int kTag = 0;
  Network& network = communicator.network();
  std::exception_ptr error;
  if (communicator.rank() == 0) {
    try {
      body();
    } catch (...) {
      error = std::current_exception();
    }
    for (int rank = 1; rank < communicator.size(); ++rank) network.send(rank, kTag, {});
    network.flush();
  } else {
    constexpr double kRest = 1e-3;
    while (!network.receive()) network.rest(network.now() + kRest);
  }
  agree(communicator, [&] {
    if (error) std::rethrow_exception(error);
  });
}

/// Measures all tool spaces, on rank 0.
/// @param finer See FinerForces.
/// @param done Called with the number of tool spaces that are done, as a fraction; false ends the
///   measurement.
/// @returns false: it was ended.
bool measure_tool_spaces(const TouchSpace& space, const std::vector<Method>& methods,
                         const std::vector<std::vector<TestPoint>>& points,
                         const std::vector<std::vector<std::optional<Vec3>>>& finer,
                         const std::function<bool(double)>& done, AccuracyResult& result) {
  // Rows are in the order in which methods and grids first occur.
  std::vector<std::pair<std::string, std::int32_t>> order;
  std::map<std::pair<std::string, std::int32_t>, Measurement> together;
  std::map<std::string, std::size_t> columns;
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  std::optional<FieldCache> fields;
  if (!space.file.empty()) fields.emplace(space.file, space.scene_hash);
  for (std::size_t s = 0; s < space.tool_spaces.size(); ++s) {
    const TouchToolSpace& tool_space = space.tool_spaces[s];
    const std::size_t first_point = result.points.size();
    for (std::size_t i = 0; i < points[s].size(); ++i) {
      const TestPoint& point = points[s][i];
      AccuracyPoint& added = result.points.emplace_back();
      added.active_node = tool_space.setup.interaction.active_node;
      added.body = tool_space.setup.body;
      added.exact = point;
      added.finer = finer[s][i];
    }
    const std::vector<Variant> all = variants(tool_space, methods);
    for (std::size_t v = 0; v < all.size(); ++v) {
      const Variant& variant = all[v];
      std::vector<PointError> errors;
      const double share = static_cast<double>(v) / static_cast<double>(all.size());
      if (!done(static_cast<double>(s) + share)) return false;
      const Measurement measured = measure(space, tool_space, variant, {points[s], finer[s]},
                                           errors, fields ? &*fields : nullptr);
      const std::string name = to_string(variant);
      result.rows_of_tool_spaces.push_back(row_of(
          name, tool_space.setup.name(), tool_space.setup.interaction.active_node, measured));
      const auto [place, is_new] = together.try_emplace({name, measured.resolution});
      if (is_new) order.emplace_back(name, measured.resolution);
      place->second += measured;
      if (!is_plain(variant)) continue;
      const auto [column, is_new_method] = columns.try_emplace(name, columns.size());
      if (is_new_method) result.methods.push_back(name);
      for (AccuracyPoint& point : result.points) point.errors.resize(columns.size(), nothing);
      for (std::size_t i = 0; i < errors.size(); ++i) {
        AccuracyPoint& point = result.points[first_point + i];
        point.errors[column->second] = errors[i].error;
        point.support = errors[i].support;
        point.point_class = errors[i].point_class;
      }
    }
  }
  for (const auto& key : order) {
    result.rows.push_back(row_of(key.first, "all", -1, together.at(key)));
  }
  return true;
}

}  // namespace

AccuracyResult measure_accuracy(const std::vector<std::shared_ptr<const Scene>>& scenes,
                                const TouchSpace& space, const AccuracyOptions& options,
                                Communicator& communicator, const Progress& progress) {
  std::vector<Method> methods;
  agree(communicator, [&] {
    const std::vector<Method> known = all_methods();
    for (const Method method : options.methods) {
      const bool is_named = std::find(methods.begin(), methods.end(), method) != methods.end();
      if (!is_named) methods.push_back(method);
      if (std::find(known.begin(), known.end(), method) != known.end()) continue;
      throw InputError("There is no interpolation with the number " +
                       std::to_string(static_cast<int>(method)) + ". Choose from 0 to " +
                       std::to_string(known.size() - 1) + '.');
    }
  });
  ExactOptions of_exact = options.exact;
  const std::vector<ToolSpaceSetup> setups =
      share_setups(scenes, space, methods, of_exact.holds, communicator);
  AccuracyResult result;
  const SteadyClock::time_point start = SteadyClock::now();
  ExactResult exact = solve_test_points(scenes, setups, of_exact, communicator, progress);
  result.num_solved = exact.num_solved;
  result.num_reused = exact.num_reused;
  result.complete = exact.complete;
  if (!exact.complete) return result;

  FinerForces finer;
  if (options.measures_mesh_error) {
    finer = solve_on_finer_meshes(scenes, setups, exact.points, of_exact.equilibrium, communicator,
                                  progress);
    result.complete = finer.complete;
    if (!finer.complete) return result;
  } else {
    for (const auto& of_tool_space : exact.points) finer.forces.emplace_back(of_tool_space.size());
  }
  result.exact_seconds = seconds_since(start);

  const SteadyClock::time_point measure_start = SteadyClock::now();
  bool complete = true;
  run_on_first_rank(communicator, [&] {
    double seconds = 0;
    std::int64_t num_points = 0;
    for (const auto& of_tool_space : exact.points) {
      for (const TestPoint& point : of_tool_space) seconds += point.seconds;
      num_points += static_cast<std::int64_t>(of_tool_space.size());
    }
    result.mean_solve_seconds = num_points > 0 ? seconds / static_cast<double>(num_points) : 0;
    const auto done = [&](double num_tool_spaces) {
      if (!progress) return true;
      ProgressState state;
      state.num_done = num_points;
      state.num_expected = num_points;
      state.seconds = seconds_since(start);
      const double seconds_each =
          num_tool_spaces > 0 ? seconds_since(measure_start) / num_tool_spaces : 0;
      state.seconds_left = seconds_each * (static_cast<double>(setups.size()) - num_tool_spaces);
      return progress(state);
    };
    complete = measure_tool_spaces(space, methods, exact.points, finer.forces, done, result);
  });
  result.complete = !any(communicator, !complete);
  result.measure_seconds = seconds_since(measure_start);
  return result;
}

}  // namespace palpate
