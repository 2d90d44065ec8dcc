// SPDX-License-Identifier: BSD-3-Clause
// The energy of a body whose cut opens, as a function of where the tool is and of the area A of the
// cut. At each stage of the cut, the tool space of that stage gives Π_j(t) at the area A_j. Between
// the stages Π is the monotone piecewise cubic in A of Fritsch and Butland (SIAM J. Sci. Stat.
// Comput. 5, 1984), which is C¹, and has no energy release rate G = −∂Π/∂A below 0 if no stage has
// more energy than the one before. At the first stage G is that of the whole step to the next one.
// Force and stiffness are the derivatives by t.
//
// A tears, at a toughness G_c, as far as that lowers Π + G_c A: continuously while G > G_c, and
// from where it rests to the next stage where the whole step pays for itself, Π(A) − Π_{j+1} ≥ G_c
// (A_{j+1} − A). The second rule begins a tear, since G tends to 0 at the border of a body without
// one: the length that a tear begins with is the distance of two stages (finite fracture mechanics:
// Leguillon, Eur. J. Mech. A 21, 2002). A never becomes less. So the tear makes no energy.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "interpolation/interpolator.h"

namespace palpate {

struct TornResult {
  /// Energy, force and stiffness of the body.
  TouchResult touch;
  /// G, J/m².
  double release_rate = 0;
};

class TornEnergy {
 public:
  /// A stage and its neighbours on both sides that it is interpolated with.
  static constexpr int kMostStages = 4;

  TornEnergy() = default;
  /// @param areas Of the stages, from 0 on, ascending; two at least, m².
  explicit TornEnergy(std::vector<double> areas) : areas_(std::move(areas)) {}

  [[nodiscard]] const std::vector<double>& areas() const noexcept { return areas_; }
  [[nodiscard]] int num_stages() const noexcept { return static_cast<int>(areas_.size()); }
  [[nodiscard]] bool is_cut() const noexcept { return !areas_.empty(); }
  [[nodiscard]] double whole_area() const noexcept { return areas_.back(); }
  /// The stage from which on an area is interpolated: A_j ≤ A ≤ A_{j+1}.
  /// @note Realtime-safe.
  [[nodiscard]] int stage_below(double area) const noexcept;
  /// The share of the next stage: 0 at stage_below(), 1 at the next one.
  /// @note Realtime-safe.
  [[nodiscard]] double share_above(double area) const noexcept;

  /// @param stage j → TouchResult at the stage j.
  /// @note Realtime-safe.
  template <class Stage>
  [[nodiscard]] TornResult evaluate(double area, const Stage& stage) const noexcept {
    return interpolate(gather(stage_below(area), stage), area);
  }

  /// How far a cut of an area tears.
  /// @param toughness G_c, J/m². @param most It tears no farther, m².
  /// @param stage As of evaluate().
  /// @note Realtime-safe.
  template <class Stage>
  [[nodiscard]] double tear(double area, double toughness, double most,
                            const Stage& stage) const noexcept {
    const double end = std::min(most, whole_area());
    // It comes to rest within an interval at most twice: at G = G_c, and where what is left of the
    // interval does not pay for itself.
    for (int step = 0; step < 2 * num_stages() && area < end; ++step) {
      const int below = stage_below(area);
      const double torn = tear_within(gather(below, stage), area, toughness);
      const bool rests = !(torn - area > kRounding * whole_area());
      area = std::max(area, torn);
      if (rests && area < areas_[static_cast<std::size_t>(below) + 1]) break;
    }
    return std::min(area, end);
  }

 private:
  static constexpr double kRounding = 1e-12;

  /// The results at the stages around an interval.
  struct Around {
    /// The first of them, and the one at the lower end of the interval.
    int first = 0;
    int below = 0;
    int count = 0;
    std::array<TouchResult, kMostStages> at;
  };

  template <class Stage>
  [[nodiscard]] Around gather(int below, const Stage& stage) const noexcept {
    Around around;
    around.below = below;
    around.first = std::max(below - 1, 0);
    around.count = std::min(below + 3, num_stages()) - around.first;
    for (int k = 0; k < around.count; ++k) {
      around.at[static_cast<std::size_t>(k)] = stage(around.first + k);
    }
    return around;
  }

  [[nodiscard]] TornResult interpolate(const Around& around, double area) const noexcept;
  /// How far an area tears within its interval; the same area: not at all.
  [[nodiscard]] double tear_within(const Around& around, double area,
                                   double toughness) const noexcept;
  struct Jet;
  struct Cubic;
  [[nodiscard]] Cubic cubic(const Around& around) const noexcept;
  /// ∂Π/∂A at a stage.
  [[nodiscard]] Jet slope(const Around& around, int stage) const noexcept;
  [[nodiscard]] Jet secant(const Around& around, int below) const noexcept;
  [[nodiscard]] double width(int below) const noexcept {
    return areas_[static_cast<std::size_t>(below) + 1] - areas_[static_cast<std::size_t>(below)];
  }

  std::vector<double> areas_;
};

}  // namespace palpate
