// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateShownTool.h"

#include <array>
#include <cmath>

#include "base/error.h"
#include "interaction/rigid_shape.h"
#include "interaction/shape_kind.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFlyingEdges3D.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSphereSource.h"

namespace
{
/// The number of voxels across the largest extent of a tool.
constexpr int VoxelsAcross = 48;

/// The surface on which the distance to a shape is 0.
vtkSmartPointer<vtkPolyData> Contour(const palpate::RigidShape& shape)
{
  const Eigen::AlignedBox3d box = shape.bounds();
  if (box.isEmpty() || !box.sizes().allFinite() || !(box.sizes().maxCoeff() > 0))
  {
    throw palpate::InputError("The tool has no shape that can be shown: the box around it is "
                              "empty or without end.");
  }
  const double spacing = box.sizes().maxCoeff() / VoxelsAcross;
  const palpate::Vec3 origin = box.min() - palpate::Vec3::Constant(spacing);
  std::array<int, 3> numbers;
  for (int axis = 0; axis < 3; ++axis)
  {
    numbers[axis] = static_cast<int>(std::ceil(box.sizes()[axis] / spacing)) + 3;
  }
  vtkNew<vtkImageData> image;
  image->SetDimensions(numbers.data());
  image->SetSpacing(spacing, spacing, spacing);
  image->SetOrigin(origin.data());
  vtkNew<vtkDoubleArray> distances;
  distances->SetNumberOfTuples(image->GetNumberOfPoints());
  for (vtkIdType p = 0; p < image->GetNumberOfPoints(); ++p)
  {
    distances->SetValue(p, shape.value(palpate::Vec3(image->GetPoint(p))));
  }
  image->GetPointData()->SetScalars(distances);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(image);
  contour->SetValue(0, 0);
  contour->ComputeScalarsOff();
  contour->Update();
  return contour->GetOutput();
}
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
  if (tool.shape != palpate::ToolShape::sphere && tool.shape != palpate::ToolShape::capsule)
  {
    return Contour(*palpate::shape_kind(tool.shape).make(tool));
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
