// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/hertz_stiffness.h"

#include <cmath>

namespace palpate {

double hertz_stiffness(const ContactLaw& law, double layer_depth, double force,
                       double contact_modulus) {
  const double share = (law.reach() - layer_depth) / (0.75 * law.thickness);
  if (!(force > 0 && share > 0)) return 0;
  const double largest_pressure = law.stiffness * share * share * share;
  return 2 * contact_modulus * std::sqrt(1.5 * force / (M_PI * largest_pressure));
}

}  // namespace palpate
