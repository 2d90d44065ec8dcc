// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateWholeBody.h"

#include <algorithm>
#include <exception>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "base/error.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPalpateScene.h"
#include "vtkUnstructuredGrid.h"

namespace
{
constexpr int BodyTag = 7401;

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
  vtkUnstructuredGrid* piece, vtkMultiProcessController* controller)
{
  const int numberOfRanks = controller ? controller->GetNumberOfProcesses() : 1;
  if (numberOfRanks == 1)
  {
    return piece;
  }
  const int rank = controller->GetLocalProcessId();
  const vtkIdType numberOfCells = piece->GetNumberOfCells();
  std::vector<vtkIdType> cellsOfRank(numberOfRanks, 0);
  controller->AllGather(&numberOfCells, cellsOfRank.data(), 1);

  const auto owners = std::count_if(
    cellsOfRank.begin(), cellsOfRank.end(), [](vtkIdType cells) { return cells > 0; });
  if (owners > 1)
  {
    if (rank != 0)
    {
      return nullptr;
    }
    throw palpate::InputError("The body is spread over " + std::to_string(owners) +
      " ranks, so that the ids of its points are ambiguous. Save it into one .vtu file with one "
      "rank, and read that.");
  }
  const auto owner = static_cast<int>(
    std::max_element(cellsOfRank.begin(), cellsOfRank.end()) - cellsOfRank.begin());
  if (owner == 0)
  {
    return rank == 0 ? piece : nullptr;
  }
  if (rank == owner)
  {
    controller->Send(piece, 0, BodyTag);
  }
  if (rank != 0)
  {
    return nullptr;
  }
  auto body = vtkSmartPointer<vtkUnstructuredGrid>::New();
  controller->Receive(body, owner, BodyTag);
  return body;
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
