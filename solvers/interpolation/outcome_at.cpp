// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/outcome_at.h"

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

/// The outcome of the nearest configuration to a place, among those that are looked at.
class Nearest {
 public:
  explicit Nearest(const Vec3& t) : t_(t) {}

  void look_at(const ConfigurationSummary& configuration) {
    const double distance = (configuration.t - t_).norm();
    if (!(distance < least_)) return;
    least_ = distance;
    outcome_ = configuration.outcome;
  }
  [[nodiscard]] Outcome outcome_or(Outcome none) const {
    return least_ < std::numeric_limits<double>::infinity() ? outcome_ : none;
  }

 private:
  Vec3 t_;
  double least_ = std::numeric_limits<double>::infinity();
  Outcome outcome_ = Outcome::not_converged;
};

}  // namespace

Outcome outcome_at(const CheckPointGrid& grid,
                   const std::vector<ConfigurationSummary>& configurations, const Vec3& t) {
  using Place = CheckPointGrid::Place;
  const CheckPointGrid::Location at = grid.locate(t);
  if (at.place == Place::free) return Outcome::converged;
  Nearest nearest(t);
  if (at.place == Place::nowhere || at.place == Place::rest) {
    for (const ConfigurationSummary& c : configurations) nearest.look_at(c);
    return nearest.outcome_or(Outcome::not_converged);
  }
  for (const std::int32_t node : grid.leaf(at.leaf).corners) {
    if (grid.usable(node)) continue;
    const CheckPoint corner = grid.tree().point(node);
    const auto first = std::lower_bound(
        configurations.begin(), configurations.end(), corner,
        [](const ConfigurationSummary& c, const CheckPoint& of) { return c.check_point < of; });
    for (auto c = first; c != configurations.end() && c->check_point == corner; ++c) {
      if (!c->usable()) nearest.look_at(*c);
    }
  }
  return nearest.outcome_or(Outcome::converged);
}

}  // namespace palpate
