// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/near_states.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// The force comes in while its part along the forces of the configurations is less than this share
/// of them.
constexpr double kComesIn = 0.1;
/// Places farther out than so many reaches from the origin have none.
constexpr double kFarthest = 1e9;

}  // namespace

NearStates::NearStates(const std::vector<ConfigurationSummary>& configurations, double reach)
    : reach_(reach) {
  for (std::size_t c = 0; c < configurations.size(); ++c) {
    const ConfigurationSummary& found = configurations[c];
    if (!found.usable() || found.level != 0) continue;
    if ((found.flags & (flags::touches_nothing | kMarking)) != 0) continue;
    if (!std::isfinite(found.energy) || !found.force.allFinite() || !found.stiffness.allFinite()) {
      continue;
    }
    states_.push_back({bin_of(found.t), static_cast<std::int32_t>(c), found.t, found.energy,
                       found.force, found.stiffness});
  }
  std::sort(states_.begin(), states_.end(), [](const State& a, const State& b) {
    return a.bin != b.bin ? a.bin < b.bin : a.number < b.number;
  });
}

NearStates::Bin NearStates::bin_of(const Vec3& x) const noexcept {
  Bin bin{};
  for (int k = 0; k < 3; ++k) {
    const double number = std::floor(x[k] / reach_);
    bin[static_cast<std::size_t>(k)] =
        static_cast<std::int32_t>(std::clamp(number, -kFarthest, kFarthest));
  }
  return bin;
}

bool NearStates::reaches(const Vec3& x) const noexcept {
  bool is_any = false;
  if (x.allFinite()) {
    visit_near(x, [&](const State&, const Vec3&, double w, double) { is_any = is_any || w > 0; });
  }
  return is_any;
}

TouchResult NearStates::evaluate(const Vec3& x) const noexcept {
  TouchResult result;
  if (!x.allFinite()) return result;
  // Sums of w, w T, w ∂T, T ∂w, ∂w, w k and w h.
  double weight = 0;
  double energy = 0;
  Vec3 force = Vec3::Zero();
  Vec3 of_weights = Vec3::Zero();
  Mat3 stiffness = Mat3::Zero();
  Vec3 unmoved = Vec3::Zero();
  double base = 0;
  bool is_any = false;
  visit_near(x, [&](const State& state, const Vec3& d, double w, double slope) {
    // Energies are counted from that of one of them: small differences of large ones remain exact.
    if (!is_any) base = state.energy;
    is_any = true;
    const Vec3 turned = state.stiffness * d;
    const double expanded = state.energy - base + state.force.dot(d) + 0.5 * d.dot(turned);
    weight += w;
    energy += w * expanded;
    force += w * (state.force + turned);
    of_weights += slope * expanded * d;
    stiffness += w * state.stiffness;
    unmoved += w * state.force;
  });
  if (!is_any || !(weight > 0)) return result;
  Vec3 change = Vec3::Zero();
  visit_near(x, [&](const State&, const Vec3& d, double, double slope) { change += slope * d; });
  energy /= weight;
  force = (force + of_weights - energy * change) / weight;
  const Vec3 usual = unmoved / weight;
  const double along = force.dot(usual) / usual.squaredNorm();
  const double share = std::isfinite(along) ? std::clamp(along / kComesIn, 0.0, 1.0) : 0;
  result.support = Support::extrapolated;
  result.energy = share * (energy + base);
  result.force = share * force;
  result.stiffness = share * stiffness / weight;
  if (!result.force.allFinite() || !std::isfinite(result.energy)) return {};
  return result;
}

}  // namespace palpate
