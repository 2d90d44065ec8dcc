// SPDX-License-Identifier: BSD-3-Clause
// Finds the properties of a body that FEBio's file cannot express.
#pragma once

#include <string>
#include <vector>

#include "vtkPalpateFEBioParts.h"

namespace vtkPalpateFEBio
{
/// A sentence about each property that FEBio's file cannot express, or that FEBio computes
/// otherwise; empty if there is none.
std::string Unsaid(vtkUnstructuredGrid* grid, const Body& body, const Regions& regions,
  const std::vector<Part>& parts);
}
