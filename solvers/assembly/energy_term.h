// SPDX-License-Identifier: BSD-3-Clause
// A part of the energy of a body besides that of its materials, such as that of a load, of springs
// or of inertia in a time step.
//
// A term that couples only points of one cell adds its second derivative to the values of the
// materials. A term that also couples other points names these pairs, with a block for each. The
// pattern of the system then has room for them (equilibrium/system_pattern.h).
#pragma once

#include <limits>
#include <vector>

#include "assembly/point_pair.h"
#include "base/types.h"

namespace palpate {

class EnergyTerm {
 public:
  virtual ~EnergyTerm() = default;

  /// Adds the derivative with respect to the state to `force`, N, and, unless it is null, the part
  /// of the second derivative that has a place on Assembly::pattern() to `values`, N/m.
  /// @returns The energy, J.
  virtual double add(const NodalVector& state, NodalVector& force,
                     std::vector<double>* values) const = 0;

  /// Sets the pairs of points that the term couples at a state, and their blocks.
  virtual void take_blocks(const NodalVector& /*state*/, PairBlocks& /*blocks*/) const {}

  /// The pairs of points that the term couples at a state, or may couple at states near it. When a
  /// new pair makes an analysis necessary, these have room from then on.
  [[nodiscard]] virtual std::vector<PointPair> pairs_around(const NodalVector& /*state*/) const {
    return {};
  }

  /// How far a point of the body may move in one step of a solve, m.
  [[nodiscard]] virtual double longest_step() const {
    return std::numeric_limits<double>::infinity();
  }

  /// The largest share of a step, at most 1, in which the term misses nothing, as a contact would
  /// whose surfaces pass through each other.
  [[nodiscard]] virtual double longest_share(const NodalVector& /*state*/,
                                             const NodalVector& /*step*/) const {
    return 1;
  }

  /// Whether the second derivative at the rest of the body stays the same from solve to solve, as
  /// that of a load or a spring does, so that one factor at rest serves them all. That of inertia
  /// does not: it changes with the time step.
  [[nodiscard]] virtual bool is_constant_at_rest() const { return true; }

 protected:
  EnergyTerm() = default;
  EnergyTerm(const EnergyTerm&) = default;
  EnergyTerm& operator=(const EnergyTerm&) = default;
};

}  // namespace palpate
