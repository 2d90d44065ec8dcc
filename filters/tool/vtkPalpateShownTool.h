// SPDX-License-Identifier: BSD-3-Clause
// The surface by which a rigid tool is shown.
#pragma once

#include <array>
#include <vector>

#include "PalpateToolModule.h"
#include "interaction/rigid_tool.h"
#include "vtkSmartPointer.h"

class vtkPolyData;

/// The surface of these triangles; the places of its points are in m.
PALPATETOOL_EXPORT vtkSmartPointer<vtkPolyData> vtkPalpateTriangles(
  const std::vector<palpate::Vec3>& places,
  const std::vector<std::array<palpate::Index, 3>>& triangles);

/// The surface of the tool around its middle, with normals unless it is a surface itself. A sphere
/// or capsule without a radius is a vertex.
PALPATETOOL_EXPORT vtkSmartPointer<vtkPolyData> vtkPalpateToolSurface(
  const palpate::RigidTool& tool);
