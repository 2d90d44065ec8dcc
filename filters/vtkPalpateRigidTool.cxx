// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateRigidTool.h"

#include "base/error.h"
#include "vtkBoundingBox.h"
#include "vtkPalpateSurface.h"
#include "vtkPolyData.h"

namespace
{
void AddSurface(vtkPolyData* surface, palpate::RigidTool& tool)
{
  if (!surface || surface->GetNumberOfCells() == 0)
  {
    throw palpate::InputError(
      "The tool is a surface, but none is given. Connect one to the input Tool Surface.");
  }
  const vtkPalpateSurface whole = vtkPalpateSurfaceFromPolyData(surface);
  vtkBoundingBox box;
  for (const vtkPalpatePoint& point : whole.Points)
  {
    box.AddPoint(point[0], point[1], point[2]);
  }
  palpate::Vec3 middle;
  box.GetCenter(middle.data());
  for (const vtkPalpatePoint& point : whole.Points)
  {
    tool.points.push_back(palpate::Vec3(point.data()) - middle);
  }
  for (const auto& [a, b, c] : whole.Triangles)
  {
    tool.triangles.push_back({ static_cast<palpate::Index>(a), static_cast<palpate::Index>(b),
      static_cast<palpate::Index>(c) });
  }
}
}

palpate::RigidTool vtkPalpateRigidTool(
  const vtkPalpateToolProperties& properties, vtkPolyData* surface)
{
  palpate::RigidTool tool;
  tool.shape = static_cast<palpate::ToolShape>(properties.Kind - vtkPalpateSphere);
  if (tool.shape == palpate::ToolShape::surface)
  {
    AddSurface(surface, tool);
  }
  else
  {
    tool.radius = properties.Radius;
  }
  if (tool.shape == palpate::ToolShape::capsule)
  {
    tool.axis = palpate::Vec3(properties.Axis);
    tool.length = properties.Length;
  }
  tool.law = { properties.Thickness, properties.Stiffness };
  return tool;
}
