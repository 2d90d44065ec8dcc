// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpatePieces.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "vtkCellData.h"
#include "vtkCommunicator.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPalpateArrayCheck.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
bool IsGhost(vtkPointSet* piece, vtkIdType cell)
{
  vtkUnsignedCharArray* ghosts = piece->GetCellGhostArray();
  return ghosts && (ghosts->GetValue(cell) & vtkDataSetAttributes::DUPLICATECELL) != 0;
}

/// Copies points or cells of the pieces, with the arrays that all pieces have.
class AttributeCopier
{
public:
  using Get = vtkDataSetAttributes* (*)(vtkPointSet*);

  AttributeCopier(const vtkPalpatePieces& pieces, Get get, vtkDataSetAttributes* output)
    : Pieces(pieces)
    , GetAttributes(get)
    , Output(output)
  {
    for (const auto& piece : pieces)
    {
      this->Arrays.IntersectFieldList(get(piece));
    }
    output->CopyAllOn();
    output->CopyAllocate(this->Arrays);
  }

  void Copy(std::size_t piece, vtkIdType from, vtkIdType to)
  {
    this->Output->CopyData(
      this->Arrays, this->GetAttributes(this->Pieces[piece]), static_cast<int>(piece), from, to);
  }

private:
  const vtkPalpatePieces& Pieces;
  Get GetAttributes;
  vtkDataSetAttributes* Output;
  vtkDataSetAttributes::FieldList Arrays;
};
}

vtkPalpatePieces vtkPalpateGatherPieces(
  const vtkPalpatePieces& pieces, vtkMultiProcessController* controller)
{
  palpate::agree(*vtkPalpateCommunicator(controller),
    [&] { std::for_each(pieces.begin(), pieces.end(), vtkPalpateCheckArrays); });
  if (!controller || controller->GetNumberOfProcesses() == 1)
  {
    return pieces;
  }
  const bool isFirst = controller->GetLocalProcessId() == 0;
  // The pieces of rank 0 are already there.
  const int mine = isFirst ? 0 : static_cast<int>(pieces.size());
  int most = 0;
  controller->AllReduce(&mine, &most, 1, vtkCommunicator::MAX_OP);
  std::map<std::pair<int, int>, vtkSmartPointer<vtkPointSet>> others;
  for (int i = 0; i < most; ++i)
  {
    vtkSmartPointer<vtkPointSet> sent = vtkSmartPointer<vtkPolyData>::New();
    if (i < mine)
    {
      sent = pieces[static_cast<std::size_t>(i)];
    }
    std::vector<vtkSmartPointer<vtkDataObject>> received;
    controller->Gather(sent, received, 0);
    for (std::size_t rank = 1; rank < received.size(); ++rank)
    {
      auto* piece = vtkPointSet::SafeDownCast(received[rank]);
      if (piece && piece->GetNumberOfPoints() > 0)
      {
        others.emplace(std::pair(static_cast<int>(rank), i), piece);
      }
    }
  }
  if (!isFirst)
  {
    return {};
  }
  vtkPalpatePieces all = pieces;
  for (const auto& [place, piece] : others)
  {
    all.push_back(piece);
  }
  return all;
}

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateJoin(
  const vtkPalpatePieces& pieces, const vtkPalpateKeys& keys)
{
  using Place = std::pair<std::size_t, vtkIdType>; // piece, point
  std::map<std::vector<double>, Place> firsts;
  std::vector<std::vector<const std::vector<double>*>> keyOf(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p)
  {
    const std::vector<vtkDataArray*> arrays = keys(pieces[p]);
    for (vtkIdType point = 0; point < pieces[p]->GetNumberOfPoints(); ++point)
    {
      std::vector<double> key;
      for (vtkDataArray* array : arrays)
      {
        for (int c = 0; c < array->GetNumberOfComponents(); ++c)
        {
          key.push_back(array->GetComponent(point, c));
        }
      }
      keyOf[p].push_back(&firsts.try_emplace(std::move(key), p, point).first->first);
    }
  }

  auto joined = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  AttributeCopier ofPoints(
    pieces, [](vtkPointSet* piece) -> vtkDataSetAttributes* { return piece->GetPointData(); },
    joined->GetPointData());
  std::map<const std::vector<double>*, vtkIdType> idOf;
  for (const auto& [key, place] : firsts)
  {
    const auto& [piece, point] = place;
    const vtkIdType id = points->InsertNextPoint(pieces[piece]->GetPoint(point));
    ofPoints.Copy(piece, point, id);
    idOf.emplace(&key, id);
  }
  joined->SetPoints(points);

  AttributeCopier ofCells(
    pieces, [](vtkPointSet* piece) -> vtkDataSetAttributes* { return piece->GetCellData(); },
    joined->GetCellData());
  std::set<std::vector<vtkIdType>> seen;
  vtkNew<vtkIdList> ids;
  for (std::size_t p = 0; p < pieces.size(); ++p)
  {
    for (vtkIdType cell = 0; cell < pieces[p]->GetNumberOfCells(); ++cell)
    {
      pieces[p]->GetCellPoints(cell, ids);
      for (vtkIdType& id : *ids)
      {
        id = idOf.at(keyOf[p][static_cast<std::size_t>(id)]);
      }
      std::vector<vtkIdType> sorted(ids->begin(), ids->end());
      std::sort(sorted.begin(), sorted.end());
      if (!IsGhost(pieces[p], cell) && seen.insert(sorted).second)
      {
        ofCells.Copy(p, cell, joined->InsertNextCell(pieces[p]->GetCellType(cell), ids));
      }
    }
    if (joined->GetFieldData()->GetNumberOfArrays() == 0)
    {
      joined->GetFieldData()->ShallowCopy(pieces[p]->GetFieldData());
    }
  }
  for (vtkDataSetAttributes* attributes :
    { static_cast<vtkDataSetAttributes*>(joined->GetPointData()),
      static_cast<vtkDataSetAttributes*>(joined->GetCellData()) })
  {
    // This array says which points and cells were left out.
    attributes->RemoveArray(vtkDataSetAttributes::GhostArrayName());
  }
  return joined;
}
