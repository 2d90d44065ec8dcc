// SPDX-License-Identifier: BSD-3-Clause
// The unit of length of an input from elsewhere. From the output of the first filter on, all
// lengths are in m.
#pragma once

#include <string>

#include "base/error.h"

struct vtkPalpateUnit
{
  /// Values of the properties Unit.
  enum Units
  {
    NotSaid = -1,
    Metre = 0,
    Centimetre = 1,
    Millimetre = 2,
    Micrometre = 3
  };

  /// The length of a unit, m. @throws palpate::InputError there is no such unit.
  static double Length(int unit)
  {
    switch (unit)
    {
      case Metre:
        return 1;
      case Centimetre:
        return 1e-2;
      case Millimetre:
        return 1e-3;
      case Micrometre:
        return 1e-6;
      default:
        throw palpate::InputError(
          "Unit is " + std::to_string(unit) + "; there are 0 (m), 1 (cm), 2 (mm) and 3 (µm).");
    }
  }
};
