// SPDX-License-Identifier: BSD-3-Clause
// The force on a rigid tool where the space has no cell yet, from single configurations around:
//
//   Π(x) = Σ w̄_i T_i(x),   T_i = Π_i + h_i·d_i + ½ d_i·k_i d_i,   d_i = x − x_i
//   w̄_i = w_i / Σ_j w_j,   w_i = (1 − s)⁴ (4s + 1) / (s² + 0.01),   s = |d_i| / reach
//
// The weights are smooth, so that the force does not jump where the nearest configuration is
// another one. Expansions of the second order err less far away than those of the third, which the
// interpolation in cells uses. Where such a force would pull the tool into the body there is none.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/memory_ranges.h"
#include "interpolation/interpolator.h"

namespace palpate {

/// Immutable.
class NearStates {
 public:
  /// @param configurations Of one tool space. Those that are not usable, touch nothing, or are
  ///   marked (kMarking) are not used.
  /// @param reach How far a configuration is used, m; above 0.
  NearStates(const std::vector<ConfigurationSummary>& configurations, double reach);

  /// The usual reach: about a cell away, m.
  [[nodiscard]] static double usual_reach(const Grid& grid) {
    return 1.25 * grid.coarsest * grid.spacing();
  }

  /// Whether a place is in no cell, so that the configurations within reach give the force there.
  /// @param at Where x is in the grid.
  /// @note Realtime-safe.
  [[nodiscard]] bool serves(const CheckPointGrid::Location& at, const Vec3& x) const noexcept {
    using Place = CheckPointGrid::Place;
    return (at.place == Place::beside_cell || at.place == Place::nowhere) && reaches(x);
  }
  /// Whether a configuration is within reach.
  /// @note Realtime-safe.
  [[nodiscard]] bool reaches(const Vec3& x) const noexcept;
  /// The support is `extrapolated`; `none` if no configuration is within reach.
  /// @note Realtime-safe.
  [[nodiscard]] TouchResult evaluate(const Vec3& x) const noexcept;
  /// Calls visit(number, weight, d) for each configuration within reach: its number in the list
  /// that the constructor was given, its weight w̄, and the way from it to x, m.
  template <class Visit>
  void visit(const Vec3& x, Visit&& visit) const {
    double sum = 0;
    visit_near(x, [&](const State&, const Vec3&, double w, double) { sum += w; });
    visit_near(x, [&](const State& state, const Vec3& d, double w, double) {
      visit(state.number, w / sum, d);
    });
  }
  void add_memory(MemoryRanges& ranges) const { palpate::add_memory(states_, ranges); }

 private:
  using Bin = std::array<std::int32_t, 3>;
  struct State {
    Bin bin{};
    std::int32_t number = 0;
    Vec3 place = Vec3::Zero();
    double energy = 0;
    Vec3 force = Vec3::Zero();
    Mat3 stiffness = Mat3::Zero();
  };

  [[nodiscard]] Bin bin_of(const Vec3& x) const noexcept;
  /// Calls visit(state, d, w, dw) for each state within reach, with dw = (dw/d|d|)/|d|.
  template <class Visit>
  void visit_near(const Vec3& x, Visit&& visit) const noexcept;

  /// In the order of their bins, which are as wide as the reach.
  std::vector<State> states_;
  double reach_;
};

template <class Visit>
void NearStates::visit_near(const Vec3& x, Visit&& visit) const noexcept {
  constexpr double kSoftness = 0.01;
  const Bin middle = bin_of(x);
  for (std::int32_t i = middle[0] - 1; i <= middle[0] + 1; ++i) {
    for (std::int32_t j = middle[1] - 1; j <= middle[1] + 1; ++j) {
      const Bin first{i, j, middle[2] - 1};
      const Bin last{i, j, middle[2] + 1};
      auto state = std::lower_bound(states_.begin(), states_.end(), first,
                                    [](const State& s, const Bin& bin) { return s.bin < bin; });
      for (; state != states_.end() && state->bin <= last; ++state) {
        const Vec3 d = x - state->place;
        const double s = d.norm() / reach_;
        if (s >= 1) continue;
        const double left = 1 - s;
        const double above = left * left * left * left * (4 * s + 1);
        const double below = s * s + kSoftness;
        // Both derivatives have a factor s, which is left out.
        const double of_above = -20 * left * left * left;
        const double slope = (of_above * below - 2 * above) / (below * below);
        visit(*state, d, above / below, slope / (reach_ * reach_));
      }
    }
  }
}

}  // namespace palpate
