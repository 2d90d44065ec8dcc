// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateScene.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPalpateArrayCheck.h"
#include "vtkPalpateBodyCells.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpatePointChoice.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::Index;
using palpate::InputError;

/// Three unknowns a point are counted with an Index.
constexpr vtkIdType MostPoints = std::numeric_limits<Index>::max() / 3;

constexpr const char* BodyForceName = "BodyForce";
constexpr const char* RestDisplacementName = "RestDisplacement";

/// Fills `materials`, each once, and `material_of_cell`.
/// @param rheologies Null: they are not read.
void ReadMaterials(
  vtkUnstructuredGrid* grid, palpate::Scene& scene, std::vector<palpate::Rheology>* rheologies)
{
  if (!vtkPalpateScalarArray(grid->GetCellData(), vtkPalpateArray::Law))
  {
    throw InputError("The body has no material: the cell array Law is missing. Apply Assign "
                     "Material to it.");
  }
  vtkPalpateMaterials read = vtkPalpateReadMaterials(
    grid, std::vector<char>(static_cast<std::size_t>(grid->GetNumberOfCells()), 1));
  const auto without = std::find(read.OfCell.begin(), read.OfCell.end(), vtkPalpateMaterials::None);
  if (without != read.OfCell.end())
  {
    throw InputError("Cell " + std::to_string(without - read.OfCell.begin()) +
      " has no material. Apply Assign Material to that part of the body too.");
  }
  if (rheologies)
  {
    *rheologies = vtkPalpateReadRheologies(grid, read);
  }
  scene.materials = std::move(read.Each);
  scene.material_of_cell = std::move(read.OfCell);
}

palpate::Scene ReadScene(vtkUnstructuredGrid* grid, std::vector<palpate::Rheology>* rheologies)
{
  palpate::Scene scene;
  scene.mesh = vtkPalpateMeshFromGrid(grid);
  // Before anything else looks at the geometry.
  palpate::check_and_orient(scene.mesh);
  ReadMaterials(grid, scene, rheologies);
  vtkDataArray* fixed = vtkPalpateScalarArray(grid->GetPointData(), vtkPalpateArray::Fixed);
  if (!fixed)
  {
    throw InputError("No point of the body is fixed: the point array Fixed is missing. Apply Set "
                     "Boundary to it.");
  }
  scene.fixed = vtkPalpateChosenPoints(fixed);
  vtkDataArray* touchable = vtkPalpateScalarArray(grid->GetPointData(), vtkPalpateArray::Touchable);
  scene.touchable = touchable ? vtkPalpateChosenPoints(touchable)
                              : vtkPalpateTouchableSurface(scene.mesh, scene.fixed);
  palpate::check(scene);
  return scene;
}

void AddMaterials(vtkUnstructuredGrid* grid, const palpate::Scene& scene)
{
  vtkPalpateMaterials materials{ scene.materials, scene.material_of_cell };
  if (materials.OfCell.empty())
  {
    materials.Each.resize(1);
    materials.OfCell.assign(static_cast<std::size_t>(scene.mesh.num_cells()), 0);
  }
  vtkPalpateWriteMaterials(materials, grid);
}

vtkSmartPointer<vtkDoubleArray> Numbers(const char* name, int components, vtkIdType tuples)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  return array;
}

void AddBodyForce(vtkUnstructuredGrid* grid, const palpate::Scene& scene)
{
  const auto force = Numbers(BodyForceName, 3, 1);
  force->SetTuple(0, scene.body_force.data());
  grid->GetFieldData()->AddArray(force);
  const auto density =
    Numbers(palpate::rheology_names().front().c_str(), 1, scene.mesh.num_cells());
  for (Index cell = 0; cell < scene.mesh.num_cells(); ++cell)
  {
    const Index material = scene.material_of_cell.empty() ? 0 : scene.material_of_cell[cell];
    density->SetValue(cell, scene.densities[material]);
  }
  grid->GetCellData()->AddArray(density);
  grid->GetPointData()->AddArray(vtkPalpateNodalArray(RestDisplacementName, scene.settled.u));
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
      throw InputError("Cell " + std::to_string(cell) + " is a " + vtkPalpateCellTypeName(type) +
        "; a body has tetrahedra alone (vtkTetra or vtkQuadraticTetra). Apply Assign Material or "
        "Set "
        "Boundary to it, which cut other solids into tetrahedra and leave the rest out.");
    }
    if (type != first)
    {
      throw InputError("Cell " + std::to_string(cell) + " is a " + vtkPalpateCellTypeName(type) +
        ", but cell 0 is a " + vtkPalpateCellTypeName(first) +
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
  return ReadScene(grid, nullptr);
}

palpate::Scene vtkPalpateSceneFromGrid(
  vtkUnstructuredGrid* grid, std::vector<palpate::Rheology>& rheologies)
{
  return ReadScene(grid, &rheologies);
}

palpate::Scene vtkPalpateSceneFromGrid(vtkUnstructuredGrid* grid, const palpate::Vec3& bodyForce)
{
  if (bodyForce.isZero(0))
  {
    return vtkPalpateSceneFromGrid(grid);
  }
  std::vector<palpate::Rheology> rheologies;
  palpate::Scene scene = vtkPalpateSceneFromGrid(grid, rheologies);
  scene = palpate::with_gravity(std::move(scene), rheologies, bodyForce);
  palpate::check(scene);
  return scene;
}

palpate::Scene vtkPalpateSceneOfSpace(vtkUnstructuredGrid* grid)
{
  vtkDataArray* force = grid->GetFieldData()->GetArray(BodyForceName);
  vtkDataArray* displacement = grid->GetPointData()->GetArray(RestDisplacementName);
  if (!force && !displacement)
  {
    return vtkPalpateSceneFromGrid(grid);
  }
  if (!force || force->GetNumberOfValues() != 3 || !displacement ||
    displacement->GetNumberOfComponents() != 3)
  {
    throw InputError(std::string("The body of the state space rests under its weight, but has not "
                                 "both the field array ") +
      BodyForceName + " and the point array " + RestDisplacementName +
      " of three components. Read or compute the space again.");
  }
  palpate::Vec3 acceleration;
  force->GetTuple(0, acceleration.data());
  palpate::Scene scene = vtkPalpateSceneFromGrid(grid, acceleration);
  scene.settled.u.resize(3 * static_cast<Eigen::Index>(scene.mesh.num_points()));
  for (Index point = 0; point < scene.mesh.num_points(); ++point)
  {
    displacement->GetTuple(point, scene.settled.u.data() + 3 * static_cast<Eigen::Index>(point));
  }
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
  if (scene.has_body_force())
  {
    AddBodyForce(grid, scene);
  }
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

void vtkPalpateAddBoundaryKinds(
  vtkUnstructuredGrid* grid, const std::vector<char>& fixed, const std::vector<char>& touchable)
{
  vtkNew<vtkUnsignedCharArray> kinds;
  kinds->SetName(vtkPalpateArray::BoundaryKind);
  kinds->SetNumberOfValues(static_cast<vtkIdType>(fixed.size()));
  std::transform(fixed.begin(), fixed.end(), touchable.begin(), kinds->GetPointer(0),
    [](char isFixed, char isTouchable) {
      return static_cast<unsigned char>(isFixed != 0 ? 2 : isTouchable != 0 ? 1 : 0);
    });
  // Not SetScalars(), which would drop those that are there.
  grid->GetPointData()->AddArray(kinds);
  grid->GetPointData()->SetActiveScalars(kinds->GetName());
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
