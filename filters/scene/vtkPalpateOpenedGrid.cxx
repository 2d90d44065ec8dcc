// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateOpenedGrid.h"

#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkPalpateMeshGrid.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateOpenedGrid(vtkUnstructuredGrid* before,
  const palpate::TetMesh& mesh, const std::vector<palpate::Index>& originals)
{
  auto result = vtkPalpateGridFromMesh(mesh);
  result->GetCellData()->ShallowCopy(before->GetCellData());
  result->GetFieldData()->ShallowCopy(before->GetFieldData());
  vtkPointData* points = result->GetPointData();
  points->CopyGlobalIdsOff();
  points->CopyAllocate(before->GetPointData(), mesh.num_points());
  const vtkIdType numBefore = before->GetNumberOfPoints();
  points->CopyData(before->GetPointData(), 0, numBefore, 0);
  for (palpate::Index p = 0; p < static_cast<palpate::Index>(originals.size()); ++p)
  {
    points->CopyData(before->GetPointData(), originals[p], numBefore + p);
  }
  return result;
}
