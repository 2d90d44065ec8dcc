// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateStateSpace.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/memory_error.h"
#include "schedule/communicator.h"
#include "schedule/packing.h"
#include "storage/schema.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateStateSpaceArrays.h"
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
using namespace vtkPalpateStateSpaceArrays;
using palpate::CheckPoint;
using palpate::ConfigurationSummary;
using palpate::Index;
using palpate::IntermediateState;
using palpate::TouchSpace;
using palpate::TouchToolSpace;

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

bool HasOneNode(const TouchSpace& space)
{
  return std::count_if(space.tool_spaces.begin(), space.tool_spaces.end(),
           [](const TouchToolSpace& toolSpace) { return !toolSpace.setup.presses(); }) == 1;
}

/// Adds the bodies of the configurations or of the intermediate states.
template <class ItemsOf>
void AddBodyNumbers(const TouchSpace& space, vtkPointData* arrays, const ItemsOf& itemsOf)
{
  if (!space.has_other_bodies())
  {
    return;
  }
  vtkNew<vtkIdTypeArray> numbers;
  numbers->SetName(BodyNumber);
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    for (std::size_t i = 0; i < itemsOf(toolSpace).size(); ++i)
    {
      numbers->InsertNextValue(toolSpace.setup.body);
    }
  }
  arrays->AddArray(numbers);
}

void AddModes(const TouchSpace& space, const TouchToolSpace& toolSpace, vtkPointData* arrays)
{
  const Eigen::MatrixXf& modes = toolSpace.modes;
  // VTK has no arrays without components.
  if (modes.cols() == 0)
  {
    return;
  }
  const std::string name = ModesName(HasOneNode(space), toolSpace.setup.key());
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

/// @param space Its modes are moved away.
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
  if (!space.stages.empty())
  {
    const auto numSides = static_cast<vtkIdType>(surface.stages_of_cut.size());
    auto* sides = AddArray<vtkIntArray>(data->GetFieldData(), StageOfSide, 1, numSides);
    std::copy(surface.stages_of_cut.begin(), surface.stages_of_cut.end(), sides->GetPointer(0));
    auto* stages = AddArray<vtkDoubleArray>(
      data->GetFieldData(), StagesOfCut, 2, static_cast<vtkIdType>(space.stages.size()));
    for (std::size_t s = 0; s < space.stages.size(); ++s)
    {
      stages->SetTuple2(
        static_cast<vtkIdType>(s), static_cast<double>(space.stages[s].body), space.stages[s].area);
    }
  }
  return data;
}

/// A visitor for ForEachDoubleArray and the like, which makes an array of a figure of each of the
/// items.
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

/// The worst fault of a configuration. The names are in plugin/Palpate/PalpateLooks.cxx.
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
        if (c.reached[n] < 0)
        {
          continue;
        }
        const auto target = idOf.find(
          { palpate::nearest_neighbour(toolSpace.configurations, c.check_point, n), c.reached[n] });
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
  const auto turned =
    std::find_if(all.begin(), all.end(), [](auto* c) { return !c->of_turns.empty(); });
  if (turned != all.end())
  {
    auto* ofTurns = AddArray<vtkDoubleArray>(
      arrays, TurnDerivatives, static_cast<int>((*turned)->of_turns.size()), count);
    // Where a tool touches nothing there are none.
    ofTurns->Fill(std::numeric_limits<double>::quiet_NaN());
    for (vtkIdType i = 0; i < count; ++i)
    {
      if (!all[i]->of_turns.empty())
      {
        ofTurns->SetTypedTuple(i, all[i]->of_turns.data());
      }
    }
  }
  if (std::any_of(all.begin(), all.end(), [](auto* c) { return c->mesh_error.is_known(); }))
  {
    const auto addDoubles = ArrayMaker<vtkDoubleArray>(arrays, all);
    addDoubles(MeshError, 3, [](auto& c) { return c.mesh_error.force.data(); });
    addDoubles(MeshErrorEnergy, 1, [](auto& c) { return &c.mesh_error.energy; });
    auto* reliable = AddArray<vtkUnsignedCharArray>(arrays, MeshErrorReliable, 1, count);
    std::transform(all.begin(), all.end(), reliable->GetPointer(0),
      [](const ConfigurationSummary* c) { return c->mesh_error.is_reliable ? 1 : 0; });
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
    // Modes that an active node does not have get the coefficient 0; a rigid tool has no modes.
    coefficients->Fill(0);
    gradients->Fill(0);
  }
  vtkIdType next = 0;
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    for (Eigen::Index i = 0; i < toolSpace.coefficients.cols(); ++i, ++next)
    {
      nodes->SetValue(next, toolSpace.setup.number());
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
  AddBodyNumbers(
    space, arrays,
    [](const TouchToolSpace& toolSpace) -> const auto& { return toolSpace.configurations; });
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
  AddBodyNumbers(
    space, arrays,
    [](const TouchToolSpace& toolSpace) -> const auto& { return toolSpace.intermediate_states; });
  arrays->SetActiveScalars("Force");
  return data;
}

/// A space has one rigid tool at the most, which may press several bodies. Each of their tool
/// spaces has an entry in the arrays.
void AddContactFields(const TouchSpace& space, vtkFieldData* fields)
{
  std::vector<const palpate::ToolSpaceSetup*> setups;
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    if (toolSpace.setup.presses())
    {
      setups.push_back(&toolSpace.setup);
    }
  }
  if (setups.empty())
  {
    return;
  }
  const auto count = static_cast<vtkIdType>(setups.size());
  const palpate::RigidTool& tool = setups.front()->interaction.tool;
  VisitContact(*setups.front(),
    [&](const char* name, auto) { AddArray<vtkDoubleArray>(fields, name, 1, count); });
  auto* offsets = AddArray<vtkDoubleArray>(fields, ContactOffset, 1, count);
  for (vtkIdType s = 0; s < count; ++s)
  {
    VisitContact(*setups[s],
      [&](const char* name, auto value)
      { fields->GetArray(name)->SetComponent(s, 0, static_cast<double>(value)); });
    offsets->SetValue(s, setups[s]->interaction.tool.law.offset);
  }
  if (tool.motion != palpate::ToolMotion::translated)
  {
    // All bodies are pressed by one tool, but a tool space may have an orientation of its own.
    AddArray<vtkIntArray>(fields, ToolMotion, 1, 1)->SetValue(0, static_cast<int>(tool.motion));
    auto* numbers = AddArray<vtkDoubleArray>(
      fields, MotionNumbers, static_cast<int>(tool.motion_numbers.size()), count);
    for (vtkIdType s = 0; s < count; ++s)
    {
      numbers->SetTypedTuple(s, setups[s]->interaction.tool.motion_numbers.data());
    }
  }
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

/// Adds the regions, if a tool space has one.
void AddRegions(const TouchSpace& space, vtkFieldData* fields)
{
  const auto hasRegion = [](const TouchToolSpace& of) { return of.setup.region.has_value(); };
  if (std::none_of(space.tool_spaces.begin(), space.tool_spaces.end(), hasRegion))
  {
    return;
  }
  palpate::MeshRegion none;
  none.tolerance = -1;
  const auto count = static_cast<vtkIdType>(space.tool_spaces.size());
  auto* centres = AddArray<vtkDoubleArray>(fields, RegionCentre, 3, count);
  VisitRegion(
    none, [&](const char* name, double) { AddArray<vtkDoubleArray>(fields, name, 1, count); });
  for (vtkIdType s = 0; s < count; ++s)
  {
    const palpate::MeshRegion region = space.tool_spaces[s].setup.region.value_or(none);
    centres->SetTypedTuple(s, region.centre.data());
    VisitRegion(region,
      [&](const char* name, double value) { fields->GetArray(name)->SetComponent(s, 0, value); });
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
  if (space.has_other_bodies())
  {
    auto* bodies = AddArray<vtkIdTypeArray>(fields, BodyNumbers, 1, count);
    auto* places = AddArray<vtkDoubleArray>(fields, MaterialPoints, 3, count);
    for (vtkIdType i = 0; i < count; ++i)
    {
      const palpate::ToolSpaceSetup& setup = space.tool_spaces[i].setup;
      bodies->SetValue(i, setup.body);
      places->SetTypedTuple(i, setup.interaction.material_point.data());
    }
  }
  AddRegions(space, fields);
  auto* numbers = AddArray<vtkIdTypeArray>(fields, "NumberOfConfigurations", 1, count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const TouchToolSpace& toolSpace = space.tool_spaces[i];
    nodes->SetValue(i, toolSpace.setup.number());
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

}

std::vector<unsigned int> vtkPalpateStateSpaceArrays::FindBlocks(
  vtkPartitionedDataSetCollection* collection, const std::string& name)
{
  std::vector<unsigned int> found;
  for (unsigned int i = 0; i < collection->GetNumberOfPartitionedDataSets(); ++i)
  {
    const char* of = collection->HasMetaData(i)
      ? collection->GetMetaData(i)->Get(vtkCompositeDataSet::NAME())
      : nullptr;
    if (of && name == of)
    {
      found.push_back(i);
    }
  }
  return found;
}

void vtkPalpateNameBlocks(
  vtkPartitionedDataSetCollection* output, bool hasIntermediateStates, std::size_t numBodies)
{
  std::vector<std::string> names(BlockNames, BlockNames + (hasIntermediateStates ? 4 : 3));
  for (std::size_t b = 1; b < numBodies; ++b)
  {
    names.push_back(BodyBlockName(palpate::kFirstBody + static_cast<palpate::BodyId>(b)));
  }
  output->Initialize();
  output->SetNumberOfPartitionedDataSets(static_cast<unsigned int>(names.size()));
  for (unsigned int i = 0; i < names.size(); ++i)
  {
    output->SetPartitionedDataSet(i, vtkNew<vtkPartitionedDataSet>());
    output->GetMetaData(i)->Set(vtkCompositeDataSet::NAME(), names[i].c_str());
  }
}

namespace
{
/// The approximate memory of the data of a space, bytes: arrays grow by doubling.
std::size_t DataBytes(const std::vector<palpate::SpaceBody>& bodies, const TouchSpace& space)
{
  std::size_t bytes = 0;
  for (const palpate::SpaceBody& body : bodies)
  {
    bytes += sizeof(palpate::Vec3) * body.mesh().points.size() +
      sizeof(vtkIdType) * body.mesh().cells.size();
  }
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

void vtkPalpateFillCollection(const std::vector<palpate::SpaceBody>& bodies, TouchSpace space,
  vtkPartitionedDataSetCollection* output)
{
  palpate::require_memory(DataBytes(bodies, space), "for the data of the state space");
  const auto configurations = ConfigurationData(space);
  AddSpaceFields(space, configurations->GetFieldData());
  output->SetPartition(1, 0, SurfaceData(space));
  output->SetPartition(2, 0, configurations);
  if (vtkPalpateHasIntermediateStates(space))
  {
    output->SetPartition(3, 0, IntermediateStateData(space));
  }
  for (const palpate::SpaceBody& body : bodies)
  {
    for (const unsigned int block : FindBlocks(output, BodyBlockName(body.number)))
    {
      output->SetPartition(block, 0, vtkPalpateGridFromScene(*body.scene, body.at_rest));
    }
  }
}

std::size_t vtkPalpateNumberOfBodies(
  const std::vector<palpate::SpaceBody>& bodies, palpate::Communicator& communicator)
{
  palpate::Packer mine;
  mine.put(static_cast<std::int64_t>(bodies.size()));
  const std::vector<palpate::Bytes> all = communicator.all_gather(mine.take());
  return static_cast<std::size_t>(palpate::Unpacker(all.front()).take<std::int64_t>());
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
