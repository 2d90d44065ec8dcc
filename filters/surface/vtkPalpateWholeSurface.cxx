// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateWholeSurface.h"

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "base/error.h"
#include "vtkAppendPolyData.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkMultiPieceDataSet.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPalpateArrayCheck.h"
#include "vtkPalpateSurface.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

namespace
{
using palpate::InputError;

/// Values of RegionArray that are no names.
constexpr const char* Automatic = "Automatic";
constexpr const char* None = "None";

/// Names of arrays on their way between ranks.
constexpr const char* SlotArray = "PalpateSlot";
constexpr const char* ValueArray = "PalpateValue";
constexpr const char* ErrorArray = "PalpateError";

/// The points, polygons and strips that no other rank owns.
vtkSmartPointer<vtkPolyData> OwnPiece(vtkPolyData* input, bool withArrays)
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
  if (withArrays)
  {
    return piece;
  }
  auto structure = vtkSmartPointer<vtkPolyData>::New();
  structure->CopyStructure(piece);
  return structure;
}

/// One surface of the inputs, in the pieces that this rank has.
struct Slot
{
  std::string Name;
  std::vector<vtkPolyData*> Pieces;
};

/// The surfaces of all inputs.
class Slots
{
public:
  explicit Slots(const std::vector<vtkDataObject*>& inputs)
  {
    for (vtkDataObject* input : inputs)
    {
      this->Add(input, "");
    }
  }

  std::vector<Slot> All;
  std::string Error;

private:
  template <class Pieces>
  void AddPieces(Pieces* pieces, const std::string& name, unsigned int count)
  {
    Slot slot = { name, {} };
    for (unsigned int i = 0; i < count; ++i)
    {
      this->AddPiece(pieces->GetPartitionAsDataObject(i), slot);
    }
    All.push_back(slot);
  }

  void AddPiece(vtkDataObject* piece, Slot& slot)
  {
    if (auto* surface = vtkPolyData::SafeDownCast(piece))
    {
      try
      {
        vtkPalpateCheckArrays(surface);
        slot.Pieces.push_back(surface);
      }
      catch (const InputError& error)
      {
        Error = error.what();
      }
    }
    else if (piece)
    {
      Error = "The input" + (slot.Name.empty() ? "" : " '" + slot.Name + "'") + " is a " +
        piece->GetClassName() +
        ", but a surface is needed, a vtkPolyData. Use Extract Surface, or "
        "leave it out with Extract Block.";
    }
  }

  template <class Blocks>
  static std::string NameOf(Blocks* blocks, unsigned int i)
  {
    vtkInformation* about = blocks->HasMetaData(i) ? blocks->GetMetaData(i) : nullptr;
    return about && about->Has(vtkCompositeDataSet::NAME())
      ? about->Get(vtkCompositeDataSet::NAME())
      : "";
  }

  void Add(vtkDataObject* input, const std::string& name)
  {
    if (auto* blocks = vtkMultiBlockDataSet::SafeDownCast(input))
    {
      for (unsigned int i = 0; i < blocks->GetNumberOfBlocks(); ++i)
      {
        this->Add(blocks->GetBlock(i), NameOf(blocks, i));
      }
    }
    else if (auto* sets = vtkPartitionedDataSetCollection::SafeDownCast(input))
    {
      for (unsigned int i = 0; i < sets->GetNumberOfPartitionedDataSets(); ++i)
      {
        this->Add(sets->GetPartitionedDataSet(i), NameOf(sets, i));
      }
    }
    else if (auto* set = vtkPartitionedDataSet::SafeDownCast(input))
    {
      this->AddPieces(set, name, set->GetNumberOfPartitions());
    }
    else if (auto* pieces = vtkMultiPieceDataSet::SafeDownCast(input))
    {
      this->AddPieces(pieces, name, pieces->GetNumberOfPieces());
    }
    else
    {
      Slot slot = { name, {} };
      this->AddPiece(input, slot);
      All.push_back(slot);
    }
  }
};

/// The surfaces of this rank as one, with the arrays SlotArray and, where each of them has `array`,
/// ValueArray.
vtkSmartPointer<vtkPolyData> OwnTissues(const Slots& slots, const std::string& array)
{
  vtkNew<vtkAppendPolyData> append;
  append->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  for (std::size_t i = 0; i < slots.All.size(); ++i)
  {
    for (vtkPolyData* surface : slots.All[i].Pieces)
    {
      vtkNew<vtkPolyData> piece;
      piece->ShallowCopy(surface);
      if (piece->HasAnyGhostCells())
      {
        piece->RemoveGhostCells();
      }
      const vtkIdType cells = piece->GetNumberOfCells();
      if (cells == 0)
      {
        continue;
      }
      vtkNew<vtkPolyData> structure;
      structure->CopyStructure(piece);
      vtkNew<vtkIntArray> slot;
      slot->SetName(SlotArray);
      slot->SetNumberOfValues(cells);
      slot->FillValue(static_cast<int>(i));
      structure->GetCellData()->AddArray(slot);
      if (auto* values = piece->GetCellData()->GetArray(array.c_str());
          values && values->GetNumberOfComponents() == 1)
      {
        vtkNew<vtkDoubleArray> copy;
        copy->DeepCopy(values);
        copy->SetName(ValueArray);
        structure->GetCellData()->AddArray(copy);
      }
      append->AddInputData(structure);
    }
  }
  auto result = vtkSmartPointer<vtkPolyData>::New();
  if (append->GetNumberOfInputConnections(0) > 0)
  {
    append->Update();
    result->ShallowCopy(append->GetOutput());
  }
  if (!slots.Error.empty())
  {
    vtkNew<vtkStringArray> error;
    error->SetName(ErrorArray);
    error->InsertNextValue(slots.Error);
    result->GetFieldData()->AddArray(error);
  }
  return result;
}

void ThrowErrorOf(vtkPolyData* piece)
{
  if (auto* error =
        vtkStringArray::SafeDownCast(piece->GetFieldData()->GetAbstractArray(ErrorArray)))
  {
    throw InputError(error->GetValue(0));
  }
}

/// The first polygon: VTK counts vertices and lines before.
vtkIdType FirstPolygon(vtkPolyData* surface)
{
  return surface->GetNumberOfVerts() + surface->GetNumberOfLines();
}

/// Gives the surface's cells their index among the values that there are.
std::vector<int> IndexValues(vtkPolyData* surface, vtkDataArray* values, const std::string& name)
{
  std::map<int, int> index;
  const vtkIdType first = FirstPolygon(surface);
  for (vtkIdType i = first; i < values->GetNumberOfTuples(); ++i)
  {
    const double value = values->GetTuple1(i);
    if (!(std::abs(value) <= std::numeric_limits<int>::max()) || value != std::round(value))
    {
      std::ostringstream text;
      text << "Cell " << i << " of the surface has the value " << value << " in the array '" << name
           << "', but the number of a region is a whole number. Choose another RegionArray, or "
              "None.";
      throw InputError(text.str());
    }
    index.emplace(static_cast<int>(value), 0);
  }
  std::vector<int> numbers;
  for (auto& [number, place] : index)
  {
    place = static_cast<int>(numbers.size());
    numbers.push_back(number);
  }
  vtkNew<vtkIntArray> tissue;
  tissue->SetName(vtkPalpateTissueArray);
  tissue->SetNumberOfValues(values->GetNumberOfTuples());
  tissue->FillValue(0);
  for (vtkIdType i = first; i < values->GetNumberOfTuples(); ++i)
  {
    tissue->SetValue(i, index.at(static_cast<int>(values->GetTuple1(i))));
  }
  surface->GetCellData()->AddArray(tissue);
  return numbers;
}

/// Makes the surfaces on rank 0 from the pieces of all ranks.
vtkPalpateTissueSurfaces TissuesOf(
  vtkPolyData* surface, const std::vector<Slot>& slots, const std::string& array)
{
  vtkPalpateTissueSurfaces tissues;
  tissues.Surface = surface;
  auto* slot = surface->GetCellData()->GetArray(SlotArray);
  std::set<int> with_polygons;
  for (vtkIdType i = FirstPolygon(surface); slot && i < slot->GetNumberOfTuples(); ++i)
  {
    with_polygons.insert(static_cast<int>(slot->GetTuple1(i)));
  }
  for (std::size_t i = 0; i < slots.size() && !with_polygons.empty(); ++i)
  {
    if (with_polygons.count(static_cast<int>(i)) == 0)
    {
      tissues.Warning += (tissues.Warning.empty() ? "" : " ") + std::string("Input ") +
        std::to_string(i) + (slots[i].Name.empty() ? "" : " '" + slots[i].Name + "'") +
        " has no triangles and is left out.";
    }
  }
  if (with_polygons.size() > 1)
  {
    tissues.Numbers = IndexValues(surface, slot, SlotArray);
    bool named = false;
    for (const int number : tissues.Numbers)
    {
      tissues.Names.push_back(slots[number].Name);
      named = named || !slots[number].Name.empty();
    }
    if (!named)
    {
      tissues.Names.clear();
    }
    return tissues;
  }
  auto* values = surface->GetCellData()->GetArray(ValueArray);
  if (values && !with_polygons.empty())
  {
    tissues.Numbers = IndexValues(surface, values, array == Automatic ? "Region" : array);
  }
  else if (array != None && array != Automatic && !with_polygons.empty())
  {
    throw InputError("RegionArray is '" + array +
      "', but the surface has no cell array of that name with one number for each triangle.");
  }
  return tissues;
}
}

vtkSmartPointer<vtkPolyData> vtkPalpateGatherSurface(
  vtkPolyData* surface, vtkMultiProcessController* controller, bool withArrays)
{
  auto piece = OwnPiece(surface, withArrays);
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

vtkPalpateTissueSurfaces vtkPalpateGatherTissues(const std::vector<vtkDataObject*>& inputs,
  const std::string& array, vtkMultiProcessController* controller)
{
  const Slots slots(inputs);
  auto piece = OwnTissues(slots, array == Automatic ? "Region" : array);
  if (!controller || controller->GetNumberOfProcesses() == 1)
  {
    ThrowErrorOf(piece);
    return TissuesOf(piece, slots.All, array);
  }
  std::vector<vtkSmartPointer<vtkDataObject>> pieces;
  controller->Gather(piece, pieces, 0);
  if (controller->GetLocalProcessId() != 0)
  {
    return {};
  }
  vtkNew<vtkAppendPolyData> append;
  append->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  for (const auto& received : pieces)
  {
    auto* part = vtkPolyData::SafeDownCast(received);
    if (!part)
    {
      continue;
    }
    ThrowErrorOf(part);
    if (part->GetNumberOfCells() > 0)
    {
      append->AddInputData(part);
    }
  }
  auto whole = vtkSmartPointer<vtkPolyData>::New();
  if (append->GetNumberOfInputConnections(0) > 0)
  {
    append->Update();
    whole->ShallowCopy(append->GetOutput());
  }
  return TissuesOf(whole, slots.All, array);
}
