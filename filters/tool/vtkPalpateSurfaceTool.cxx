// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSurfaceTool.h"

#include "base/error.h"
#include "interaction/rigid_tool.h"
#include "vtkBoundingBox.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateSurface.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkPalpateSurfaceTool);

void vtkPalpateSurfaceTool::DescribeShape(vtkPolyData* surface, palpate::RigidTool& tool) const
{
  tool.shape = palpate::ToolShape::surface;
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
