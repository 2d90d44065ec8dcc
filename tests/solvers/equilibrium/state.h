// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "equilibrium/equilibrium.h"

namespace palpate::test {

/// The state that Assembly takes: the displacement, and behind it the pressures as lengths.
inline NodalVector state_of(const Assembly& assembly, const Equilibrium& equilibrium) {
  NodalVector state(assembly.state_size());
  state.head(equilibrium.u.size()) = equilibrium.u;
  if (assembly.num_pressures() > 0) {
    state.tail(assembly.num_pressures()) = equilibrium.p / assembly.pressure_scale();
  }
  return state;
}

}  // namespace palpate::test
