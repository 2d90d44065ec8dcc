// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateWholeBody.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "assembly/scene.h"
#include "base/error.h"
#include "exploration/transfer.h"
#include "materials/rheology.h"
#include "schedule/communicator.h"
#include "vtkMultiProcessController.h"
#include "vtkPalpateScene.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

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

namespace
{
/// @param read Reads the data from the body, on rank 0. @note Collective.
template <class Data, class Read>
Data Share(palpate::Communicator& communicator, Read&& read)
{
  Data data;
  palpate::Packer mine;
  palpate::agree(communicator,
    [&]
    {
      if (communicator.rank() == 0)
      {
        data = read();
      }
      if (communicator.rank() == 0 && communicator.size() > 1)
      {
        mine.put(data);
      }
    });
  const std::vector<palpate::Bytes> all = communicator.all_gather(mine.take());
  palpate::agree(communicator,
    [&]
    {
      if (communicator.rank() != 0)
      {
        data = palpate::Unpacker(all.front()).take<Data>();
      }
    });
  return data;
}
}

palpate::Scene vtkPalpateShareScene(vtkUnstructuredGrid* body, palpate::Communicator& communicator)
{
  return Share<palpate::Scene>(communicator, [&] { return vtkPalpateSceneFromGrid(body); });
}

palpate::Scene vtkPalpateShareScene(
  vtkUnstructuredGrid* body, palpate::Communicator& communicator, const palpate::Vec3& bodyForce)
{
  return Share<palpate::Scene>(
    communicator, [&] { return vtkPalpateSceneFromGrid(body, bodyForce); });
}

palpate::Scene vtkPalpateShareSceneOfSpace(
  vtkUnstructuredGrid* body, palpate::Communicator& communicator)
{
  return Share<palpate::Scene>(communicator,
    [&]
    {
      palpate::SettledBody atRest;
      return vtkPalpateSceneOfSpace(body, atRest);
    });
}

palpate::Scene vtkPalpateShareScene(vtkUnstructuredGrid* body, palpate::Communicator& communicator,
  std::vector<palpate::Rheology>& rheologies)
{
  auto both = Share<std::pair<palpate::Scene, std::vector<palpate::Rheology>>>(communicator,
    [&]
    {
      std::vector<palpate::Rheology> read;
      palpate::Scene scene = vtkPalpateSceneFromGrid(body, read);
      return std::make_pair(std::move(scene), std::move(read));
    });
  rheologies = std::move(both.second);
  return std::move(both.first);
}
