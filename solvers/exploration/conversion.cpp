// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/conversion.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/outcome.h"
#include "schedule/owner.h"
#include "state_space/all_derivatives.h"

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

/// The number of coordinates that are the place of a tool.
constexpr Eigen::Index kPlace = 3;

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

/// The derivatives by all coordinates of a tool that is turned; empty: it is not, or it touches
/// nothing.
std::vector<double> of_turns(const Equilibrium& e) {
  if (e.t.size() == kPlace || e.outcome != Outcome::converged) return {};
  if ((e.flags & flags::touches_nothing) != 0) return {};
  return AllDerivatives::numbers(e.reaction, e.stiffness, e.third_derivative);
}

/// Leaves out what belongs to other coordinates of a tool than its place.
void keep_place(Equilibrium& e) {
  const Eigen::Index d = e.t.size();
  if (d == kPlace) return;
  if (e.third_derivative.size() > 0) {
    const std::vector<double> all =
        AllDerivatives::numbers(e.reaction, e.stiffness, e.third_derivative);
    const AllDerivatives derivatives(all, static_cast<std::size_t>(d));
    Eigen::VectorXd third(AllDerivatives::triples(kPlace));
    Eigen::Index next = 0;
    for (std::size_t a = 0; a < kPlace; ++a) {
      for (std::size_t b = a; b < kPlace; ++b) {
        for (std::size_t c = b; c < kPlace; ++c) third[next++] = derivatives.by(a, b, c);
      }
    }
    e.third_derivative = third;
  }
  e.t.conservativeResize(kPlace);
  if (e.reaction.size() == d) e.reaction.conservativeResize(kPlace);
  if (e.stiffness.rows() == d) e.stiffness.conservativeResize(kPlace, kPlace);
  for (Eigen::MatrixXd* sensitivity : {&e.v, &e.p_v}) {
    if (sensitivity->cols() == d) {
      sensitivity->conservativeResize(Eigen::NoChange, kPlace);
    }
  }
}

}  // namespace

Equilibrium to_equilibrium(Configuration&& c) {
  Equilibrium e;
  for_each_shared_part(e, c, [](auto& to, auto& from) { to = std::move(from); });
  return e;
}

Configuration to_configuration(Equilibrium&& e) {
  Configuration c;
  c.of_turns = of_turns(e);
  keep_place(e);
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
