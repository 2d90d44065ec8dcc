// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateMeshGrid.h"

#include <algorithm>
#include <array>

#include "vtkCellArray.h"
#include "vtkCellType.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGridFromMesh(const palpate::TetMesh& mesh)
{
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(mesh.num_points());
  for (palpate::Index point = 0; point < mesh.num_points(); ++point)
  {
    points->SetPoint(point, mesh.points[point].data());
  }
  grid->SetPoints(points);

  const int nodesPerCell = palpate::nodes_per_cell(mesh.order);
  vtkNew<vtkCellArray> cells;
  cells->AllocateExact(mesh.num_cells(), static_cast<vtkIdType>(mesh.cells.size()));
  for (palpate::Index cell = 0; cell < mesh.num_cells(); ++cell)
  {
    std::array<vtkIdType, 10> nodes{};
    std::copy_n(mesh.cell(cell), nodesPerCell, nodes.begin());
    cells->InsertNextCell(nodesPerCell, nodes.data());
  }
  grid->SetCells(
    mesh.order == palpate::ElementOrder::linear ? VTK_TETRA : VTK_QUADRATIC_TETRA, cells);

  return grid;
}
