// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/settings.h"

#include <cmath>
#include <string>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

void check(double value, const char* name, const char* unit) {
  if (std::isfinite(value) && value >= 0) return;
  throw InputError(std::string(name) + " is " + quantity(value, unit) + ". Give 0 or more.");
}

}  // namespace

void validate(const TouchSettings& settings) {
  check(settings.release_force, "The force at which a bonded tool lets go", "N");
  check(settings.reach, "The reach of active nodes", "m");
  check(settings.coupling_stiffness, "The stiffness of the coupling", "N/m");
  check(settings.fracture_toughness, "The fracture toughness", "J/m^2");
  check(settings.blade_toughness, "The toughness against the blade", "J/m^2");
  if (!(std::isfinite(settings.blade_stiffness) && settings.blade_stiffness > 0)) {
    throw InputError("The stiffness before the blade is " +
                     quantity(settings.blade_stiffness, "N/m") + ". Give more than 0.");
  }
  check(settings.blade_friction, "The friction of the blade", "N");
  check(settings.friction, "The coefficient of friction", "");
}

}  // namespace palpate
