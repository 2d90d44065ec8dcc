// SPDX-License-Identifier: BSD-3-Clause
// The surface of a body that is touched, as it is shown.
#pragma once

#include "state_space/touch_space.h"
#include "vtkPalpateDisplaySurface.h"

class vtkCellArray;
class vtkFloatArray;
class vtkPartitionedDataSetCollection;
class vtkPolyData;

/// Gives the output the surface as it is displaced.
/// @param rest The surface at rest, and its `triangles` for VTK.
/// @param u The displacement of its points [3 points], m.
void vtkPalpateShowDisplaced(const palpate::Surface& rest, vtkCellArray* triangles,
  const Eigen::VectorXf& u, vtkPolyData* output);

/// The surface of the first body of a space as it was meshed. That of the space is at rest, and a
/// body may sag: the block of the body says by how much, where there is one.
/// @param input The space.
vtkPalpateDisplaySurface::Carrier vtkPalpateCarrierOfSpace(
  const palpate::TouchSpace& space, vtkPartitionedDataSetCollection* input);

/// Gives a surface whose points are displaced the displacement, as its vectors and scalars, and the
/// normals of its points.
void vtkPalpateAddDisplacement(vtkFloatArray* displacement, vtkPolyData* displaced);
