// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateBodyCells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "base/error.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataSetTriangleFilter.h"
#include "vtkFieldData.h"
#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::InputError;
using Tetrahedron = std::array<vtkIdType, 4>;

constexpr const char* CellOfPart = "Cell";

/// A type of cells that can be cut: the type of its corners' cell, and the number of its corners.
struct Kind
{
  int Type;
  int OfCorners;
  vtkIdType Corners;
};

/// The types that can be cut. Lagrange's cells are linear if they have no points but their corners.
constexpr Kind Kinds[] = { { VTK_TETRA, VTK_TETRA, 4 }, { VTK_QUADRATIC_TETRA, VTK_TETRA, 4 },
  { VTK_LAGRANGE_TETRAHEDRON, VTK_TETRA, 4 }, { VTK_VOXEL, VTK_VOXEL, 8 },
  { VTK_HEXAHEDRON, VTK_HEXAHEDRON, 8 }, { VTK_QUADRATIC_HEXAHEDRON, VTK_HEXAHEDRON, 8 },
  { VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON, VTK_HEXAHEDRON, 8 },
  { VTK_TRIQUADRATIC_HEXAHEDRON, VTK_HEXAHEDRON, 8 },
  { VTK_LAGRANGE_HEXAHEDRON, VTK_HEXAHEDRON, 8 }, { VTK_WEDGE, VTK_WEDGE, 6 },
  { VTK_QUADRATIC_WEDGE, VTK_WEDGE, 6 }, { VTK_QUADRATIC_LINEAR_WEDGE, VTK_WEDGE, 6 },
  { VTK_BIQUADRATIC_QUADRATIC_WEDGE, VTK_WEDGE, 6 }, { VTK_LAGRANGE_WEDGE, VTK_WEDGE, 6 },
  { VTK_PYRAMID, VTK_PYRAMID, 5 }, { VTK_QUADRATIC_PYRAMID, VTK_PYRAMID, 5 } };

const Kind* KindOf(int type)
{
  const auto* kind = std::find_if(
    std::begin(Kinds), std::end(Kinds), [type](const Kind& one) { return one.Type == type; });
  return kind == std::end(Kinds) ? nullptr : kind;
}

/// Points in which a quadratic cell of that kind has its highest number of them.
vtkIdType MostPointsOfQuadratic(const Kind& kind)
{
  switch (kind.OfCorners)
  {
    case VTK_TETRA:
      return 15;
    case VTK_WEDGE:
      return 21;
    default:
      return 27;
  }
}

int DimensionOf(int type)
{
  const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
  // A cell of an unknown type may be a part of a body.
  return cell ? cell->GetCellDimension() : (type == VTK_EMPTY_CELL ? 0 : 3);
}

/// The cells of a grid that become tetrahedra.
class Cells
{
public:
  explicit Cells(vtkUnstructuredGrid* grid)
    : Grid(grid)
  {
    std::map<int, int> dimensions;
    for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
    {
      const int type = grid->GetCellType(cell);
      auto known = dimensions.find(type);
      if (known == dimensions.end())
      {
        known = dimensions.emplace(type, DimensionOf(type)).first;
      }
      if (known->second < 3)
      {
        ++Others[type];
      }
      else
      {
        this->Take(cell, type);
      }
    }
    if (Bodies.empty() && !Others.empty())
    {
      throw InputError("The body has no solid cells, but " + this->CountOthers() +
        ". Give a mesh of tetrahedra: Tetrahedralize Surface makes one of a closed surface.");
    }
  }

  bool AreTetrahedra() const { return Others.empty() && !ToBeCut; }

  /// The corners of the tetrahedra of all cells, with the cell of each.
  std::vector<std::pair<vtkIdType, Tetrahedron>> Cut() const
  {
    vtkNew<vtkUnstructuredGrid> corners;
    corners->SetPoints(Grid->GetPoints());
    vtkNew<vtkIdTypeArray> cells;
    cells->SetName(CellOfPart);
    std::vector<std::pair<vtkIdType, Tetrahedron>> all;
    vtkNew<vtkIdList> ids;
    for (const vtkIdType cell : Bodies)
    {
      const Kind& kind = *KindOf(Grid->GetCellType(cell));
      Grid->GetCellPoints(cell, ids);
      if (kind.OfCorners == VTK_TETRA)
      {
        all.push_back({ cell, { ids->GetId(0), ids->GetId(1), ids->GetId(2), ids->GetId(3) } });
      }
      else
      {
        corners->InsertNextCell(kind.OfCorners, kind.Corners, ids->GetPointer(0));
        cells->InsertNextValue(cell);
      }
    }
    corners->GetCellData()->AddArray(cells);
    vtkNew<vtkDataSetTriangleFilter> cut;
    cut->SetInputData(corners);
    cut->TetrahedraOnlyOn();
    cut->Update();
    vtkUnstructuredGrid* parts = cut->GetOutput();
    auto* ofPart = vtkIdTypeArray::SafeDownCast(parts->GetCellData()->GetArray(CellOfPart));
    for (vtkIdType part = 0; part < parts->GetNumberOfCells(); ++part)
    {
      parts->GetCellPoints(part, ids);
      const Tetrahedron tetrahedron = { ids->GetId(0), ids->GetId(1), ids->GetId(2),
        ids->GetId(3) };
      // A hexahedron with a point twice, as meshers write a wedge, has parts without a volume.
      if (std::set<vtkIdType>(tetrahedron.begin(), tetrahedron.end()).size() == 4)
      {
        all.emplace_back(ofPart->GetValue(part), this->Oriented(tetrahedron));
      }
    }
    std::stable_sort(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return all;
  }

  bool AreLinear() const { return Bodies.empty() || Linear == Bodies.front(); }

  /// A text about the cells that are left out, for a warning.
  std::string LeftOut() const
  {
    std::string text =
      Others.empty() ? "" : "Cells that are no solids are left out: " + this->CountOthers() + '.';
    if (HigherOrder > 0)
    {
      text += (text.empty() ? "" : " ") + std::to_string(HigherOrder) +
        " cells of an order above 2 became quadratic tetrahedra: points other than corners and "
        "middles of edges are left out.";
    }
    return text;
  }

private:
  static constexpr vtkIdType None = -1;

  /// "20 vtkTriangle, 2 vtkVertex"
  std::string CountOthers() const
  {
    std::string text;
    for (const auto& [type, count] : Others)
    {
      text +=
        (text.empty() ? "" : ", ") + std::to_string(count) + ' ' + vtkPalpateCellTypeName(type);
    }
    return text;
  }

  void Take(vtkIdType cell, int type)
  {
    const Kind* kind = KindOf(type);
    if (!kind)
    {
      throw InputError("Cell " + std::to_string(cell) + " is a " + vtkPalpateCellTypeName(type) +
        ", which is not cut into tetrahedra here. Apply the filter Tetrahedralize to the body, or "
        "mesh its surface with Tetrahedralize Surface.");
    }
    const vtkIdType points = Grid->GetCellSize(cell);
    const bool isLinear = points == kind->Corners;
    vtkIdType& first = isLinear ? Linear : Quadratic;
    first = first == None ? cell : first;
    if (Linear != None && Quadratic != None)
    {
      const vtkIdType other = isLinear ? Quadratic : Linear;
      throw InputError("Cell " + std::to_string(cell) + " is a " + vtkPalpateCellTypeName(type) +
        " of " + std::to_string(points) + " points, but cell " + std::to_string(other) + " is a " +
        vtkPalpateCellTypeName(Grid->GetCellType(other)) + " of " +
        std::to_string(Grid->GetCellSize(other)) + ": linear and quadratic cells cannot be mixed.");
    }
    ToBeCut = ToBeCut || (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA);
    HigherOrder += points > MostPointsOfQuadratic(*kind) ? 1 : 0;
    Bodies.push_back(cell);
  }

  Tetrahedron Oriented(Tetrahedron t) const
  {
    double x[4][3];
    for (int i = 0; i < 4; ++i)
    {
      Grid->GetPoint(t[i], x[i]);
    }
    for (int i = 1; i < 4; ++i)
    {
      vtkMath::Subtract(x[i], x[0], x[i]);
    }
    if (vtkMath::Determinant3x3(x[1], x[2], x[3]) < 0)
    {
      std::swap(t[0], t[1]);
    }
    return t;
  }

  vtkUnstructuredGrid* Grid;
  std::vector<vtkIdType> Bodies;
  std::map<int, vtkIdType> Others; ///< of each type how many
  vtkIdType Linear = None;         ///< the first one
  vtkIdType Quadratic = None;      ///< the first one that is not linear
  vtkIdType HigherOrder = 0;
  bool ToBeCut = false;
};

/// The nodes in the middle of the edges of tetrahedra.
class Middles
{
public:
  explicit Middles(vtkUnstructuredGrid* grid)
    : Grid(grid)
  {
    Points->SetDataTypeToDouble();
    Points->DeepCopy(grid->GetPoints());
    Data->DeepCopy(grid->GetPointData());
    // A new point has no id that all ranks know.
    Data->SetGlobalIds(nullptr);
  }

  /// @param ends Points of `cell`.
  vtkIdType Between(vtkIdType cell, std::array<vtkIdType, 2> ends)
  {
    std::sort(ends.begin(), ends.end());
    const auto [entry, isNew] = Known.emplace(ends, -1);
    if (isNew)
    {
      entry->second = this->Find(cell, ends);
    }
    return entry->second;
  }

  /// @param output Receives the points and their data.
  void Finish(vtkUnstructuredGrid* output)
  {
    output->SetPoints(Points);
    output->GetPointData()->ShallowCopy(Data);
  }

  std::vector<std::array<vtkIdType, 2>> Added;

private:
  vtkIdType Find(vtkIdType cell, const std::array<vtkIdType, 2>& ends)
  {
    if (cell != Loaded)
    {
      Grid->GetCell(cell, Cell);
      Loaded = cell;
    }
    vtkIdList* ids = Cell->GetPointIds();
    const double* places = Cell->GetParametricCoords();
    const double* a = places + 3 * ids->IsId(ends[0]);
    const double* b = places + 3 * ids->IsId(ends[1]);
    double middle[3] = { 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2]) };
    if (KindOf(Grid->GetCellType(cell))->OfCorners == VTK_PYRAMID && (a[2] == 1 || b[2] == 1))
    {
      // The apex has any of the other two coordinates.
      const double* other = a[2] == 1 ? b : a;
      std::copy(other, other + 2, middle);
    }
    for (vtkIdType node = 0; node < ids->GetNumberOfIds(); ++node)
    {
      constexpr double tolerance = 1e-6;
      if (vtkMath::Distance2BetweenPoints(places + 3 * node, middle) < tolerance * tolerance)
      {
        return ids->GetId(node);
      }
    }
    int part = 0;
    double x[3];
    std::vector<double> weights(static_cast<std::size_t>(ids->GetNumberOfIds()));
    Cell->EvaluateLocation(part, middle, x, weights.data());
    Added.push_back(ends);
    const vtkIdType id = Points->InsertNextPoint(x);
    for (int i = 0; i < Data->GetNumberOfArrays(); ++i)
    {
      this->Interpolate(Data->GetAbstractArray(i), id, ids, weights, ends);
    }
    return id;
  }

  static void Interpolate(vtkAbstractArray* array, vtkIdType id, vtkIdList* ids,
    std::vector<double>& weights, const std::array<vtkIdType, 2>& ends)
  {
    array->InsertTuple(id, ends[0], array);
    auto* numbers = vtkDataArray::SafeDownCast(array);
    if (!numbers)
    {
      return;
    }
    const bool isWhole =
      numbers->GetDataType() != VTK_DOUBLE && numbers->GetDataType() != VTK_FLOAT;
    for (int c = 0; c < numbers->GetNumberOfComponents(); ++c)
    {
      double value = 0;
      for (vtkIdType node = 0; node < ids->GetNumberOfIds(); ++node)
      {
        value +=
          weights[static_cast<std::size_t>(node)] * numbers->GetComponent(ids->GetId(node), c);
      }
      numbers->SetComponent(id, c,
        isWhole ? std::min(numbers->GetComponent(ends[0], c), numbers->GetComponent(ends[1], c))
                : value);
    }
  }

  vtkUnstructuredGrid* Grid;
  vtkNew<vtkPoints> Points;
  vtkNew<vtkPointData> Data;
  vtkNew<vtkGenericCell> Cell;
  vtkIdType Loaded = -1;
  std::map<std::array<vtkIdType, 2>, vtkIdType> Known;
};
}

vtkPalpateBodyCells vtkPalpateToTetrahedra(vtkUnstructuredGrid* grid)
{
  const Cells cells(grid);
  vtkPalpateBodyCells result;
  result.Body = grid;
  result.LeftOut = cells.LeftOut();
  if (cells.AreTetrahedra())
  {
    return result;
  }
  const auto parts = cells.Cut();
  result.Body = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkUnstructuredGrid* body = result.Body;
  body->Allocate(static_cast<vtkIdType>(parts.size()));
  vtkCellData* data = body->GetCellData();
  data->CopyAllOn();
  data->CopyAllocate(grid->GetCellData(), static_cast<vtkIdType>(parts.size()));
  vtkNew<vtkIdList> nodes;
  if (cells.AreLinear())
  {
    body->SetPoints(grid->GetPoints());
    body->GetPointData()->ShallowCopy(grid->GetPointData());
    for (const auto& [cell, corners] : parts)
    {
      data->CopyData(grid->GetCellData(), cell, body->InsertNextCell(VTK_TETRA, 4, corners.data()));
    }
  }
  else
  {
    Middles middles(grid);
    for (const auto& [cell, corners] : parts)
    {
      std::array<vtkIdType, 10> ids{};
      std::copy(corners.begin(), corners.end(), ids.begin());
      for (int edge = 0; edge < 6; ++edge)
      {
        ids[4 + edge] = middles.Between(
          cell, { corners[palpate::kTetEdges[edge][0]], corners[palpate::kTetEdges[edge][1]] });
      }
      data->CopyData(
        grid->GetCellData(), cell, body->InsertNextCell(VTK_QUADRATIC_TETRA, 10, ids.data()));
    }
    middles.Finish(body);
    result.Added = std::move(middles.Added);
  }
  // Several parts of a cell would have the same id.
  data->SetGlobalIds(nullptr);
  body->GetFieldData()->ShallowCopy(grid->GetFieldData());
  return result;
}

std::vector<char> vtkPalpateExtendChoice(const vtkPalpateBodyCells& cells, std::vector<char> chosen)
{
  for (const auto& [a, b] : cells.Added)
  {
    chosen.push_back(
      chosen[static_cast<std::size_t>(a)] != 0 && chosen[static_cast<std::size_t>(b)] != 0 ? 1 : 0);
  }
  return chosen;
}

std::string vtkPalpateCellTypeName(int type)
{
  const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
  return cell ? cell->GetClassName() : "cell of the unknown type " + std::to_string(type);
}
