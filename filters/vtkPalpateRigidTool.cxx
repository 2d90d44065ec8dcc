// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateRigidTool.h"

#include <string>
#include <utility>

#include "base/error.h"
#include "vtkBoundingBox.h"
#include "vtkCellArray.h"
#include "vtkPolyData.h"

namespace
{
void AddSurface(vtkPolyData* surface, palpate::RigidTool& tool)
{
  if (!surface || surface->GetNumberOfPolys() == 0)
  {
    throw palpate::InputError(
      "The tool is a surface, but none is given. Connect one to the input Tool Surface.");
  }
  const vtkBoundingBox box(surface->GetBounds());
  palpate::Vec3 middle;
  box.GetCenter(middle.data());
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    palpate::Vec3 point;
    surface->GetPoint(i, point.data());
    tool.points.push_back(point - middle);
  }
  vtkCellArray* polygons = surface->GetPolys();
  for (vtkIdType cell = 0; cell < polygons->GetNumberOfCells(); ++cell)
  {
    vtkIdType size = 0;
    const vtkIdType* points = nullptr;
    polygons->GetCellAtId(cell, size, points);
    if (size != 3)
    {
      throw palpate::InputError("Cell " + std::to_string(cell) + " of the tool's surface has " +
        std::to_string(size) + " points. Make triangles of it with Triangulate.");
    }
    tool.triangles.push_back({ static_cast<palpate::Index>(points[0]),
      static_cast<palpate::Index>(points[1]), static_cast<palpate::Index>(points[2]) });
  }
}
}

palpate::RigidTool vtkPalpateRigidTool(
  const vtkPalpateToolProperties& properties, vtkPolyData* surface, const palpate::Scene& scene)
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
  return palpate::with_defaults(std::move(tool), scene);
}
