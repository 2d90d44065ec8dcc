// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "equilibrium/equilibrium.h"

namespace palpate::test {

/// The defaults, but for the tolerance.
inline EquilibriumOptions with_tolerance(double tolerance) {
  EquilibriumOptions options;
  options.tolerance = tolerance;
  return options;
}

}  // namespace palpate::test
