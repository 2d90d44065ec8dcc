// SPDX-License-Identifier: BSD-3-Clause
// A load that is the same however the body deforms, such as its weight (assembly/mass.h): −fᵀx.
#pragma once

#include <utility>

#include "assembly/energy_term.h"

namespace palpate {

class DeadLoad final : public EnergyTerm {
 public:
  /// @param load f, N [state size].
  explicit DeadLoad(NodalVector load) : load_(std::move(load)) {}

  /// How much of it acts.
  void set_share(double share) { share_ = share; }

  double add(const NodalVector& state, NodalVector& force,
             std::vector<double>* /*values*/) const override {
    force -= share_ * load_;
    return -share_ * load_.dot(state);
  }

 private:
  NodalVector load_;
  double share_ = 1;
};

}  // namespace palpate
