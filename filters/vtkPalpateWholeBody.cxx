// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateWholeBody.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "base/error.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPalpateScene.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

namespace
{
/// The text of rank 0 on every rank.
std::string Broadcast(std::string text, vtkMultiProcessController* controller)
{
  auto length = static_cast<vtkIdType>(text.size());
  controller->Broadcast(&length, 1, 0);
  text.resize(static_cast<std::size_t>(length));
  if (length > 0)
  {
    controller->Broadcast(text.data(), length, 0);
  }
  return text;
}
}

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGatherBody(
  const vtkPalpatePieces& own, vtkMultiProcessController* controller)
{
  vtkPalpatePieces withCells;
  std::copy_if(own.begin(), own.end(), std::back_inserter(withCells),
    [](vtkPointSet* piece) { return piece->GetNumberOfCells() > 0; });
  const vtkPalpatePieces pieces = vtkPalpateGatherPieces(withCells, controller);
  if (controller && controller->GetLocalProcessId() != 0)
  {
    return nullptr;
  }
  if (pieces.size() > 1)
  {
    return vtkPalpateJoin(pieces,
      [&pieces](vtkPointSet* piece) -> std::vector<vtkDataArray*>
      {
        if (vtkDataArray* ids = piece->GetPointData()->GetGlobalIds())
        {
          return { ids };
        }
        throw palpate::InputError("The body is in " + std::to_string(pieces.size()) +
          " pieces, and nothing tells which of their points are the same. Apply Generate Global "
          "Ids (from ParaView 5.13 on, Global Point And Cell Ids) to it first, or save it into one "
          ".vtu file with one rank, and read that.");
      });
  }
  if (!pieces.empty())
  {
    return vtkUnstructuredGrid::SafeDownCast(pieces.front());
  }
  auto* nothing = own.empty() ? nullptr : vtkUnstructuredGrid::SafeDownCast(own.front());
  return nothing ? vtkSmartPointer<vtkUnstructuredGrid>(nothing)
                 : vtkSmartPointer<vtkUnstructuredGrid>::New();
}

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGatherBody(
  vtkUnstructuredGrid* piece, vtkMultiProcessController* controller)
{
  return vtkPalpateGatherBody(vtkPalpatePieces{ piece }, controller);
}

palpate::Scene vtkPalpateShareScene(
  vtkUnstructuredGrid* body, vtkMultiProcessController* controller)
{
  if (!controller || controller->GetNumberOfProcesses() == 1)
  {
    return vtkPalpateSceneFromGrid(body);
  }
  palpate::Scene scene;
  std::string error;
  vtkNew<vtkUnstructuredGrid> shared;
  if (controller->GetLocalProcessId() == 0)
  {
    try
    {
      scene = vtkPalpateSceneFromGrid(body);
      shared->ShallowCopy(body);
    }
    catch (const std::exception& exception)
    {
      error = exception.what();
    }
  }
  error = Broadcast(error, controller);
  if (!error.empty())
  {
    throw palpate::InputError(error);
  }
  controller->Broadcast(shared, 0);
  return controller->GetLocalProcessId() == 0 ? scene : vtkPalpateSceneFromGrid(shared);
}
