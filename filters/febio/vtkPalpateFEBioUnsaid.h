// SPDX-License-Identifier: BSD-3-Clause
// What FEBio's file does not say of a body.
#pragma once

#include <string>
#include <vector>

#include "vtkPalpateFEBioParts.h"

namespace vtkPalpateFEBio
{
/// A sentence about each thing that FEBio's file does not say, or FEBio computes otherwise; empty
/// where it says all.
std::string Unsaid(vtkUnstructuredGrid* grid, const Body& body, const Regions& regions,
  const std::vector<Part>& parts);
}
