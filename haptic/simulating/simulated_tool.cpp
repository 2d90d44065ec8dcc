// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/simulating/simulated_tool.h"

#include <cmath>
#include <string>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

void check(bool good, const char* name, double value, const char* unit, const char* range) {
  if (good && std::isfinite(value)) return;
  throw InputError(std::string(name) + " of a simulated tool is " + quantity(value, unit) +
                   ". Give " + range + ".");
}

}  // namespace

void validate(const SimulatedToolOptions& options) {
  if (!options.place.allFinite()) {
    throw InputError("The place of a simulated tool is not finite.");
  }
  check(options.reach > 0, "The reach", options.reach, "m", "more than 0");
  check(options.coupling_stiffness > 0, "The stiffness of the coupling", options.coupling_stiffness,
        "N/m", "more than 0");
  check(options.coupling_damping >= 0, "The damping of the coupling", options.coupling_damping,
        "N·s/m", "0 or more");
  check(options.release_after.count() > 0, "The time without a step after which it lets go",
        seconds(options.release_after), "s", "more than 0");
}

}  // namespace palpate
