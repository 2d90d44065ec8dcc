// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "PalpateToolModule.h"
#include "interaction/rigid_tool.h"
#include "vtkIndent.h"
#include "vtkSmartPointer.h"

class vtkPolyData;

/// How a body is touched: the entries of the property Tool. All but the first are rigid tools, in
/// the order of palpate::ToolShape.
enum vtkPalpateToolKind
{
  vtkPalpateBondedNode,
  vtkPalpateSphere,
  vtkPalpateCapsule,
  vtkPalpateSurfaceTool
};

/// The properties of a rigid tool, as they are set.
struct vtkPalpateToolProperties
{
  /// One of vtkPalpateToolKind.
  int Kind = vtkPalpateBondedNode;
  double Radius = 0.01;
  double Axis[3] = { 1, 0, 0 };
  double Length = 0.03;
  double Thickness = 0;
  double Stiffness = 0;
};

/// Those of a filter that has them.
template <class Filter>
vtkPalpateToolProperties vtkPalpateToolPropertiesOf(Filter& filter)
{
  const double* axis = filter.GetToolAxis();
  return { filter.GetTool(), filter.GetToolRadius(), { axis[0], axis[1], axis[2] },
    filter.GetToolLength(), filter.GetContactThickness(), filter.GetContactStiffness() };
}

/// Prints them as PrintSelf() of a filter does.
void vtkPalpatePrintTool(ostream& os, vtkIndent indent, const vtkPalpateToolProperties& properties);

/// The tool. What is 0 of its contact stays so, see palpate::with_defaults().
/// @param surface Where the tool is one: its middle is the middle of the bounds.
/// @throws palpate::InputError the tool is a surface, and that is missing or none.
palpate::RigidTool vtkPalpateRigidTool(
  const vtkPalpateToolProperties& properties, vtkPolyData* surface);

/// A surface of these triangles, m.
PALPATETOOL_EXPORT vtkSmartPointer<vtkPolyData> vtkPalpateTriangles(
  const std::vector<palpate::Vec3>& places,
  const std::vector<std::array<palpate::Index, 3>>& triangles);

/// The surface of the tool around its middle, with normals where it is a sphere or capsule. One
/// without a radius is a vertex.
PALPATETOOL_EXPORT vtkSmartPointer<vtkPolyData> vtkPalpateToolSurface(
  const palpate::RigidTool& tool);
