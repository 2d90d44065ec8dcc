// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateScene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "base/error.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCellTypes.h"
#include "vtkDoubleArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPalpatePointChoice.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::Index;
using palpate::InputError;
using palpate::Law;

/// Three unknowns a point are counted with an Index.
constexpr vtkIdType MostPoints = std::numeric_limits<Index>::max() / 3;

/// Null unless there is an array of that name with one number for each point or cell.
vtkDataArray* ScalarArray(vtkDataSetAttributes* attributes, const char* name)
{
  vtkDataArray* array = attributes->GetArray(name);
  return array && array->GetNumberOfComponents() == 1 ? array : nullptr;
}

/// The materials of a body, cell by cell.
class MaterialReader
{
public:
  explicit MaterialReader(vtkUnstructuredGrid* grid)
    : CellData(grid->GetCellData())
    , LawArray(ScalarArray(this->CellData, vtkPalpateArray::Law))
    , Isotropic{ this->Find(vtkPalpateArray::YoungsModulus),
      this->Find(vtkPalpateArray::PoissonsRatio) }
    , MooneyRivlin{ this->Find(vtkPalpateArray::C10), this->Find(vtkPalpateArray::C01),
      this->Find(vtkPalpateArray::BulkModulus) }
  {
    if (!this->LawArray)
    {
      throw InputError("The body has no material: the cell array Law is missing. Apply Assign "
                       "Material to it.");
    }
  }

  palpate::Material Read(vtkIdType cell) const
  {
    const Law law = this->LawOf(cell);
    try
    {
      if (law == Law::mooney_rivlin)
      {
        const double c10 = Value(this->MooneyRivlin[0], cell);
        const double c01 = Value(this->MooneyRivlin[1], cell);
        const double bulkModulus = Value(this->MooneyRivlin[2], cell);
        return palpate::make_mooney_rivlin(c10, c01, bulkModulus);
      }
      const double youngsModulus = Value(this->Isotropic[0], cell);
      const double poissonsRatio = Value(this->Isotropic[1], cell);
      return palpate::make_isotropic(law, youngsModulus, poissonsRatio);
    }
    catch (const InputError& error)
    {
      throw InputError("Material of cell " + std::to_string(cell) + ": " + error.what());
    }
  }

private:
  struct Parameter
  {
    const char* Name;
    vtkDataArray* Array;
  };

  Parameter Find(const char* name) const { return { name, ScalarArray(this->CellData, name) }; }

  Law LawOf(vtkIdType cell) const
  {
    const double number = this->LawArray->GetComponent(cell, 0);
    if (number == vtkPalpateNoLaw)
    {
      throw InputError("Cell " + std::to_string(cell) +
        " has no material. Apply Assign Material to that part of the body too.");
    }
    for (int law = 0; law < palpate::num_laws; ++law)
    {
      if (number == law)
      {
        return static_cast<Law>(law);
      }
    }
    throw InputError("Cell " + std::to_string(cell) + " has Law " + std::to_string(number) +
      "; there are the laws 0 to " + std::to_string(palpate::num_laws - 1) +
      ". Apply Assign Material to the body.");
  }

  static double Value(const Parameter& parameter, vtkIdType cell)
  {
    if (!parameter.Array)
    {
      throw InputError(std::string("its law needs the cell array ") + parameter.Name +
        ", which is missing. Apply Assign Material to the body.");
    }
    return parameter.Array->GetComponent(cell, 0);
  }

  vtkDataSetAttributes* CellData;
  vtkDataArray* LawArray;
  std::array<Parameter, 2> Isotropic;
  std::array<Parameter, 3> MooneyRivlin;
};

/// Fills `materials`, each once, and `material_of_cell`.
void ReadMaterials(vtkUnstructuredGrid* grid, palpate::Scene& scene)
{
  const MaterialReader reader(grid);
  std::map<std::pair<Law, std::array<double, 3>>, Index> indices;
  scene.material_of_cell.reserve(static_cast<std::size_t>(grid->GetNumberOfCells()));
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    const palpate::Material material = reader.Read(cell);
    const auto next = static_cast<Index>(scene.materials.size());
    const auto [found, isNew] = indices.try_emplace({ material.law, material.parameters }, next);
    if (isNew)
    {
      scene.materials.push_back(material);
    }
    scene.material_of_cell.push_back(found->second);
  }
}

void AddMaterials(vtkUnstructuredGrid* grid, const palpate::Scene& scene)
{
  const Index numberOfCells = scene.mesh.num_cells();
  vtkNew<vtkIntArray> laws;
  laws->SetName(vtkPalpateArray::Law);
  laws->SetNumberOfValues(numberOfCells);
  grid->GetCellData()->AddArray(laws);
  const auto column = [&](bool needed, const char* name)
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->SetNumberOfValues(numberOfCells);
    array->FillValue(0);
    if (needed)
    {
      grid->GetCellData()->AddArray(array);
    }
    return vtkSmartPointer<vtkDoubleArray>(array);
  };
  const auto isMooneyRivlin = [](const palpate::Material& material)
  { return material.law == Law::mooney_rivlin; };
  const bool some = std::any_of(scene.materials.begin(), scene.materials.end(), isMooneyRivlin);
  const bool all = std::all_of(scene.materials.begin(), scene.materials.end(), isMooneyRivlin);
  const auto youngsModulus = column(!all, vtkPalpateArray::YoungsModulus);
  const auto poissonsRatio = column(!all, vtkPalpateArray::PoissonsRatio);
  const std::array<vtkSmartPointer<vtkDoubleArray>, 3> mooneyRivlin = { column(some,
                                                                          vtkPalpateArray::C10),
    column(some, vtkPalpateArray::C01), column(some, vtkPalpateArray::BulkModulus) };
  for (Index cell = 0; cell < numberOfCells; ++cell)
  {
    const palpate::Material& material =
      scene.materials[scene.material_of_cell.empty() ? 0 : scene.material_of_cell[cell]];
    laws->SetValue(cell, static_cast<int>(material.law));
    if (isMooneyRivlin(material))
    {
      for (std::size_t i = 0; i < mooneyRivlin.size(); ++i)
      {
        mooneyRivlin[i]->SetValue(cell, material.parameters[i]);
      }
    }
    else
    {
      youngsModulus->SetValue(cell, material.parameters[0]);
      poissonsRatio->SetValue(cell, material.parameters[1]);
    }
  }
}
}

palpate::ElementOrder vtkPalpateElementOrder(vtkUnstructuredGrid* grid)
{
  if (grid->GetNumberOfCells() == 0)
  {
    throw InputError("The body has no cells. Give a mesh of tetrahedra: Tetrahedralize Surface "
                     "makes one of a closed surface.");
  }
  const int first = grid->GetCellType(0);
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    const int type = grid->GetCellType(cell);
    if (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA)
    {
      throw InputError("Cell " + std::to_string(cell) + " is a " +
        vtkCellTypes::GetClassNameFromTypeId(type) +
        "; a body has tetrahedra alone (vtkTetra or vtkQuadraticTetra). Remove other cells or mesh "
        "the surface with Tetrahedralize Surface.");
    }
    if (type != first)
    {
      throw InputError("Cell " + std::to_string(cell) + " is a " +
        vtkCellTypes::GetClassNameFromTypeId(type) + ", but cell 0 is a " +
        vtkCellTypes::GetClassNameFromTypeId(first) +
        ": linear and quadratic tetrahedra cannot be mixed.");
    }
  }
  return first == VTK_TETRA ? palpate::ElementOrder::linear : palpate::ElementOrder::quadratic;
}

palpate::TetMesh vtkPalpateMeshFromGrid(vtkUnstructuredGrid* grid)
{
  palpate::TetMesh mesh;
  mesh.order = vtkPalpateElementOrder(grid);
  if (grid->GetNumberOfPoints() > MostPoints)
  {
    throw InputError("The body has " + std::to_string(grid->GetNumberOfPoints()) +
      " points; at most " + std::to_string(MostPoints) + " can be counted. Use a coarser mesh.");
  }
  mesh.points.resize(static_cast<std::size_t>(grid->GetNumberOfPoints()));
  for (vtkIdType point = 0; point < grid->GetNumberOfPoints(); ++point)
  {
    grid->GetPoint(point, mesh.points[point].data());
  }
  mesh.cells.reserve(
    static_cast<std::size_t>(grid->GetNumberOfCells()) * palpate::nodes_per_cell(mesh.order));
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    vtkIdType numberOfNodes = 0;
    const vtkIdType* nodes = nullptr;
    grid->GetCellPoints(cell, numberOfNodes, nodes);
    for (vtkIdType i = 0; i < numberOfNodes; ++i)
    {
      mesh.cells.push_back(static_cast<Index>(nodes[i]));
    }
  }
  return mesh;
}

std::vector<char> vtkPalpateTouchableSurface(
  const palpate::TetMesh& mesh, const std::vector<char>& fixed)
{
  std::vector<char> touchable(mesh.points.size(), 0);
  for (const auto& triangle : palpate::boundary_triangles(mesh))
  {
    for (const Index corner : triangle)
    {
      touchable[corner] = fixed[corner] == 0;
    }
  }
  return touchable;
}

palpate::Scene vtkPalpateSceneFromGrid(vtkUnstructuredGrid* grid)
{
  palpate::Scene scene;
  scene.mesh = vtkPalpateMeshFromGrid(grid);
  // Before anything else looks at the geometry.
  palpate::check_and_orient(scene.mesh);
  ReadMaterials(grid, scene);
  vtkDataArray* fixed = ScalarArray(grid->GetPointData(), vtkPalpateArray::Fixed);
  if (!fixed)
  {
    throw InputError("No point of the body is fixed: the point array Fixed is missing. Apply Set "
                     "Boundary to it.");
  }
  scene.fixed = vtkPalpateChosenPoints(fixed);
  vtkDataArray* touchable = ScalarArray(grid->GetPointData(), vtkPalpateArray::Touchable);
  scene.touchable =
    touchable ? vtkPalpateChosenPoints(touchable) : vtkPalpateTouchableSurface(scene.mesh, scene.fixed);
  palpate::check(scene);
  return scene;
}

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGridFromScene(const palpate::Scene& scene)
{
  const palpate::TetMesh& mesh = scene.mesh;
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(mesh.num_points());
  for (Index point = 0; point < mesh.num_points(); ++point)
  {
    points->SetPoint(point, mesh.points[point].data());
  }
  grid->SetPoints(points);

  const int nodesPerCell = palpate::nodes_per_cell(mesh.order);
  vtkNew<vtkCellArray> cells;
  cells->AllocateExact(mesh.num_cells(), static_cast<vtkIdType>(mesh.cells.size()));
  for (Index cell = 0; cell < mesh.num_cells(); ++cell)
  {
    std::array<vtkIdType, 10> nodes{};
    std::copy_n(mesh.cell(cell), nodesPerCell, nodes.begin());
    cells->InsertNextCell(nodesPerCell, nodes.data());
  }
  grid->SetCells(
    mesh.order == palpate::ElementOrder::linear ? VTK_TETRA : VTK_QUADRATIC_TETRA, cells);

  AddMaterials(grid, scene);
  vtkPalpateAddChoice(grid, vtkPalpateArray::Fixed, scene.fixed);
  vtkPalpateAddChoice(grid, vtkPalpateArray::Touchable, scene.touchable);
  return grid;
}

void vtkPalpateAddChoice(
  vtkUnstructuredGrid* grid, const char* name, const std::vector<char>& chosen)
{
  vtkNew<vtkUnsignedCharArray> array;
  array->SetName(name);
  array->SetNumberOfValues(static_cast<vtkIdType>(chosen.size()));
  std::copy(chosen.begin(), chosen.end(), array->GetPointer(0));
  grid->GetPointData()->AddArray(array);
}

vtkSmartPointer<vtkDoubleArray> vtkPalpateNodalArray(
  const char* name, const palpate::NodalVector& values)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(values.size() / 3);
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}
