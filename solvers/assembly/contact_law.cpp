// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/contact_law.h"

#include <cmath>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {

void validate(const ContactLaw& law) {
  if (!(std::isfinite(law.thickness) && law.thickness > 0)) {
    throw InputError("The contact thickness is " + quantity(law.thickness, "m") +
                     "; it must be a positive length.");
  }
  if (!(std::isfinite(law.stiffness) && law.stiffness > 0)) {
    throw InputError("The contact stiffness is " + quantity(law.stiffness, "Pa") +
                     "; it must be positive.");
  }
  if (!(law.offset >= 0 && law.offset < law.thickness)) {
    throw InputError("The layer of contact is drawn back by " + quantity(law.offset, "m") +
                     "; it must be at least 0 and less than its thickness of " +
                     quantity(law.thickness, "m") + ".");
  }
}

}  // namespace palpate
