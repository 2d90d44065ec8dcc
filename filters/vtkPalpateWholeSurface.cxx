// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateWholeSurface.h"

#include <vector>

#include "vtkAppendPolyData.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPolyData.h"

namespace
{
/// Only what counts: points, polygons and strips that no other rank owns.
vtkSmartPointer<vtkPolyData> OwnPiece(vtkPolyData* input)
{
  auto piece = vtkSmartPointer<vtkPolyData>::New();
  if (!input)
  {
    return piece;
  }
  piece->ShallowCopy(input);
  if (piece->HasAnyGhostCells())
  {
    piece->RemoveGhostCells();
  }
  auto structure = vtkSmartPointer<vtkPolyData>::New();
  structure->CopyStructure(piece);
  return structure;
}
}

vtkSmartPointer<vtkPolyData> vtkPalpateGatherSurface(
  vtkPolyData* surface, vtkMultiProcessController* controller)
{
  auto piece = OwnPiece(surface);
  if (!controller || controller->GetNumberOfProcesses() == 1)
  {
    return piece;
  }
  std::vector<vtkSmartPointer<vtkDataObject>> pieces;
  controller->Gather(piece, pieces, 0);
  if (controller->GetLocalProcessId() != 0)
  {
    return nullptr;
  }
  vtkNew<vtkAppendPolyData> append;
  for (const auto& received : pieces)
  {
    if (auto* part = vtkPolyData::SafeDownCast(received); part && part->GetNumberOfCells() > 0)
    {
      append->AddInputData(part);
    }
  }
  if (append->GetNumberOfInputConnections(0) == 0)
  {
    return vtkSmartPointer<vtkPolyData>::New();
  }
  append->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  append->Update();
  return append->GetOutput();
}

vtkSmartPointer<vtkPolyData> vtkPalpateShareSurface(
  vtkPolyData* surface, vtkMultiProcessController* controller)
{
  if (!controller || controller->GetNumberOfProcesses() == 1)
  {
    return surface;
  }
  auto shared = vtkSmartPointer<vtkPolyData>::New();
  if (controller->GetLocalProcessId() == 0 && surface)
  {
    shared->ShallowCopy(surface);
  }
  controller->Broadcast(shared, 0);
  return shared;
}
