// SPDX-License-Identifier: BSD-3-Clause
// The energy that a step in time adds to that of the materials:
//
//   ½ a (x − c)ᵀ M (x − c) + x · f_past − x · g + the potential of viscous stresses
//
// where a and c are those of the method (time_integration.h), f_past is a share of the forces at
// the end of the last step, and g is the weight.
#pragma once

#include <utility>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/energy_term.h"
#include "assembly/mass.h"

namespace palpate {

class StepTerm final : public EnergyTerm {
 public:
  StepTerm(const Assembly& assembly, const MassMatrix& mass, NodalVector load)
      : assembly_(assembly), mass_(mass), load_(std::move(load)) {}

  void set_load_share(double share) { load_share_ = share; }
  void set_inertia(double factor, const NodalVector& centre) {
    inertia_ = factor;
    centre_ = centre;
  }
  /// Sets a force that is constant during the step, N [state_size].
  void set_past(const NodalVector& force) { past_ = force; }
  void set_memory(const Memory* memory) { memory_ = memory; }
  /// The load, N.
  [[nodiscard]] const NodalVector& load() const { return load_; }

  double add(const NodalVector& state, NodalVector& force,
             std::vector<double>* values) const override;

  /// Inertia changes with the length of the step, and viscous forces from step to step.
  [[nodiscard]] bool is_constant_at_rest() const override { return false; }

 private:
  const Assembly& assembly_;
  const MassMatrix& mass_;
  NodalVector load_;
  double load_share_ = 1;
  double inertia_ = 0;
  NodalVector centre_;
  NodalVector past_;
  const Memory* memory_ = nullptr;
};

}  // namespace palpate
