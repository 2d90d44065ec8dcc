// SPDX-License-Identifier: BSD-3-Clause
// Surfaces to mesh, good and bad, and what the tests measure on the result.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "vtkAppendPolyData.h"
#include "vtkCellArray.h"
#include "vtkCleanPolyData.h"
#include "vtkCubeSource.h"
#include "vtkLogger.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOutputWindow.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkReverseSense.h"
#include "vtkSmartPointer.h"
#include "vtkSphereSource.h"
#include "vtkTetra.h"
#include "vtkTriangleFilter.h"
#include "vtkUnstructuredGrid.h"

namespace palpate::test {

inline vtkSmartPointer<vtkPolyData> Sphere(double radius, std::array<double, 3> centre = {0, 0, 0},
                                           int resolution = 16) {
  vtkNew<vtkSphereSource> source;
  source->SetRadius(radius);
  source->SetCenter(centre.data());
  source->SetThetaResolution(resolution);
  source->SetPhiResolution(resolution);
  source->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  source->Update();
  return source->GetOutput();
}

/// Six quads with points of their own each.
inline vtkSmartPointer<vtkPolyData> Cube(double side, std::array<double, 3> centre = {0, 0, 0}) {
  vtkNew<vtkCubeSource> source;
  source->SetXLength(side);
  source->SetYLength(side);
  source->SetZLength(side);
  source->SetCenter(centre.data());
  source->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  source->Update();
  return source->GetOutput();
}

inline vtkSmartPointer<vtkPolyData> Triangles(vtkPolyData* input) {
  vtkNew<vtkCleanPolyData> clean;
  clean->SetInputData(input);
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputConnection(clean->GetOutputPort());
  triangles->Update();
  return triangles->GetOutput();
}

inline vtkSmartPointer<vtkPolyData> Append(
    const std::vector<vtkSmartPointer<vtkPolyData>>& surfaces) {
  vtkNew<vtkAppendPolyData> append;
  append->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  for (const auto& surface : surfaces) {
    append->AddInputData(surface);
  }
  append->Update();
  return append->GetOutput();
}

inline vtkSmartPointer<vtkPolyData> InsideOut(vtkPolyData* surface) {
  vtkNew<vtkReverseSense> reverse;
  reverse->SetInputData(surface);
  reverse->ReverseCellsOn();
  reverse->Update();
  return reverse->GetOutput();
}

/// Without the polygons of the given ids.
inline vtkSmartPointer<vtkPolyData> Without(vtkPolyData* surface,
                                            const std::vector<vtkIdType>& ids) {
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->DeepCopy(surface);
  result->BuildCells();
  for (const vtkIdType id : ids) {
    result->DeleteCell(id);
  }
  result->RemoveDeletedCells();
  return result;
}

inline vtkSmartPointer<vtkPolyData> Scaled(vtkPolyData* surface, double factor, double shift = 0) {
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->DeepCopy(surface);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
    double x[3];
    surface->GetPoint(i, x);
    points->InsertNextPoint(factor * x[0] + shift, factor * x[1] + shift, factor * x[2] + shift);
  }
  result->SetPoints(points);
  return result;
}

inline vtkSmartPointer<vtkPolyData> FromArrays(const std::vector<std::array<double, 3>>& points,
                                               const std::vector<std::vector<vtkIdType>>& cells) {
  vtkNew<vtkPoints> vtk_points;
  vtk_points->SetDataTypeToDouble();
  for (const auto& x : points) {
    vtk_points->InsertNextPoint(x.data());
  }
  vtkNew<vtkCellArray> polys;
  for (const auto& cell : cells) {
    polys->InsertNextCell(static_cast<vtkIdType>(cell.size()), cell.data());
  }
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->SetPoints(vtk_points);
  result->SetPolys(polys);
  return result;
}

/// Of each cell, by its corners; positive where VTK counts it as such.
inline std::vector<double> Volumes(vtkUnstructuredGrid* grid) {
  std::vector<double> volumes;
  for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i) {
    vtkIdType size;
    const vtkIdType* ids;
    grid->GetCellPoints(i, size, ids);
    double p[4][3];
    for (int corner = 0; corner < 4; ++corner) {
      grid->GetPoint(ids[corner], p[corner]);
    }
    volumes.push_back(vtkTetra::ComputeVolume(p[0], p[1], p[2], p[3]));
  }
  return volumes;
}

inline double TotalVolume(vtkUnstructuredGrid* grid) {
  double total = 0;
  for (const double volume : Volumes(grid)) {
    total += volume;
  }
  return total;
}

/// Collects the errors and warnings of all VTK objects while it lives.
class Messages : public vtkOutputWindow {
 public:
  static Messages* New();
  vtkTypeMacro(Messages, vtkOutputWindow);
  void DisplayText(const char* text) override { Others.emplace_back(text); }
  void DisplayErrorText(const char* text) override { Errors.emplace_back(text); }
  void DisplayWarningText(const char* text) override { Others.emplace_back(text); }
  void DisplayGenericWarningText(const char* text) override { Others.emplace_back(text); }

  std::vector<std::string> Errors, Others;
};
inline vtkStandardNewMacro(Messages);

class CaughtMessages {
 public:
  CaughtMessages() : Before(vtkOutputWindow::GetInstance()) {
    vtkOutputWindow::SetInstance(Caught);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~CaughtMessages() { vtkOutputWindow::SetInstance(Before); }
  const std::vector<std::string>& Errors() const { return Caught->Errors; }
  const std::vector<std::string>& Others() const { return Caught->Others; }

 private:
  vtkNew<Messages> Caught;
  vtkSmartPointer<vtkOutputWindow> Before;
};

}  // namespace palpate::test
