// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateRefinedGrid.h"

#include "elements/tetrahedron.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPalpateMeshGrid.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateRefinedGrid(
  vtkUnstructuredGrid* grid, const palpate::TetMesh& mesh, const palpate::Refinement& refinement)
{
  auto refined = vtkPalpateGridFromMesh(refinement.mesh);
  refined->GetFieldData()->ShallowCopy(grid->GetFieldData());

  vtkCellData* cells = refined->GetCellData();
  cells->CopyGlobalIdsOff();
  cells->CopyAllocate(grid->GetCellData(), refinement.mesh.num_cells());
  for (palpate::Index c = 0; c < refinement.mesh.num_cells(); ++c)
  {
    cells->CopyData(grid->GetCellData(), refinement.parents[c], c);
  }

  vtkPointData* points = refined->GetPointData();
  points->InterpolateAllocate(grid->GetPointData(), refinement.mesh.num_points());
  for (palpate::Index p = 0; p < mesh.num_points(); ++p)
  {
    points->CopyData(grid->GetPointData(), p, p);
  }
  const int nodes = palpate::nodes_per_cell(mesh.order);
  vtkNew<vtkIdList> ids;
  palpate::Index next = mesh.num_points();
  for (const palpate::Refinement::Place& place : refinement.new_points)
  {
    ids->Reset();
    for (int a = 0; a < nodes; ++a)
    {
      ids->InsertNextId(mesh.cell(place.cell)[a]);
    }
    // Reference coordinates are the barycentric ones of the corners after the first.
    Eigen::VectorXd weights =
      palpate::shape_values(mesh.order, palpate::Vec3(place.barycentric.tail<3>()));
    points->InterpolatePoint(grid->GetPointData(), next++, ids, weights.data());
  }
  return refined;
}
