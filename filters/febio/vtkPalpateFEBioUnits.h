// SPDX-License-Identifier: BSD-3-Clause
// The systems of units of FEBio Studio (its FEBioLib/units and FEBioExport4::WriteModuleSection).
// FEBio itself computes with bare numbers.
#pragma once

#include <array>
#include <string>

#include "base/error.h"

struct vtkPalpateFEBioUnits
{
  /// The value of the property Units that stands for the units which the file names.
  static constexpr int NotSaid = -1;

  /// The text of the element <units>.
  const char* Name;
  /// The unit of length, m.
  double Length;
  /// The unit of pressure, mass / (length · time²), Pa.
  double Pressure;
  /// The unit of density, kg/m³. All systems have the time in s.
  double Density;

  /// The systems by the other values of the property.
  static const std::array<vtkPalpateFEBioUnits, 7>& All()
  {
    static constexpr std::array<vtkPalpateFEBioUnits, 7> all = { {
      { "SI", 1, 1, 1 },
      { "mm-N-s", 1e-3, 1e6, 1e12 },
      { "mm-kg-s", 1e-3, 1e3, 1e9 },
      { "um-nN-s", 1e-6, 1e3, 1e15 },
      { "CGS", 1e-2, 0.1, 1e3 },
      { "mm-g-s", 1e-3, 1, 1e6 },
      { "mm-mg-s", 1e-3, 1e-3, 1e3 },
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
