// SPDX-License-Identifier: BSD-3-Clause
// A region that a function tells, on a grid.
#pragma once

#include <array>

#include "vtkSmartPointer.h"

class vtkImageData;
class vtkImplicitFunction;

/// The function on a grid, as the point array `Region`: within the bounds, and again more finely
/// where it is negative. Null if it is nowhere negative.
/// @param bounds m.
vtkSmartPointer<vtkImageData> vtkPalpateSampleRegion(
  vtkImplicitFunction* region, const std::array<double, 6>& bounds);
