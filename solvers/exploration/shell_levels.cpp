// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/shell_levels.h"

#include <algorithm>
#include <memory>

#include "interpolation/leaf_edges.h"

namespace palpate {
namespace {

/// Along an edge of a smooth force the residual of the energy falls to 1/32 if the edge is halved,
/// and to a quarter where contact begins; where the force jumps it falls to a half.
constexpr double kShrinks = 0.25;
/// The misfit of the energy from which on an edge is suspected, see kForceMisfitAcross.
constexpr double kEnergyMisfit = 0.05;

CheckPoint moved(CheckPoint p, int axis, std::int32_t steps) {
  p[axis] += steps;
  return p;
}

/// Finds the edges of a flat space that are suspected.
class Suspects {
 public:
  Suspects(const ToolSpaceSetup& setup, const LeafEdges& edges, LevelSearch& search,
           const EdgeFit& fit)
      : setup_(setup), edges_(edges), search_(search), fit_(fit) {}

  void find() {
    const bool all = setup_.policy.history == History::levels;
    edges_.for_each([&](const CheckPoint& p, int axis, std::int32_t steps) {
      if (all || is_across(p, axis, steps)) search_.suspect(p, moved(p, axis, steps));
    });
    for (const auto& [p, levels] : search_.found()) {
      if (!has_jumped(levels.begin()->second)) continue;
      for (const CheckPoint& q : edges_.neighbours(p)) search_.suspect(p, q);
    }
  }

 private:
  /// Whether the way to a configuration was not smooth, or has not led there.
  [[nodiscard]] static bool has_jumped(const ConfigurationSummary& c) {
    if (!c.usable()) return true;
    constexpr Flags kNoQuestion = flags::inverted | flags::beyond_force_limit;
    return (c.flags & kNoQuestion) == 0 && (c.flags & (flags::near_fold | flags::unstable)) != 0;
  }

  /// The residual of the energy of an edge, J; negative: one of its ends is not known.
  [[nodiscard]] double residual(const CheckPoint& p, int axis, std::int32_t steps) const {
    const ConfigurationSummary* a = search_.flat_at(p);
    const ConfigurationSummary* b = search_.flat_at(moved(p, axis, steps));
    return a == nullptr || b == nullptr ? -1 : edge_residual(*a, *b, b->t - a->t);
  }

  /// Whether an edge lies across branches.
  [[nodiscard]] bool is_across(const CheckPoint& p, int axis, std::int32_t steps) const {
    const ConfigurationSummary* a = search_.flat_at(p);
    const ConfigurationSummary* b = search_.flat_at(moved(p, axis, steps));
    if (a == nullptr || b == nullptr) return false;
    if (fit_.force_misfit(*a, *b) > kForceMisfitAcross) return true;
    if (!(fit_.energy_misfit(*a, *b) > kEnergyMisfit)) return false;
    // The residual of this edge is compared with those of edges twice as long that contain it.
    const double of_long =
        std::max(residual(p, axis, 2 * steps), residual(moved(p, axis, -steps), axis, 2 * steps));
    return of_long < 0 || residual(p, axis, steps) > kShrinks * of_long;
  }

  const ToolSpaceSetup& setup_;
  const LeafEdges& edges_;
  LevelSearch& search_;
  const EdgeFit& fit_;
};

}  // namespace

LevelSearch begin_level_search(const ToolSpaceSetup& setup,
                               const std::vector<ConfigurationSummary>& flat, const EdgeFit& fit,
                               const std::function<bool(const CheckPoint&)>& within) {
  const auto edges = std::make_shared<const LeafEdges>(CellTree(setup.grid, flat), within);
  const double side = setup.grid.coarsest * setup.grid.spacing();
  LevelSearch search({[edges](const CheckPoint& p) { return edges->neighbours(p); },
                      [side](const ConfigurationSummary& /*found*/) { return side; }, side,
                      [fit](const ConfigurationSummary& a, const ConfigurationSummary& b) {
                        return fit.fits(a, b);
                      }});
  for (const ConfigurationSummary& c : flat) search.accept(c);
  Suspects(setup, *edges, search, fit).find();
  return search;
}

}  // namespace palpate
