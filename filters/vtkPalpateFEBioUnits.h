// SPDX-License-Identifier: BSD-3-Clause
// The systems of units of FEBio Studio (its FEBioLib/units and FEBioExport4::WriteModuleSection).
// FEBio itself computes with bare numbers.
#pragma once

#include <array>
#include <string>

#include "base/error.h"

struct vtkPalpateFEBioUnits
{
  /// Value of the property Units that leaves it to the file.
  static constexpr int NotSaid = -1;

  /// The text of the element <units>.
  const char* Name;
  /// In m.
  double Length;
  /// In Pa: mass / (length · time²).
  double Pressure;

  /// By the other values of the property.
  static const std::array<vtkPalpateFEBioUnits, 7>& All()
  {
    static constexpr std::array<vtkPalpateFEBioUnits, 7> all = { {
      { "SI", 1, 1 },
      { "mm-N-s", 1e-3, 1e6 },
      { "mm-kg-s", 1e-3, 1e3 },
      { "um-nN-s", 1e-6, 1e3 },
      { "CGS", 1e-2, 0.1 },
      { "mm-g-s", 1e-3, 1 },
      { "mm-mg-s", 1e-3, 1e-3 },
    } };
    return all;
  }

  static std::string Names()
  {
    std::string names;
    for (const vtkPalpateFEBioUnits& units : All())
    {
      names += (names.empty() ? "" : ", ") + std::string(units.Name);
    }
    return names;
  }
};
