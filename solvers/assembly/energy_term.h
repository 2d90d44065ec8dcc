// SPDX-License-Identifier: BSD-3-Clause
// A part of the energy of a body besides that of its materials, such as inertia within a step in
// time.
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate {

class EnergyTerm {
 public:
  virtual ~EnergyTerm() = default;

  /// Adds the derivative by the state to `force`, N, and where there are `values` the second one to
  /// these, on Assembly::pattern(), N/m. @returns The energy, J.
  virtual double add(const NodalVector& state, NodalVector& force,
                     std::vector<double>* values) const = 0;

 protected:
  EnergyTerm() = default;
  EnergyTerm(const EnergyTerm&) = default;
  EnergyTerm& operator=(const EnergyTerm&) = default;
};

}  // namespace palpate
