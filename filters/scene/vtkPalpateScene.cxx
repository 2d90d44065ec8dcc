// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateScene.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "assembly/loaded_faces.h"
#include "base/error.h"
#include "soft_contact/contact_defaults.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPalpateArrayCheck.h"
#include "vtkPalpateBodyCells.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpateMeshGrid.h"
#include "vtkPalpatePointChoice.h"
#include "vtkPointData.h"
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
  scene.organ.materials = std::move(read.Each);
  scene.body.material_of_cell = std::move(read.OfCell);
}

palpate::Scene ReadScene(vtkUnstructuredGrid* grid, std::vector<palpate::Rheology>* rheologies)
{
  palpate::Scene scene;
  scene.body.mesh = vtkPalpateMeshFromGrid(grid);
  // Check this before anything else uses the geometry.
  palpate::check_and_orient(scene.body.mesh);
  ReadMaterials(grid, scene, rheologies);
  vtkPalpateReadBoundary(grid, scene);
  vtkDataArray* fixed = vtkPalpateScalarArray(grid->GetPointData(), vtkPalpateArray::Fixed);
  if (!fixed && !scene.body.has_supports())
  {
    throw InputError("No point of the body is fixed: the point array Fixed is missing. Apply Set "
                     "Boundary to it.");
  }
  scene.body.fixed =
    fixed ? vtkPalpateChosenPoints(fixed) : std::vector<char>(scene.body.mesh.points.size(), 0);
  vtkDataArray* touchable = vtkPalpateScalarArray(grid->GetPointData(), vtkPalpateArray::Touchable);
  scene.body.touchable = touchable
    ? vtkPalpateChosenPoints(touchable)
    : vtkPalpateTouchableSurface(scene.body.mesh, vtkPalpateHeldPoints(scene));
  scene = palpate::with_contact_defaults(std::move(scene));
  palpate::check(scene);
  return scene;
}

void AddMaterials(vtkUnstructuredGrid* grid, const palpate::Scene& scene)
{
  vtkPalpateMaterials materials{ scene.organ.materials, scene.body.material_of_cell };
  if (materials.OfCell.empty())
  {
    materials.Each.resize(1);
    materials.OfCell.assign(static_cast<std::size_t>(scene.body.mesh.num_cells()), 0);
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
  force->SetTuple(0, scene.organ.body_force.data());
  grid->GetFieldData()->AddArray(force);
  const auto density =
    Numbers(palpate::rheology_names().front().c_str(), 1, scene.body.mesh.num_cells());
  for (Index cell = 0; cell < scene.body.mesh.num_cells(); ++cell)
  {
    const Index material = scene.body.material_of(cell);
    density->SetValue(cell, scene.organ.densities[material]);
  }
  grid->GetCellData()->AddArray(density);
}

/// The array of a boundary; null: there is none.
/// @throws palpate::InputError it is an array of cells, or has another number of components.
vtkDataArray* BoundaryArray(vtkUnstructuredGrid* grid, const char* name, int components)
{
  vtkDataArray* array = grid->GetPointData()->GetArray(name);
  if (!array && grid->GetCellData()->GetArray(name))
  {
    throw InputError(std::string("The array ") + name +
      " is of cells, but has to be of points: a face of the surface has what its three corners "
      "have. Give each point a value, as with Cell Data to Point Data, or use Set Boundary.");
  }
  if (array && array->GetNumberOfComponents() != components)
  {
    throw InputError(std::string("The point array ") + name + " has " +
      std::to_string(array->GetNumberOfComponents()) + " components; it must have " +
      std::to_string(components) + '.');
  }
  return array;
}

/// Calls take(point, tuple) for each point; does nothing where there is no such array.
template <int Components, class Take>
void ReadTuples(vtkUnstructuredGrid* grid, const char* name, Take take)
{
  vtkDataArray* array = BoundaryArray(grid, name, Components);
  for (vtkIdType point = 0; array && point < array->GetNumberOfTuples(); ++point)
  {
    Eigen::Matrix<double, Components, 1> tuple;
    array->GetTuple(point, tuple.data());
    take(static_cast<std::size_t>(point), tuple);
  }
}

void ReadContact(vtkUnstructuredGrid* grid, palpate::Scene& scene)
{
  vtkDataArray* law = grid->GetFieldData()->GetArray(vtkPalpateArray::PartContact);
  if (!law)
  {
    return;
  }
  const double touching = law->GetNumberOfValues() == 3 ? law->GetComponent(0, 0) : 0;
  if (law->GetNumberOfComponents() != 3 || (touching != 1 && touching != 2 && touching != 3))
  {
    throw InputError(std::string("The field array ") + vtkPalpateArray::PartContact +
      " is not what Set Boundary writes: 1, 2 or 3, a thickness (m) and a stiffness (Pa). Set "
      "Contact "
      "again.");
  }
  scene.organ.touching = static_cast<palpate::TouchingParts>(static_cast<int>(touching));
  scene.organ.contact.thickness = law->GetComponent(0, 1);
  scene.organ.contact.stiffness = law->GetComponent(0, 2);
  vtkDataArray* parts = vtkPalpateScalarArray(grid->GetCellData(), vtkPalpateArray::ContactPart);
  for (vtkIdType cell = 0; parts && cell < parts->GetNumberOfTuples(); ++cell)
  {
    scene.body.part_of_cell.push_back(static_cast<Index>(parts->GetComponent(cell, 0)));
  }
}

/// @throws palpate::InputError there is none, or not of this size.
vtkDataArray* ArrayOfCut(vtkUnstructuredGrid* grid, const char* name, vtkIdType least)
{
  vtkDataArray* array = grid->GetFieldData()->GetArray(name);
  if (!array || array->GetNumberOfValues() < least || array->GetNumberOfComponents() != 1)
  {
    throw InputError(std::string("The body has a cut (cell array ") + vtkPalpateArray::CutStage +
      "), but no field array " + name +
      ", as Place Cut writes it. Apply Place Cut again, or take " + vtkPalpateArray::CutStage +
      " away.");
  }
  return array;
}

void ReadCut(vtkUnstructuredGrid* grid, palpate::Scene& scene)
{
  vtkDataArray* stages = grid->GetCellData()->GetArray(vtkPalpateArray::CutStage);
  if (!stages)
  {
    return;
  }
  if (stages->GetNumberOfComponents() != 4)
  {
    throw InputError(std::string("The cell array ") + vtkPalpateArray::CutStage + " has " +
      std::to_string(stages->GetNumberOfComponents()) +
      " components; it must have 4, one for each face of the cell.");
  }
  palpate::Cut& cut = scene.body.cut;
  cut.stage =
    static_cast<std::int32_t>(ArrayOfCut(grid, vtkPalpateArray::Stage, 1)->GetComponent(0, 0));
  vtkDataArray* areas = ArrayOfCut(grid, vtkPalpateArray::StageArea, 2);
  for (vtkIdType of = 0; of < areas->GetNumberOfTuples(); ++of)
  {
    cut.areas.push_back(areas->GetComponent(of, 0));
  }
  cut.faces.resize(static_cast<std::size_t>(stages->GetNumberOfTuples()));
  for (std::size_t cell = 0; cell < cut.faces.size(); ++cell)
  {
    for (int face = 0; face < 4; ++face)
    {
      cut.faces[cell][face] =
        static_cast<std::int32_t>(stages->GetComponent(static_cast<vtkIdType>(cell), face));
    }
  }
  if (scene.organ.touching == palpate::TouchingParts::none)
  {
    scene.organ.touching = palpate::TouchingParts::lips;
  }
}

void WriteContact(const palpate::Scene& scene, vtkUnstructuredGrid* grid)
{
  if (scene.organ.touching == palpate::TouchingParts::none)
  {
    return;
  }
  const auto law = Numbers(vtkPalpateArray::PartContact, 3, 1);
  law->SetTuple3(0, static_cast<double>(scene.organ.touching), scene.organ.contact.thickness,
    scene.organ.contact.stiffness);
  grid->GetFieldData()->AddArray(law);
  if (scene.body.part_of_cell.empty())
  {
    return;
  }
  vtkNew<vtkIntArray> parts;
  parts->SetName(vtkPalpateArray::ContactPart);
  parts->SetNumberOfTuples(scene.body.mesh.num_cells());
  for (Index cell = 0; cell < scene.body.mesh.num_cells(); ++cell)
  {
    parts->SetValue(cell, scene.body.part_of_cell[cell]);
  }
  grid->GetCellData()->AddArray(parts);
}

/// Writes the array of numbersOf(value), which is the address of one number for each component;
/// nothing if there are no values.
template <class Value, class NumbersOf>
void WriteTuples(const char* name, int components, const std::vector<Value>& values,
  const NumbersOf& numbersOf, vtkUnstructuredGrid* grid)
{
  if (values.empty())
  {
    return;
  }
  const auto array = Numbers(name, components, static_cast<vtkIdType>(values.size()));
  for (std::size_t point = 0; point < values.size(); ++point)
  {
    array->SetTuple(static_cast<vtkIdType>(point), numbersOf(values[point]));
  }
  grid->GetPointData()->AddArray(array);
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

palpate::Scene vtkPalpateSceneOfSpace(vtkUnstructuredGrid* grid, palpate::SettledBody& atRest)
{
  atRest = {};
  vtkDataArray* force = grid->GetFieldData()->GetArray(BodyForceName);
  vtkDataArray* displacement = grid->GetPointData()->GetArray(vtkPalpateArray::RestDisplacement);
  palpate::Vec3 acceleration = palpate::Vec3::Zero();
  const bool isForce = force && force->GetNumberOfValues() == 3;
  if (isForce)
  {
    force->GetTuple(0, acceleration.data());
  }
  palpate::Scene scene = vtkPalpateSceneFromGrid(grid, acceleration);
  if (!force && !displacement && !scene.has_load())
  {
    return scene;
  }
  if ((force && !isForce) || !scene.has_load() || !displacement ||
    displacement->GetNumberOfComponents() != 3)
  {
    throw InputError(std::string("The body of the state space rests under a load, but has not both "
                                 "that (as its weight, the field array ") +
      BodyForceName + ") and the point array " + vtkPalpateArray::RestDisplacement +
      " of three components. Read or compute the space again.");
  }
  atRest.u.resize(3 * static_cast<Eigen::Index>(scene.body.mesh.num_points()));
  for (Index point = 0; point < scene.body.mesh.num_points(); ++point)
  {
    displacement->GetTuple(point, atRest.u.data() + 3 * static_cast<Eigen::Index>(point));
  }
  return scene;
}

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateGridFromScene(
  const palpate::Scene& scene, const palpate::SettledBody& atRest)
{
  auto grid = vtkPalpateGridFromMesh(scene.body.mesh);
  AddMaterials(grid, scene);
  vtkPalpateAddChoice(grid, vtkPalpateArray::Fixed, scene.body.fixed);
  vtkPalpateAddChoice(grid, vtkPalpateArray::Touchable, scene.body.touchable);
  vtkPalpateWriteBoundary(scene, grid);
  if (scene.organ.has_body_force())
  {
    AddBodyForce(grid, scene);
  }
  if (atRest.u.size() > 0)
  {
    grid->GetPointData()->AddArray(
      vtkPalpateNodalArray(vtkPalpateArray::RestDisplacement, atRest.u));
  }
  return grid;
}

void vtkPalpateReadBoundary(vtkUnstructuredGrid* grid, palpate::Scene& scene)
{
  const auto size = static_cast<std::size_t>(grid->GetNumberOfPoints());
  for (const auto& [name, column] : { std::pair{ vtkPalpateArray::HeldDirection, 0 },
         std::pair{ vtkPalpateArray::HeldDirection2, 1 } })
  {
    const int of = column;
    ReadTuples<3>(grid, name,
      [&](std::size_t point, const palpate::Vec3& direction)
      {
        scene.body.held_directions.resize(size, palpate::HeldDirections::Zero());
        scene.body.held_directions[point].col(of) = direction;
      });
  }
  for (const auto& [name, array] :
    { std::pair{ vtkPalpateArray::SupportStiffness, &scene.body.support_stiffness },
      std::pair{ vtkPalpateArray::AppliedPressure, &scene.body.applied_pressure } })
  {
    std::vector<double>& values = *array;
    ReadTuples<1>(grid, name,
      [&](std::size_t point, const auto& value)
      {
        values.resize(size, 0);
        values[point] = value[0];
      });
  }
  ReadTuples<3>(grid, vtkPalpateArray::AppliedTraction,
    [&](std::size_t point, const palpate::Vec3& traction)
    {
      scene.body.applied_traction.resize(size, palpate::Vec3::Zero());
      scene.body.applied_traction[point] = traction;
    });
  ReadContact(grid, scene);
  ReadCut(grid, scene);
}

void vtkPalpateWriteCut(const palpate::Cut& cut, vtkUnstructuredGrid* grid)
{
  if (cut.faces.empty())
  {
    return;
  }
  vtkNew<vtkIntArray> stages;
  stages->SetName(vtkPalpateArray::CutStage);
  stages->SetNumberOfComponents(4);
  for (const palpate::OpenedFaces& of_cell : cut.faces)
  {
    stages->InsertNextTypedTuple(of_cell.data());
  }
  grid->GetCellData()->AddArray(stages);
  vtkNew<vtkIntArray> stage;
  stage->SetName(vtkPalpateArray::Stage);
  stage->InsertNextValue(cut.stage);
  grid->GetFieldData()->AddArray(stage);
  const auto areas =
    Numbers(vtkPalpateArray::StageArea, 1, static_cast<vtkIdType>(cut.areas.size()));
  std::copy(cut.areas.begin(), cut.areas.end(), areas->GetPointer(0));
  grid->GetFieldData()->AddArray(areas);
}

void vtkPalpateWriteBoundary(const palpate::Scene& scene, vtkUnstructuredGrid* grid)
{
  const auto column = [](int number)
  { return [number](const palpate::HeldDirections& held) { return held.col(number).data(); }; };
  const auto number = [](const double& value) { return &value; };
  WriteTuples(vtkPalpateArray::HeldDirection, 3, scene.body.held_directions, column(0), grid);
  WriteTuples(vtkPalpateArray::HeldDirection2, 3, scene.body.held_directions, column(1), grid);
  WriteTuples(vtkPalpateArray::SupportStiffness, 1, scene.body.support_stiffness, number, grid);
  WriteTuples(vtkPalpateArray::AppliedPressure, 1, scene.body.applied_pressure, number, grid);
  WriteTuples(
    vtkPalpateArray::AppliedTraction, 3, scene.body.applied_traction,
    [](const palpate::Vec3& traction) { return traction.data(); }, grid);
  WriteContact(scene, grid);
  vtkPalpateWriteCut(scene.body.cut, grid);
}

void vtkPalpateWriteBoundaryAnew(const palpate::Scene& scene, vtkUnstructuredGrid* grid)
{
  vtkPalpateAddChoice(grid, vtkPalpateArray::Fixed, scene.body.fixed);
  vtkPalpateAddChoice(grid, vtkPalpateArray::Touchable, scene.body.touchable);
  vtkPalpateWriteBoundary(scene, grid);
  if (grid->GetPointData()->HasArray(vtkPalpateArray::BoundaryKind))
  {
    vtkPalpateAddBoundaryKinds(scene, grid);
  }
}

std::vector<char> vtkPalpateHeldPoints(const palpate::Scene& scene)
{
  std::vector<char> held = scene.body.fixed;
  for (std::size_t point = 0; point < scene.body.held_directions.size(); ++point)
  {
    held[point] = held[point] != 0 || !scene.body.held_directions[point].isZero(0);
  }
  return held;
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

void vtkPalpateAddBoundaryKinds(const palpate::Scene& scene, vtkUnstructuredGrid* grid)
{
  enum Kind : unsigned char
  {
    FREE = 0,
    TOUCHABLE = 1,
    FIXED = 2,
    HELD = 3,
    LOADED = 4
  };
  vtkNew<vtkUnsignedCharArray> kinds;
  kinds->SetName(vtkPalpateArray::BoundaryKind);
  kinds->SetNumberOfValues(static_cast<vtkIdType>(scene.body.fixed.size()));
  kinds->FillValue(FREE);
  const auto markWhere = [&](Kind kind, const std::vector<char>& chosen)
  {
    for (std::size_t point = 0; point < chosen.size(); ++point)
    {
      if (chosen[point] != 0)
      {
        kinds->SetValue(static_cast<vtkIdType>(point), kind);
      }
    }
  };
  const auto markFaces = [&](Kind kind, const std::vector<Index>& faces)
  {
    for (const Index point : faces)
    {
      kinds->SetValue(point, kind);
    }
  };
  // If a point has several kinds, the last one that is written counts.
  markWhere(TOUCHABLE, scene.body.touchable);
  markFaces(LOADED, palpate::faces_under_pressure(scene.body.mesh, scene.body.applied_pressure));
  markFaces(LOADED, palpate::faces_with(scene.body.mesh, scene.body.applied_traction));
  markFaces(HELD, palpate::faces_with(scene.body.mesh, scene.body.support_stiffness));
  for (std::size_t point = 0; point < scene.body.held_directions.size(); ++point)
  {
    if (!scene.body.held_directions[point].isZero(0))
    {
      kinds->SetValue(static_cast<vtkIdType>(point), HELD);
    }
  }
  markWhere(FIXED, scene.body.fixed);
  // SetScalars() is not used, since it would drop the active scalars.
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
