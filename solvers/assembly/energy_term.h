// SPDX-License-Identifier: BSD-3-Clause
// A part of the energy of a body besides that of its materials, such as inertia in a time step.
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate {

class EnergyTerm {
 public:
  virtual ~EnergyTerm() = default;

  /// Adds the derivative with respect to the state to `force`, N, and, unless it is null, the
  /// second derivative to `values`, on Assembly::pattern(), N/m.
  /// @returns The energy, J.
  virtual double add(const NodalVector& state, NodalVector& force,
                     std::vector<double>* values) const = 0;

 protected:
  EnergyTerm() = default;
  EnergyTerm(const EnergyTerm&) = default;
  EnergyTerm& operator=(const EnergyTerm&) = default;
};

}  // namespace palpate
