// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/conversion.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/outcome.h"
#include "schedule/owner.h"

namespace palpate {
namespace {

/// Calls visit(part of the equilibrium, part of the configuration) for each part that both have.
template <class OfEquilibrium, class OfConfiguration, class Visit>
void for_each_shared_part(OfEquilibrium& e, OfConfiguration& c, Visit&& visit) {
  visit(e.t, c.t);
  visit(e.u, c.u);
  visit(e.v, c.v);
  visit(e.p, c.p);
  visit(e.p_v, c.p_v);
  visit(e.energy, c.energy);
  visit(e.reaction, c.force);
  visit(e.stiffness, c.stiffness);
  visit(e.outcome, c.outcome);
  visit(e.flags, c.flags);
  visit(e.summary.residual, c.residual);
  visit(e.minimum_det_f, c.minimum_det_f);
  visit(e.negative_pivots, c.negative_pivots);
  visit(e.summary.iterations, c.iterations);
  visit(e.summary.seconds, c.seconds);
}

/// See ConfigurationSummary::signature.
Vec3 signature_of(const NodalVector& u) {
  constexpr std::uint64_t kSeed = 2007;
  const Eigen::Index num_points = u.size() / 3;
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index p = 0; p < num_points; ++p) {
    const bool plus = (mix(kSeed + static_cast<std::uint64_t>(p)) & 1) != 0;
    sum += (plus ? 1 : -1) * u.segment<3>(3 * p);
  }
  return sum / std::sqrt(static_cast<double>(std::max<Eigen::Index>(num_points, 1)));
}

}  // namespace

Equilibrium to_equilibrium(Configuration&& c) {
  Equilibrium e;
  for_each_shared_part(e, c, [](auto& to, auto& from) { to = std::move(from); });
  return e;
}

Configuration to_configuration(Equilibrium&& e) {
  Configuration c;
  for_each_shared_part(e, c, [](auto& from, auto& to) { to = std::move(from); });
  if (e.third_derivative.size() > 0) c.third_derivative = e.third_derivative;
  const bool at_rest = (c.flags & flags::touches_nothing) != 0;
  if (c.usable() && !at_rest) {
    c.signature = signature_of(c.u);
  } else {
    for_each_field(c, [](auto& field) { field = {}; });
  }
  return c;
}

}  // namespace palpate
