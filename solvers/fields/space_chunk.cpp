// SPDX-License-Identifier: BSD-3-Clause
#include "fields/space_chunk.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace palpate {
namespace {

/// Makes room for further modes and configurations, in which all is zero.
/// @param of_column The new place of each column.
/// @param parts The number of parts of the matrix, one below the other, each with one row for each
///   mode.
void grow(Eigen::MatrixXf& matrix, Eigen::Index rank, Eigen::Index num_columns, Eigen::Index parts,
          const std::vector<Eigen::Index>& of_column) {
  const Eigen::Index before = matrix.rows() / parts;
  Eigen::MatrixXf grown = Eigen::MatrixXf::Zero(parts * rank, num_columns);
  for (std::size_t c = 0; c < of_column.size(); ++c) {
    for (Eigen::Index part = 0; part < parts; ++part) {
      grown.col(of_column[c]).segment(part * rank, before) =
          matrix.col(static_cast<Eigen::Index>(c)).segment(part * before, before);
    }
  }
  matrix = std::move(grown);
}

void add_modes(const Eigen::MatrixXf& added, TouchToolSpace& space) {
  if (added.cols() == 0) return;
  const Eigen::Index before = space.modes.cols();
  space.modes.conservativeResize(added.rows(), before + added.cols());
  space.modes.rightCols(added.cols()) = added;
}

void take_configurations(const ToolSpaceChunk& chunk, TouchToolSpace& space) {
  const std::vector<ConfigurationSummary> old = std::exchange(space.configurations, {});
  std::vector<Eigen::Index> of_old(old.size());
  std::vector<Eigen::Index> of_new;
  space.configurations.reserve(old.size() + chunk.configurations.size());
  std::size_t o = 0;
  const auto keep_old_before = [&](const ConfigurationSummary* next) {
    for (; o < old.size() && (next == nullptr || old[o] < *next); ++o) {
      of_old[o] = static_cast<Eigen::Index>(space.configurations.size());
      space.configurations.push_back(old[o]);
    }
  };
  for (const ConfigurationSummary& c : chunk.configurations) {
    keep_old_before(&c);
    const auto at = static_cast<Eigen::Index>(space.configurations.size());
    if (o < old.size() && !(c < old[o])) of_old[o++] = at;
    of_new.push_back(at);
    space.configurations.push_back(c);
  }
  keep_old_before(nullptr);
  const Eigen::Index rank = space.modes.cols();
  const auto total = static_cast<Eigen::Index>(space.configurations.size());
  grow(space.coefficients, rank, total, 1, of_old);
  grow(space.coefficient_gradients, rank, total, 3, of_old);
  for (std::size_t i = 0; i < chunk.fields.size(); ++i) {
    const ReducedFields& fields = chunk.fields[i];
    const Eigen::Index own = fields.u.size();
    space.coefficients.col(of_new[i]).head(own) = fields.u;
    for (int a = 0; a < 3 && own > 0; ++a) {
      space.coefficient_gradients.col(of_new[i]).segment(a * rank, own) = fields.v.col(a);
    }
  }
}

TouchToolSpace& tool_space_of(const ToolSpaceChunk& chunk, TouchSpace& space) {
  auto& all = space.tool_spaces;
  auto here = std::lower_bound(
      all.begin(), all.end(), chunk.setup.key(),
      [](const TouchToolSpace& one, const ToolSpaceKey& key) { return one.setup.key() < key; });
  if (here != all.end() && here->setup.key() == chunk.setup.key()) return *here;
  here = all.emplace(here);
  here->setup = chunk.setup;
  here->clearance = chunk.clearance;
  here->modes.resize(3 * Eigen::Index{space.surface.num_points()}, 0);
  return *here;
}

}  // namespace

void take(const SpaceChunk& chunk, TouchSpace& space) {
  for (const ToolSpaceChunk& part : chunk.tool_spaces) {
    TouchToolSpace& here = tool_space_of(part, space);
    add_modes(part.modes, here);
    take_configurations(part, here);
    for (const LevelTransition& transition : part.transitions) {
      note(transition, here.configurations);
    }
    std::vector<IntermediateState>& states = here.intermediate_states;
    const auto middle = static_cast<std::ptrdiff_t>(states.size());
    states.insert(states.end(), part.intermediate_states.begin(), part.intermediate_states.end());
    std::inplace_merge(states.begin(), states.begin() + middle, states.end());
    space.largest_displacement = std::max(space.largest_displacement, part.largest_displacement);
    space.displacement_error = std::max(space.displacement_error, part.displacement_error);
    space.sensitivity_error = std::max(space.sensitivity_error, part.sensitivity_error);
  }
}

}  // namespace palpate
