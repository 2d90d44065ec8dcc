// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateRigidTool.h"

#include "base/error.h"
#include "vtkBoundingBox.h"
#include "vtkCellArray.h"
#include "vtkNew.h"
#include "vtkPalpateSurface.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSphereSource.h"

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

void vtkPalpatePrintTool(ostream& os, vtkIndent indent, const vtkPalpateToolProperties& properties)
{
  os << indent << "Tool: " << properties.Kind << '\n'
     << indent << "ToolRadius: " << properties.Radius << " m\n"
     << indent << "ToolAxis: " << properties.Axis[0] << ' ' << properties.Axis[1] << ' '
     << properties.Axis[2] << '\n'
     << indent << "ToolLength: " << properties.Length << " m\n"
     << indent << "ContactThickness: " << properties.Thickness << " m\n"
     << indent << "ContactStiffness: " << properties.Stiffness << " Pa\n";
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

vtkSmartPointer<vtkPolyData> vtkPalpateTriangles(const std::vector<palpate::Vec3>& places,
  const std::vector<std::array<palpate::Index, 3>>& triangles)
{
  vtkNew<vtkPoints> points;
  for (const palpate::Vec3& place : places)
  {
    points->InsertNextPoint(place.data());
  }
  vtkNew<vtkCellArray> cells;
  for (const auto& [a, b, c] : triangles)
  {
    cells->InsertNextCell({ a, b, c });
  }
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(points);
  surface->SetPolys(cells);
  return surface;
}

vtkSmartPointer<vtkPolyData> vtkPalpateToolSurface(const palpate::RigidTool& tool)
{
  if (tool.shape == palpate::ToolShape::surface)
  {
    return vtkPalpateTriangles(tool.points, tool.triangles);
  }
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  if (tool.radius == 0)
  {
    vtkNew<vtkPoints> points;
    points->InsertNextPoint(0, 0, 0);
    vtkNew<vtkCellArray> vertex;
    vertex->InsertNextCell({ 0 });
    surface->SetPoints(points);
    surface->SetVerts(vertex);
    return surface;
  }
  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(tool.radius);
  sphere->SetThetaResolution(48);
  sphere->SetPhiResolution(32);
  sphere->Update();
  surface->DeepCopy(sphere->GetOutput());
  // A capsule is a sphere whose halves are moved apart.
  const palpate::Vec3 half = tool.length > 0
    ? palpate::Vec3(0.5 * tool.length * tool.axis.normalized())
    : palpate::Vec3::Zero();
  for (vtkIdType p = 0; p < surface->GetNumberOfPoints(); ++p)
  {
    palpate::Vec3 place(surface->GetPoint(p));
    place += place.dot(half) < 0 ? -half : half;
    surface->GetPoints()->SetPoint(p, place.data());
  }
  return surface;
}
