// SPDX-License-Identifier: BSD-3-Clause
#include "dynamics/step_term.h"

namespace palpate {

double StepTerm::add(const NodalVector& state, NodalVector& force,
                     std::vector<double>* values) const {
  double energy = -load_share_ * load_.dot(state);
  force -= load_share_ * load_;
  if (past_.size() > 0) {
    energy += past_.dot(state);
    force += past_;
  }
  if (inertia_ > 0) {
    NodalVector way = NodalVector::Zero(state.size());
    way.head(centre_.size()) = state.head(centre_.size()) - centre_;
    const NodalVector of_mass = mass_.times(way);
    energy += 0.5 * inertia_ * way.dot(of_mass);
    force += inertia_ * of_mass;
    if (values != nullptr) mass_.add_to(inertia_, *values);
  }
  if (memory_ != nullptr) energy += assembly_.add_memory(*memory_, state, force, values);
  return energy;
}

}  // namespace palpate
