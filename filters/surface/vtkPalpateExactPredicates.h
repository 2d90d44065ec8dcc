// SPDX-License-Identifier: BSD-3-Clause
// Signs of the orientation determinants, always right. If the sign of the floating-point
// determinant is certain, it is taken; otherwise the determinant is evaluated without rounding as a
// sum of doubles that do not overlap (J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic
// and Fast Robust Geometric Predicates, 1997, theorems 7, 10, 18 and the bound A).
#pragma once

#include <array>

#include "PalpateSurfaceModule.h"

using vtkPalpatePoint = std::array<double, 3>;

/// Sign (−1, 0, 1) of det [a − d; b − d; c − d]: 1 where d lies below the triangle abc, seen with
/// abc counter-clockwise from above; 0 where the four points lie in one plane.
PALPATESURFACE_EXPORT int vtkPalpateOrient3D(const vtkPalpatePoint& a, const vtkPalpatePoint& b,
  const vtkPalpatePoint& c, const vtkPalpatePoint& d);

/// Sign (−1, 0, 1) of det [a − c; b − c] of the points seen along the axis `axis`, its tip towards
/// the eye: 1 where abc turns counter-clockwise, 0 where the three points lie on one line.
PALPATESURFACE_EXPORT int vtkPalpateOrient2D(
  const vtkPalpatePoint& a, const vtkPalpatePoint& b, const vtkPalpatePoint& c, int axis);
