// SPDX-License-Identifier: BSD-3-Clause
// The surface of a body that is touched, as it is shown.
#pragma once

#include "state_space/surface.h"

class vtkCellArray;
class vtkFloatArray;
class vtkPolyData;

/// Gives the output the surface as it is displaced.
/// @param rest The surface at rest, and its `triangles` for VTK.
/// @param u The displacement of its points [3 points], m.
void vtkPalpateShowDisplaced(const palpate::Surface& rest, vtkCellArray* triangles,
  const Eigen::VectorXf& u, vtkPolyData* output);

/// Gives a surface whose points are displaced the displacement, as its vectors and scalars, and the
/// normals of its points.
void vtkPalpateAddDisplacement(vtkFloatArray* displacement, vtkPolyData* displaced);
