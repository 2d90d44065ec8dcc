// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/mesh_error_field.h"

#include <algorithm>

namespace palpate {
namespace {

/// The largest share of its force by which a configuration is corrected whose estimate is not
/// reliable.
constexpr double kMostUnreliable = 0.5;

/// The node with an estimate that is nearest to a node.
std::int32_t nearest_known(const CheckPointGrid& grid, const std::vector<std::int32_t>& known,
                           std::int32_t node) {
  const auto distance = [&](std::int32_t other) {
    return squared_distance(grid.tree().point(node), grid.tree().point(other));
  };
  return *std::min_element(known.begin(), known.end(), [&](std::int32_t a, std::int32_t b) {
    return distance(a) < distance(b);
  });
}

}  // namespace

bool MeshErrorField::is_known(const CheckPointGrid& grid,
                              const std::vector<ConfigurationSummary>& configurations) {
  for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
    if (grid.usable(n) && configurations[grid.configuration(n)].mesh_error.is_known()) return true;
  }
  return false;
}

MeshErrorField::MeshErrorField(const CheckPointGrid& grid,
                               const std::vector<ConfigurationSummary>& configurations,
                               const MeshErrorField* before, const CellTree::Growth* growth) {
  std::vector<std::int32_t> known;
  std::vector<std::int32_t> unknown;
  for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
    if (!grid.usable(n)) continue;
    const bool is_known = configurations[grid.configuration(n)].mesh_error.is_known();
    (is_known ? known : unknown).push_back(n);
  }
  // The configurations with ΔΠ in the place of Π.
  std::vector<ConfigurationSummary> errors = configurations;
  std::vector<char> reliable_nodes(static_cast<std::size_t>(grid.num_nodes()), 0);
  corrects_ = true;
  bool any_reliable = false;
  const auto take = [&](std::int32_t n, std::int32_t from) {
    const ConfigurationSummary& c = configurations[grid.configuration(n)];
    const MeshError& error = configurations[grid.configuration(from)].mesh_error;
    ConfigurationSummary& result = errors[grid.configuration(n)];
    result.energy = error.energy;
    result.force = -error.force;
    result.stiffness.setZero();
    result.energy += result.force.dot(grid.place(n) - grid.place(from));
    const bool is_reliable = error.is_reliable && from == n;
    reliable_nodes[n] = is_reliable ? 1 : 0;
    any_reliable = any_reliable || is_reliable;
    const double most = kMostUnreliable * c.force.norm();
    const double size = error.force.norm();
    if (is_reliable || size <= most) return;
    result.energy *= most / size;
    result.force *= most / size;
  };
  for (const std::int32_t n : known) take(n, n);
  for (const std::int32_t n : unknown) {
    corrects_ = corrects_ && grid.is_marking(n);
    take(n, nearest_known(grid, known, n));
  }
  const std::int32_t rest = grid.tree().find({0, 0, 0});
  const bool is_rest_sound = rest < 0 || !grid.usable(rest) || reliable_nodes[rest] != 0;
  corrects_ = corrects_ && any_reliable && is_rest_sound;

  HermiteDataOptions options;
  options.known = 1;
  options.third_derivatives = false;
  if (before != nullptr) {
    const HermiteBefore data_before{*growth, before->nodes_, before->memory_};
    nodes_ = hermite_data(grid, errors, options, &data_before, &memory_);
  } else {
    nodes_ = hermite_data(grid, errors, options);
  }

  for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
    if (grid.is_free(n)) reliable_nodes[n] = 1;
  }
  const auto are_corners_reliable = [&](std::int32_t leaf) {
    const auto& corners = grid.leaf(leaf).corners;
    return std::all_of(corners.begin(), corners.end(),
                       [&](std::int32_t n) { return reliable_nodes[n] != 0; });
  };
  for (const CheckPointGrid::HangingNode& hanging : grid.hanging_nodes()) {
    reliable_nodes[hanging.node] = are_corners_reliable(hanging.leaf) ? 1 : 0;
  }
  reliable_.resize(grid.tree().leaves().size());
  for (std::size_t leaf = 0; leaf < reliable_.size(); ++leaf) {
    reliable_[leaf] = are_corners_reliable(static_cast<std::int32_t>(leaf)) ? 1 : 0;
  }
}

}  // namespace palpate
