// SPDX-License-Identifier: BSD-3-Clause
// A load that is the same however the body deforms, such as its weight (assembly/mass.h):
// −fᵀ(x − x₀) − W₀, where the rest x₀ and the energy W₀ that the body has there without the load
// are zero until they are known. So the body has no energy at rest under the load.
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

  /// Lets the energy count from there. @param energy W₀, J.
  void count_from(const NodalVector& rest, double energy) {
    rest_ = rest;
    rest_energy_ = energy;
  }

  double add(const NodalVector& state, NodalVector& force,
             std::vector<double>* /*values*/) const override {
    force -= share_ * load_;
    if (rest_.size() == 0) return -share_ * load_.dot(state);
    return -share_ * load_.dot(state - rest_) - rest_energy_;
  }

 private:
  NodalVector load_;
  double share_ = 1;
  NodalVector rest_;
  double rest_energy_ = 0;
};

}  // namespace palpate
