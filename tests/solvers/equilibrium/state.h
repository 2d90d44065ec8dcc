// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "equilibrium/equilibrium.h"

namespace palpate::test {

/// The state that Assembly takes: the displacement, and behind it the pressures as lengths.
inline NodalVector state_of(const Assembly& assembly, const Equilibrium& equilibrium) {
  NodalVector state(assembly.state_size());
  state.head(equilibrium.u.size()) = equilibrium.u;
  for (Index i = 0; i < assembly.num_pressures(); ++i) {
    state[equilibrium.u.size() + i] = equilibrium.p[i] / assembly.pressure_scale()[i];
  }
  return state;
}

}  // namespace palpate::test
