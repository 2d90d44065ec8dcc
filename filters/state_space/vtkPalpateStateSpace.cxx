// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateStateSpace.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/memory_error.h"
#include "storage/schema.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPalpatePieces.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::CheckPoint;
using palpate::ConfigurationSummary;
using palpate::Index;
using palpate::InputError;
using palpate::IntermediateState;
using palpate::TouchSpace;
using palpate::TouchToolSpace;

constexpr const char* BlockNames[] = { "Body", "Surface", "Configurations", "IntermediateStates" };
constexpr const char* ThirdDerivative = "ThirdDerivative";
constexpr const char* FileName = "FileName";
constexpr const char* LevelsReached = "LevelsReached";

/// Makes an array of doubles, ints, … and adds it to point or field data.
template <class Array>
Array* AddArray(vtkFieldData* data, const char* name, int components, vtkIdType tuples)
{
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  data->AddArray(array);
  return array;
}

void AddNumber(vtkFieldData* data, const char* name, double value)
{
  AddArray<vtkDoubleArray>(data, name, 1, 1)->SetValue(0, value);
}

/// The array of the modes of an active node: one has no other beside it.
std::string ModesName(bool isOnly, Index node)
{
  return isOnly ? "Modes" : "Modes " + std::to_string(node);
}

bool HasOneNode(const TouchSpace& space)
{
  return std::count_if(space.tool_spaces.begin(), space.tool_spaces.end(),
           [](const TouchToolSpace& toolSpace) { return !toolSpace.setup.presses(); }) == 1;
}

void AddModes(const TouchSpace& space, const TouchToolSpace& toolSpace, vtkPointData* arrays)
{
  const Eigen::MatrixXf& modes = toolSpace.modes;
  // VTK has no arrays without components.
  if (modes.cols() == 0)
  {
    return;
  }
  const std::string name = ModesName(HasOneNode(space), toolSpace.setup.interaction.active_node);
  auto* array = AddArray<vtkFloatArray>(
    arrays, name.c_str(), static_cast<int>(3 * modes.cols()), space.surface.num_points());
  for (Index p = 0; p < space.surface.num_points(); ++p)
  {
    for (int m = 0; m < modes.cols(); ++m)
    {
      for (int c = 0; c < 3; ++c)
      {
        array->SetTypedComponent(p, 3 * m + c, modes(3 * p + c, m));
      }
    }
  }
}

/// @param space Loses its modes.
vtkSmartPointer<vtkPolyData> SurfaceData(TouchSpace& space)
{
  const palpate::Surface& surface = space.surface;
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(surface.num_points());
  auto* meshPoints =
    AddArray<vtkIdTypeArray>(data->GetPointData(), "MeshPoint", 1, surface.num_points());
  for (Index p = 0; p < surface.num_points(); ++p)
  {
    points->SetPoint(p, surface.points[p].data());
    meshPoints->SetValue(p, surface.mesh_points[p]);
  }
  for (TouchToolSpace& toolSpace : space.tool_spaces)
  {
    AddModes(space, toolSpace, data->GetPointData());
    toolSpace.modes = {};
  }
  vtkNew<vtkCellArray> triangles;
  for (const auto& [a, b, c] : surface.triangles)
  {
    triangles->InsertNextCell({ a, b, c });
  }
  data->SetPoints(points);
  data->SetPolys(triangles);
  return data;
}

/// Calls visit(name, components, get) for every figure of a configuration that is a double;
/// get(configuration) gives the first of them.
template <class Visit>
void ForEachDoubleArray(Visit&& visit)
{
  visit("Displacement", 3, [](auto& c) { return c.t.data(); });
  visit("Force", 3, [](auto& c) { return c.force.data(); });
  visit("Energy", 1, [](auto& c) { return &c.energy; });
  visit("Stiffness", 9, [](auto& c) { return c.stiffness.data(); }); // symmetric
  visit("Residual", 1, [](auto& c) { return &c.residual; });
  visit("MinimumDetF", 1, [](auto& c) { return &c.minimum_det_f; });
  visit("Seconds", 1, [](auto& c) { return &c.seconds; });
}

/// The same for the figures that are integers.
template <class Visit>
void ForEachIntArray(Visit&& visit)
{
  static_assert(sizeof(palpate::Outcome) == sizeof(int));
  visit("CheckPoint", 3, [](auto& c) { return c.check_point.data(); });
  visit("ParentCheckPoint", 3, [](auto& c) { return c.parent.data(); });
  visit("Level", 1, [](auto& c) { return &c.level; });
  visit("ParentLevel", 1, [](auto& c) { return &c.parent_level; });
  visit("Flags", 1, [](auto& c) { return &c.flags; });
  visit("NegativePivots", 1, [](auto& c) { return &c.negative_pivots; });
  visit("Iterations", 1, [](auto& c) { return &c.iterations; });
}

/// The same for the figures of an intermediate state that are doubles.
template <class Visit>
void ForEachDoubleArrayOfStates(Visit&& visit)
{
  visit("Displacement", 3, [](auto& s) { return s.t.data(); });
  visit("Force", 3, [](auto& s) { return s.force.data(); });
  visit("Energy", 1, [](auto& s) { return &s.energy; });
  visit("Seconds", 1, [](auto& s) { return &s.seconds; });
}

/// The same for those that are integers.
template <class Visit>
void ForEachIntArrayOfStates(Visit&& visit)
{
  visit("TargetCheckPoint", 3, [](auto& s) { return s.target.data(); });
  visit("Number", 1, [](auto& s) { return &s.number; });
  visit("Flags", 1, [](auto& s) { return &s.flags; });
}

/// What makes an array of a figure of each of the items; ForEachDoubleArray or the like visits it.
template <class Array, class Item>
auto ArrayMaker(vtkPointData* arrays, const std::vector<const Item*>& all)
{
  return [arrays, &all](const char* name, int components, auto get)
  {
    const auto count = static_cast<vtkIdType>(all.size());
    auto* array = AddArray<Array>(arrays, name, components, count);
    for (vtkIdType i = 0; i < count; ++i)
    {
      array->SetTypedTuple(i, get(*all[i]));
    }
  };
}

template <class Item>
void AddOutcomes(vtkPointData* arrays, const std::vector<const Item*>& all)
{
  const auto count = static_cast<vtkIdType>(all.size());
  auto* outcomes = AddArray<vtkIntArray>(arrays, "Outcome", 1, count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    outcomes->SetValue(i, static_cast<int>(all[i]->outcome));
  }
}

/// The worst that is to be said of a configuration; names in plugin/Palpate/PalpateLooks.cxx.
unsigned char SolveStatus(const ConfigurationSummary& c)
{
  if (c.outcome != palpate::Outcome::converged)
  {
    return 5;
  }
  const auto has = [&](palpate::Flags flag) { return (c.flags & flag) != 0; };
  return has(palpate::flags::inverted)        ? 4
    : has(palpate::flags::unstable)           ? 3
    : has(palpate::flags::beyond_force_limit) ? 2
    : has(palpate::flags::near_fold)          ? 1
                                              : 0;
}

vtkSmartPointer<vtkPolyData> ConfigurationData(const TouchSpace& space)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  std::vector<const ConfigurationSummary*> all;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices;
  vtkNew<vtkCellArray> transitions;
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    std::map<std::pair<CheckPoint, int>, vtkIdType> idOf;
    for (const ConfigurationSummary& c : toolSpace.configurations)
    {
      const palpate::Vec3 place = toolSpace.setup.interaction.material_point + c.t;
      const vtkIdType id = points->InsertNextPoint(place.data());
      vertices->InsertNextCell({ id });
      idOf.emplace(std::pair(c.check_point, c.level), id);
      all.push_back(&c);
    }
    for (const ConfigurationSummary& c : toolSpace.configurations)
    {
      const vtkIdType id = idOf.at({ c.check_point, c.level });
      const auto parent = idOf.find({ c.parent, c.parent_level });
      if (parent != idOf.end() && c.parent != c.check_point)
      {
        transitions->InsertNextCell({ parent->second, id });
      }
      for (int n = 0; n < palpate::num_neighbours; ++n)
      {
        const auto target = idOf.find({ palpate::neighbour(c.check_point, n), c.reached[n] });
        if (target != idOf.end())
        {
          transitions->InsertNextCell({ id, target->second });
        }
      }
    }
  }
  data->SetPoints(points);
  data->SetVerts(vertices);
  data->SetLines(transitions);

  vtkPointData* arrays = data->GetPointData();
  const auto count = static_cast<vtkIdType>(all.size());
  ForEachDoubleArray(ArrayMaker<vtkDoubleArray>(arrays, all));
  ForEachIntArray(ArrayMaker<vtkIntArray>(arrays, all));
  AddOutcomes(arrays, all);
  auto* statuses = AddArray<vtkUnsignedCharArray>(arrays, "SolveStatus", 1, count);
  std::transform(all.begin(), all.end(), statuses->GetPointer(0),
    [](const ConfigurationSummary* c) { return SolveStatus(*c); });
  if (std::any_of(all.begin(), all.end(), [](auto* c) { return c->has_third_derivative(); }))
  {
    ArrayMaker<vtkDoubleArray>(arrays, all)(
      ThirdDerivative, 10, [](auto& c) { return c.third_derivative.data(); });
  }
  if (std::any_of(all.begin(), all.end(), [](auto* c) { return c->has_history(); }))
  {
    auto* reached = AddArray<vtkIntArray>(arrays, LevelsReached, palpate::num_neighbours, count);
    for (vtkIdType i = 0; i < count; ++i)
    {
      reached->SetTypedTuple(i, all[i]->reached.data());
    }
  }
  Eigen::Index most = 0;
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    most = std::max(most, toolSpace.modes.cols());
  }
  const int modes = static_cast<int>(most);
  auto* nodes = AddArray<vtkIdTypeArray>(arrays, "ActiveNode", 1, count);
  vtkFloatArray* coefficients = nullptr;
  vtkFloatArray* gradients = nullptr;
  if (modes > 0)
  {
    coefficients = AddArray<vtkFloatArray>(arrays, "Coefficients", modes, count);
    gradients = AddArray<vtkFloatArray>(arrays, "CoefficientGradient", 3 * modes, count);
    // Those that an active node does not have; a rigid tool has none.
    coefficients->Fill(0);
    gradients->Fill(0);
  }
  vtkIdType next = 0;
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    for (Eigen::Index i = 0; i < toolSpace.coefficients.cols(); ++i, ++next)
    {
      nodes->SetValue(next, toolSpace.setup.interaction.active_node);
      const Eigen::Index own = toolSpace.modes.cols();
      for (Eigen::Index m = 0; m < own; ++m)
      {
        coefficients->SetTypedComponent(next, static_cast<int>(m), toolSpace.coefficients(m, i));
        for (int a = 0; a < 3; ++a)
        {
          gradients->SetTypedComponent(
            next, static_cast<int>(a * most + m), toolSpace.coefficient_gradients(a * own + m, i));
        }
      }
    }
  }
  arrays->SetActiveScalars("Force");
  return data;
}

vtkSmartPointer<vtkPolyData> IntermediateStateData(const TouchSpace& space)
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  std::vector<const IntermediateState*> all;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices;
  vtkNew<vtkIdTypeArray> nodes;
  nodes->SetName("ActiveNode");
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    for (const IntermediateState& state : toolSpace.intermediate_states)
    {
      const palpate::Vec3 place = toolSpace.setup.interaction.material_point + state.t;
      vertices->InsertNextCell({ points->InsertNextPoint(place.data()) });
      nodes->InsertNextValue(toolSpace.setup.interaction.active_node);
      all.push_back(&state);
    }
  }
  data->SetPoints(points);
  data->SetVerts(vertices);
  vtkPointData* arrays = data->GetPointData();
  ForEachDoubleArrayOfStates(ArrayMaker<vtkDoubleArray>(arrays, all));
  ForEachIntArrayOfStates(ArrayMaker<vtkIntArray>(arrays, all));
  AddOutcomes(arrays, all);
  arrays->AddArray(nodes);
  arrays->SetActiveScalars("Force");
  return data;
}

/// Calls visit(name, value) for each field array that has a value for each tool space, but for the
/// active nodes themselves. @tparam ToolSpaceSetup palpate::ToolSpaceSetup, or const.
template <class ToolSpaceSetup, class Visit>
void VisitSetup(ToolSpaceSetup&& setup, Visit&& visit)
{
  visit("TipRadius", setup.interaction.tip_radius);
  visit("HalfWidth", setup.grid.half_width);
  visit("Resolution", setup.grid.resolution);
  visit("ForceLimit", setup.policy.force_limit);
  visit("CoarsestCell", setup.grid.coarsest);
  visit("Tolerance", setup.policy.tolerance);
  visit("ToleranceIsRelative", setup.policy.tolerance_is_relative);
  visit("History", setup.policy.history);
  visit("IntermediateStates", setup.policy.intermediate_states);
  visit("ThirdDerivatives", setup.policy.third_derivatives);
}

/// The same for those that a space has only where its tool is rigid.
template <class ToolSpaceSetup, class Visit>
void VisitContact(ToolSpaceSetup&& setup, Visit&& visit)
{
  auto& tool = setup.interaction.tool;
  visit("ToolShape", tool.shape);
  visit("ToolRadius", tool.radius);
  visit("ToolAxisX", tool.axis[0]);
  visit("ToolAxisY", tool.axis[1]);
  visit("ToolAxisZ", tool.axis[2]);
  visit("ToolLength", tool.length);
  visit("ContactThickness", tool.law.thickness);
  visit("ContactStiffness", tool.law.stiffness);
  visit("GridOriginX", setup.grid.origin[0]);
  visit("GridOriginY", setup.grid.origin[1]);
  visit("GridOriginZ", setup.grid.origin[2]);
  visit("Depth", setup.policy.depth);
}

/// Spaces that were saved before there was an offset have none.
constexpr const char* ContactOffset = "ContactOffset";
/// Field arrays of the tool's surface, where it is one.
constexpr const char* ToolPoints = "ToolPoints";
constexpr const char* ToolTriangles = "ToolTriangles";

/// A space has one rigid tool at the most.
void AddContactFields(const TouchSpace& space, vtkFieldData* fields)
{
  const TouchToolSpace* found = space.find_pressing();
  if (!found)
  {
    return;
  }
  VisitContact(found->setup,
    [&](const char* name, auto value) { AddNumber(fields, name, static_cast<double>(value)); });
  const palpate::RigidTool& tool = found->setup.interaction.tool;
  AddNumber(fields, ContactOffset, tool.law.offset);
  if (tool.shape != palpate::ToolShape::surface)
  {
    return;
  }
  auto* points =
    AddArray<vtkDoubleArray>(fields, ToolPoints, 3, static_cast<vtkIdType>(tool.points.size()));
  for (std::size_t p = 0; p < tool.points.size(); ++p)
  {
    points->SetTypedTuple(static_cast<vtkIdType>(p), tool.points[p].data());
  }
  auto* triangles =
    AddArray<vtkIntArray>(fields, ToolTriangles, 3, static_cast<vtkIdType>(tool.triangles.size()));
  for (std::size_t t = 0; t < tool.triangles.size(); ++t)
  {
    triangles->SetTypedTuple(static_cast<vtkIdType>(t), tool.triangles[t].data());
  }
}

void AddSpaceFields(const TouchSpace& space, vtkFieldData* fields)
{
  vtkNew<vtkStringArray> hash;
  hash->SetName("SceneHash");
  hash->InsertNextValue(space.scene_hash);
  fields->AddArray(hash);
  AddArray<vtkIntArray>(fields, "SchemaVersion", 1, 1)
    ->SetValue(0, static_cast<int>(palpate::storage::kSchemaVersion));
  const auto count = static_cast<vtkIdType>(space.tool_spaces.size());
  auto* nodes = AddArray<vtkIdTypeArray>(fields, "ActiveNodes", 1, count);
  VisitSetup(palpate::ToolSpaceSetup(),
    [&](const char* name, auto value)
    {
      using Array =
        std::conditional_t<std::is_same_v<decltype(value), double>, vtkDoubleArray, vtkIntArray>;
      AddArray<Array>(fields, name, 1, count);
    });
  auto* numbers = AddArray<vtkIdTypeArray>(fields, "NumberOfConfigurations", 1, count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const TouchToolSpace& toolSpace = space.tool_spaces[i];
    nodes->SetValue(i, toolSpace.setup.interaction.active_node);
    VisitSetup(toolSpace.setup,
      [&](const char* name, auto value)
      { fields->GetArray(name)->SetComponent(i, 0, static_cast<double>(value)); });
    numbers->SetValue(i, static_cast<vtkIdType>(toolSpace.configurations.size()));
  }
  AddNumber(fields, "LargestDisplacement", space.largest_displacement);
  AddNumber(fields, "DisplacementError", space.displacement_error);
  AddNumber(fields, "SensitivityError", space.sensitivity_error);
  AddContactFields(space, fields);
}

/// An array with a number of components.
/// @throws InputError it is not there, or not of this shape.
vtkDataArray* Required(vtkFieldData* data, const char* name, int components)
{
  vtkDataArray* array = data->GetArray(name);
  if (!array)
  {
    throw InputError("The state space has no array " + std::string(name) +
      ". Use the output of Precompute State Space or State Space Reader.");
  }
  if (array->GetNumberOfComponents() != components)
  {
    throw InputError("The array " + std::string(name) + " of the state space has " +
      std::to_string(array->GetNumberOfComponents()) + " components instead of " +
      std::to_string(components) + ". Compute the state space again.");
  }
  return array;
}

/// The modes of an active node [3 x points, modes]; where there are none, there is no array.
Eigen::MatrixXf ReadModes(vtkPointData* data, vtkIdType points, Index node)
{
  vtkDataArray* array = data->GetArray(ModesName(false, node).c_str());
  if (!array)
  {
    array = data->GetArray(ModesName(true, node).c_str());
  }
  Eigen::MatrixXf modes(3 * points, array ? array->GetNumberOfComponents() / 3 : 0);
  for (vtkIdType p = 0; p < points; ++p)
  {
    for (int m = 0; m < modes.cols(); ++m)
    {
      for (int c = 0; c < 3; ++c)
      {
        modes(3 * p + c, m) = static_cast<float>(array->GetComponent(p, 3 * m + c));
      }
    }
  }
  return modes;
}

void ReadSurface(vtkDataSet* data, TouchSpace& space)
{
  const vtkIdType count = data->GetNumberOfPoints();
  vtkDataArray* meshPoints = Required(data->GetPointData(), "MeshPoint", 1);
  palpate::Surface& surface = space.surface;
  surface.points.resize(count);
  surface.mesh_points.resize(count);
  for (vtkIdType p = 0; p < count; ++p)
  {
    data->GetPoint(p, surface.points[p].data());
    surface.mesh_points[p] = static_cast<Index>(meshPoints->GetComponent(p, 0));
  }
  vtkNew<vtkIdList> corners;
  for (vtkIdType t = 0; t < data->GetNumberOfCells(); ++t)
  {
    data->GetCellPoints(t, corners);
    if (corners->GetNumberOfIds() != 3)
    {
      throw InputError("Cell " + std::to_string(t) +
        " of the Surface of the state space is no triangle. Compute the state space again.");
    }
    surface.triangles.push_back({ static_cast<Index>(corners->GetId(0)),
      static_cast<Index>(corners->GetId(1)), static_cast<Index>(corners->GetId(2)) });
  }
}

/// What reads the array of a figure of each of the items; ForEachDoubleArray or the like visits it.
template <class Item>
auto DoubleReader(vtkPointData* arrays, std::vector<Item>& all)
{
  return [arrays, &all](const char* name, int components, auto get)
  {
    vtkDataArray* array = Required(arrays, name, components);
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      array->GetTuple(static_cast<vtkIdType>(i), get(all[i]));
    }
  };
}

/// The same for figures that are integers.
template <class Item>
auto IntReader(vtkPointData* arrays, std::vector<Item>& all)
{
  return [arrays, &all](const char* name, int components, auto get)
  {
    vtkDataArray* array = Required(arrays, name, components);
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      for (int c = 0; c < components; ++c)
      {
        get(all[i])[c] = static_cast<int>(array->GetComponent(static_cast<vtkIdType>(i), c));
      }
    }
  };
}

template <class Item>
void ReadOutcomes(vtkPointData* arrays, std::vector<Item>& all)
{
  vtkDataArray* outcomes = Required(arrays, "Outcome", 1);
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    const double outcome = outcomes->GetComponent(static_cast<vtkIdType>(i), 0);
    all[i].outcome = static_cast<palpate::Outcome>(static_cast<int>(outcome));
  }
}

void ReadContact(vtkFieldData* fields, palpate::ToolSpaceSetup& setup)
{
  setup.id = palpate::kContactToolSpace;
  setup.interaction.kind = palpate::InteractionKind::rigid_contact;
  setup.grid.sparse = true;
  VisitContact(setup,
    [&](const char* name, auto& value)
    {
      value =
        static_cast<std::decay_t<decltype(value)>>(Required(fields, name, 1)->GetComponent(0, 0));
    });
  palpate::RigidTool& tool = setup.interaction.tool;
  if (fields->GetArray(ContactOffset))
  {
    tool.law.offset = Required(fields, ContactOffset, 1)->GetComponent(0, 0);
  }
  if (tool.shape != palpate::ToolShape::surface)
  {
    return;
  }
  vtkDataArray* points = Required(fields, ToolPoints, 3);
  for (vtkIdType p = 0; p < points->GetNumberOfTuples(); ++p)
  {
    points->GetTuple(p, tool.points.emplace_back().data());
  }
  vtkDataArray* triangles = Required(fields, ToolTriangles, 3);
  for (vtkIdType t = 0; t < triangles->GetNumberOfTuples(); ++t)
  {
    auto& triangle = tool.triangles.emplace_back();
    for (int c = 0; c < 3; ++c)
    {
      triangle[c] = static_cast<Index>(triangles->GetComponent(t, c));
    }
  }
}

std::string SceneHash(vtkDataSet* configurations)
{
  auto* hash =
    vtkStringArray::SafeDownCast(configurations->GetFieldData()->GetAbstractArray("SceneHash"));
  return hash && hash->GetNumberOfValues() > 0 ? hash->GetValue(0) : "";
}

/// @param surface What has the modes.
void ReadConfigurations(vtkDataSet* data, vtkDataSet* surface, TouchSpace& space)
{
  vtkPointData* arrays = data->GetPointData();
  const vtkIdType count = data->GetNumberOfPoints();
  std::vector<ConfigurationSummary> all(count);
  ForEachDoubleArray(DoubleReader(arrays, all));
  ForEachIntArray(IntReader(arrays, all));
  ReadOutcomes(arrays, all);
  if (arrays->HasArray(ThirdDerivative))
  {
    DoubleReader(arrays, all)(
      ThirdDerivative, 10, [](auto& c) { return c.third_derivative.data(); });
  }

  if (arrays->HasArray(LevelsReached))
  {
    vtkDataArray* reached = Required(arrays, LevelsReached, palpate::num_neighbours);
    for (vtkIdType i = 0; i < count; ++i)
    {
      for (int n = 0; n < palpate::num_neighbours; ++n)
      {
        all[i].reached[n] = static_cast<std::int32_t>(reached->GetComponent(i, n));
      }
    }
  }

  vtkFieldData* fields = data->GetFieldData();
  space.scene_hash = SceneHash(data);
  if (auto* file = vtkStringArray::SafeDownCast(fields->GetAbstractArray(FileName)))
  {
    space.file = file->GetValue(0);
  }
  space.largest_displacement = Required(fields, "LargestDisplacement", 1)->GetComponent(0, 0);
  space.displacement_error = Required(fields, "DisplacementError", 1)->GetComponent(0, 0);
  space.sensitivity_error = Required(fields, "SensitivityError", 1)->GetComponent(0, 0);
  vtkDataArray* toolSpaces = Required(fields, "ActiveNodes", 1);

  vtkDataArray* nodes = Required(arrays, "ActiveNode", 1);
  vtkDataArray* coefficients = arrays->GetArray("Coefficients");
  const int most = coefficients ? coefficients->GetNumberOfComponents() : 0;
  vtkDataArray* gradients = most > 0 ? Required(arrays, "CoefficientGradient", 3 * most) : nullptr;
  for (vtkIdType s = 0; s < toolSpaces->GetNumberOfTuples(); ++s)
  {
    TouchToolSpace& toolSpace = space.tool_spaces.emplace_back();
    const auto node = static_cast<Index>(toolSpaces->GetComponent(s, 0));
    toolSpace.setup.id = node;
    toolSpace.setup.interaction.active_node = node;
    VisitSetup(toolSpace.setup,
      [&](const char* name, auto& value)
      {
        value =
          static_cast<std::decay_t<decltype(value)>>(Required(fields, name, 1)->GetComponent(s, 0));
      });
    std::vector<vtkIdType> ids;
    for (vtkIdType i = 0; i < count; ++i)
    {
      if (static_cast<Index>(nodes->GetComponent(i, 0)) == node)
      {
        ids.push_back(i);
      }
    }
    // A stock filter may have changed their order.
    std::sort(ids.begin(), ids.end(), [&](vtkIdType a, vtkIdType b) { return all[a] < all[b]; });
    if (node >= 0)
    {
      toolSpace.modes = ReadModes(surface->GetPointData(), surface->GetNumberOfPoints(), node);
    }
    const int own = static_cast<int>(toolSpace.modes.cols());
    if (own > most)
    {
      throw InputError("The array Coefficients of the state space has " + std::to_string(most) +
        " components, fewer than the " + std::to_string(own) + " modes of active node " +
        std::to_string(node) + ". Compute the state space again.");
    }
    toolSpace.coefficients.resize(own, static_cast<Eigen::Index>(ids.size()));
    toolSpace.coefficient_gradients.resize(3 * own, static_cast<Eigen::Index>(ids.size()));
    for (std::size_t i = 0; i < ids.size(); ++i)
    {
      toolSpace.configurations.push_back(all[ids[i]]);
      for (int m = 0; m < own; ++m)
      {
        toolSpace.coefficients(m, i) = static_cast<float>(coefficients->GetComponent(ids[i], m));
      }
      for (int m = 0; m < 3 * own; ++m)
      {
        toolSpace.coefficient_gradients(m, i) =
          static_cast<float>(gradients->GetComponent(ids[i], m / own * most + m % own));
      }
    }
    if (node < 0)
    {
      ReadContact(fields, toolSpace.setup);
    }
    else if (const Index point = space.surface.find(node); point >= 0)
    {
      toolSpace.setup.interaction.material_point = space.surface.points[point];
    }
  }
  std::sort(space.tool_spaces.begin(), space.tool_spaces.end(),
    [](const TouchToolSpace& a, const TouchToolSpace& b) { return a.setup.id < b.setup.id; });
}

/// Of the tool spaces that the space has.
void ReadIntermediateStates(vtkDataSet* data, TouchSpace& space)
{
  vtkPointData* arrays = data->GetPointData();
  std::vector<IntermediateState> all(data->GetNumberOfPoints());
  ForEachDoubleArrayOfStates(DoubleReader(arrays, all));
  ForEachIntArrayOfStates(IntReader(arrays, all));
  ReadOutcomes(arrays, all);
  vtkDataArray* nodes = Required(arrays, "ActiveNode", 1);
  for (TouchToolSpace& toolSpace : space.tool_spaces)
  {
    std::vector<IntermediateState>& states = toolSpace.intermediate_states;
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      if (nodes->GetComponent(static_cast<vtkIdType>(i), 0) ==
        toolSpace.setup.interaction.active_node)
      {
        states.push_back(all[i]);
      }
    }
    std::sort(states.begin(), states.end());
  }
}

/// The partitions on this rank of the block of a name that have points.
template <class Data = vtkPointSet>
std::vector<vtkSmartPointer<Data>> FindBlock(
  vtkPartitionedDataSetCollection* collection, const std::string& name)
{
  std::vector<vtkSmartPointer<Data>> pieces;
  for (unsigned int i = 0; i < collection->GetNumberOfPartitionedDataSets(); ++i)
  {
    const char* own = collection->HasMetaData(i)
      ? collection->GetMetaData(i)->Get(vtkCompositeDataSet::NAME())
      : nullptr;
    if (!own || own != name)
    {
      continue;
    }
    for (unsigned int p = 0; p < collection->GetNumberOfPartitions(i); ++p)
    {
      auto* data = Data::SafeDownCast(collection->GetPartitionAsDataObject(i, p));
      if (data && data->GetNumberOfPoints() > 0)
      {
        pieces.emplace_back(data);
      }
    }
  }
  return pieces;
}

/// Whether the tool of a space is rigid: the same on every rank.
/// @param configurations The pieces of all ranks, which rank 0 has.
bool HasContact(const vtkPalpatePieces& configurations, vtkMultiProcessController* controller)
{
  int has = std::any_of(configurations.begin(), configurations.end(),
    [](vtkPointSet* piece) { return piece->GetFieldData()->HasArray("ToolShape") != 0; });
  if (controller && controller->GetNumberOfProcesses() > 1)
  {
    controller->Broadcast(&has, 1, 0);
  }
  return has != 0;
}

/// @throws InputError they are pieces of different spaces.
void ExpectOneSpace(const vtkPalpatePieces& configurations)
{
  std::set<std::string> hashes;
  for (const auto& piece : configurations)
  {
    hashes.insert(SceneHash(piece));
  }
  hashes.erase("");
  if (hashes.size() > 1)
  {
    throw InputError("The partitions of Configurations belong to " + std::to_string(hashes.size()) +
      " different scenes. Give one state space alone.");
  }
}

/// The pieces as one data set, null where there is none.
/// @param keys The arrays by which a point is known, and their components.
vtkSmartPointer<vtkDataSet> Join(
  const vtkPalpatePieces& pieces, const std::vector<std::pair<const char*, int>>& keys)
{
  if (pieces.empty())
  {
    return nullptr;
  }
  return vtkPalpateJoin(pieces,
    [&keys](vtkPointSet* piece)
    {
      std::vector<vtkDataArray*> arrays;
      for (const auto& [name, components] : keys)
      {
        arrays.push_back(Required(piece->GetPointData(), name, components));
      }
      return arrays;
    });
}
}

void vtkPalpateNameBlocks(vtkPartitionedDataSetCollection* output, bool hasIntermediateStates)
{
  output->Initialize();
  const unsigned int count = hasIntermediateStates ? 4 : 3;
  output->SetNumberOfPartitionedDataSets(count);
  for (unsigned int i = 0; i < count; ++i)
  {
    output->SetPartitionedDataSet(i, vtkNew<vtkPartitionedDataSet>());
    output->GetMetaData(i)->Set(vtkCompositeDataSet::NAME(), BlockNames[i]);
  }
}

namespace
{
/// What the data of a space take, roughly, in bytes: arrays grow by doubling.
std::size_t DataBytes(const palpate::Scene& scene, const TouchSpace& space)
{
  std::size_t bytes =
    sizeof(palpate::Vec3) * scene.mesh.points.size() + sizeof(vtkIdType) * scene.mesh.cells.size();
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    bytes += sizeof(palpate::ConfigurationSummary) * toolSpace.configurations.size() +
      sizeof(float) *
        static_cast<std::size_t>(toolSpace.modes.size() + toolSpace.coefficients.size() +
          toolSpace.coefficient_gradients.size());
  }
  return 2 * bytes;
}
}

void vtkPalpateFillCollection(
  const palpate::Scene& scene, TouchSpace space, vtkPartitionedDataSetCollection* output)
{
  palpate::require_memory(DataBytes(scene, space), "for the data of the state space");
  const auto configurations = ConfigurationData(space);
  AddSpaceFields(space, configurations->GetFieldData());
  output->SetPartition(0, 0, vtkPalpateGridFromScene(scene));
  output->SetPartition(1, 0, SurfaceData(space));
  output->SetPartition(2, 0, configurations);
  if (vtkPalpateHasIntermediateStates(space))
  {
    output->SetPartition(3, 0, IntermediateStateData(space));
  }
}

bool vtkPalpateHasIntermediateStates(const TouchSpace& space)
{
  return std::any_of(space.tool_spaces.begin(), space.tool_spaces.end(),
    [](const TouchToolSpace& toolSpace) { return !toolSpace.intermediate_states.empty(); });
}

void vtkPalpateAddFile(const std::string& fileName, bool complete, vtkFieldData* fields)
{
  vtkNew<vtkStringArray> file;
  file->SetName(FileName);
  file->InsertNextValue(fileName);
  fields->AddArray(file);
  AddArray<vtkIntArray>(fields, "Complete", 1, 1)->SetValue(0, complete ? 1 : 0);
}

void vtkPalpateAddLeftOut(const std::vector<std::string>& leftOut, vtkFieldData* fields)
{
  vtkNew<vtkStringArray> names;
  names->SetName("LeftOut");
  for (const std::string& name : leftOut)
  {
    names->InsertNextValue(name);
  }
  fields->AddArray(names);
}

vtkPalpatePieces vtkPalpateBody(vtkPartitionedDataSetCollection* collection)
{
  return FindBlock(collection, BlockNames[0]);
}

std::vector<vtkSmartPointer<vtkDataSet>> vtkPalpateConfigurations(
  vtkPartitionedDataSetCollection* collection)
{
  return FindBlock<vtkDataSet>(collection, BlockNames[2]);
}

TouchSpace vtkPalpateSpaceFromCollection(
  vtkPartitionedDataSetCollection* collection, vtkMultiProcessController* controller)
{
  const auto gather = [&](const char* name)
  { return vtkPalpateGatherPieces(FindBlock(collection, name), controller); };
  const vtkPalpatePieces surfaces = gather(BlockNames[1]);
  const vtkPalpatePieces allConfigurations = gather(BlockNames[2]);
  const vtkPalpatePieces allStates = gather(BlockNames[3]);
  const auto body = HasContact(allConfigurations, controller)
    ? vtkPalpateGatherBody(vtkPalpateBody(collection), controller)
    : nullptr;
  TouchSpace space;
  if (controller && controller->GetLocalProcessId() != 0)
  {
    return space;
  }
  ExpectOneSpace(allConfigurations);
  const auto surface = Join(surfaces, { { "MeshPoint", 1 } });
  const auto configurations =
    Join(allConfigurations, { { "ActiveNode", 1 }, { "CheckPoint", 3 }, { "Level", 1 } });
  const auto states =
    Join(allStates, { { "ActiveNode", 1 }, { "TargetCheckPoint", 3 }, { "Number", 1 } });
  if (!surface || !configurations)
  {
    throw InputError("The input is no state space: it has no block Surface or no block "
                     "Configurations with points. Use the output of Precompute State Space or of "
                     "State Space Reader.");
  }
  ReadSurface(surface, space);
  ReadConfigurations(configurations, surface, space);
  if (states)
  {
    ReadIntermediateStates(states, space);
  }
  for (TouchToolSpace& toolSpace : space.tool_spaces)
  {
    if (toolSpace.setup.presses())
    {
      palpate::add_clearance(vtkPalpateSceneOfSpace(body), toolSpace);
    }
  }
  return space;
}
