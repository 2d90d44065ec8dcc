// SPDX-License-Identifier: BSD-3-Clause
// Makes a state space from data. The reverse way is in vtkPalpateStateSpace.cxx.
#include "vtkPalpateStateSpace.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPalpatePieces.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateStateSpaceArrays.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using namespace vtkPalpateStateSpaceArrays;
using palpate::CheckPoint;
using palpate::ConfigurationSummary;
using palpate::Index;
using palpate::InputError;
using palpate::IntermediateState;
using palpate::TouchSpace;
using palpate::TouchToolSpace;

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
Eigen::MatrixXf ReadModes(vtkPointData* data, vtkIdType points, const palpate::ToolSpaceKey& key)
{
  vtkDataArray* array = data->GetArray(ModesName(false, key).c_str());
  if (!array)
  {
    array = data->GetArray(ModesName(true, key).c_str());
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
  if (!data->GetFieldData()->HasArray(StagesOfCut))
  {
    return;
  }
  vtkDataArray* sides = Required(data->GetFieldData(), StageOfSide, 1);
  for (vtkIdType side = 0; side < sides->GetNumberOfTuples(); ++side)
  {
    surface.stages_of_cut.push_back(static_cast<std::int32_t>(sides->GetComponent(side, 0)));
  }
  if (surface.stages_of_cut.size() > surface.triangles.size())
  {
    throw InputError("The Surface of the state space has fewer triangles than its cut. Compute the "
                     "state space again.");
  }
  vtkDataArray* stages = Required(data->GetFieldData(), StagesOfCut, 2);
  for (vtkIdType s = 0; s < stages->GetNumberOfTuples(); ++s)
  {
    space.stages.push_back(
      { static_cast<palpate::BodyId>(stages->GetComponent(s, 0)), stages->GetComponent(s, 1) });
  }
}

/// A visitor for ForEachDoubleArray and the like, which reads the array of a figure of each of the
/// items.
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

/// @param number The number of the tool space among those of the rigid tool.
void ReadContact(vtkFieldData* fields, vtkIdType number, palpate::ToolSpaceSetup& setup)
{
  setup.interaction.active_node = -1;
  setup.interaction.kind = palpate::InteractionKind::rigid_contact;
  setup.grid.sparse = true;
  VisitContact(setup,
    [&](const char* name, auto& value)
    {
      value = static_cast<std::decay_t<decltype(value)>>(
        Required(fields, name, 1)->GetComponent(number, 0));
    });
  palpate::RigidTool& tool = setup.interaction.tool;
  if (fields->GetArray(ContactOffset))
  {
    tool.law.offset = Required(fields, ContactOffset, 1)->GetComponent(number, 0);
  }
  if (fields->GetArray(ToolMotion))
  {
    tool.motion = static_cast<palpate::ToolMotion>(
      static_cast<int>(Required(fields, ToolMotion, 1)->GetComponent(0, 0)));
    vtkDataArray* numbers = fields->GetArray(MotionNumbers);
    if (!numbers || number >= numbers->GetNumberOfTuples())
    {
      throw InputError("The state space has no array MotionNumbers of its tool. Compute the state "
                       "space again.");
    }
    tool.motion_numbers.resize(static_cast<std::size_t>(numbers->GetNumberOfComponents()));
    numbers->GetTuple(number, tool.motion_numbers.data());
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

/// @param number The number of the tool space among all.
void ReadRegion(vtkFieldData* fields, vtkIdType number, palpate::ToolSpaceSetup& setup)
{
  if (!fields->HasArray(RegionCentre))
  {
    return;
  }
  palpate::MeshRegion region;
  Required(fields, RegionCentre, 3)->GetTuple(number, region.centre.data());
  VisitRegion(region,
    [&](const char* name, double& value)
    { value = Required(fields, name, 1)->GetComponent(number, 0); });
  if (region.tolerance >= 0)
  {
    setup.region = region;
  }
}

std::string SceneHash(vtkDataSet* configurations)
{
  auto* hash =
    vtkStringArray::SafeDownCast(configurations->GetFieldData()->GetAbstractArray("SceneHash"));
  return hash && hash->GetNumberOfValues() > 0 ? hash->GetValue(0) : "";
}

/// The body of each point of some data: that of the array BodyNumber, or the first one.
std::vector<palpate::BodyId> BodiesOfPoints(vtkDataSet* data)
{
  std::vector<palpate::BodyId> bodies(
    static_cast<std::size_t>(data->GetNumberOfPoints()), palpate::kFirstBody);
  if (data->GetPointData()->HasArray(BodyNumber))
  {
    vtkDataArray* numbers = Required(data->GetPointData(), BodyNumber, 1);
    for (std::size_t i = 0; i < bodies.size(); ++i)
    {
      bodies[i] = static_cast<palpate::BodyId>(numbers->GetComponent(static_cast<vtkIdType>(i), 0));
    }
  }
  return bodies;
}

/// @param surface The data that have the modes.
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
  if (vtkDataArray* ofTurns = arrays->GetArray(TurnDerivatives))
  {
    std::vector<double> numbers(static_cast<std::size_t>(ofTurns->GetNumberOfComponents()));
    for (vtkIdType i = 0; i < count; ++i)
    {
      ofTurns->GetTuple(i, numbers.data());
      if (!std::isnan(numbers.front()))
      {
        all[i].of_turns = numbers;
      }
    }
  }
  if (arrays->HasArray(MeshErrorEnergy))
  {
    const auto readDoubles = DoubleReader(arrays, all);
    readDoubles(MeshError, 3, [](auto& c) { return c.mesh_error.force.data(); });
    readDoubles(MeshErrorEnergy, 1, [](auto& c) { return &c.mesh_error.energy; });
    vtkDataArray* reliable = Required(arrays, MeshErrorReliable, 1);
    for (vtkIdType i = 0; i < count; ++i)
    {
      all[i].mesh_error.is_reliable = reliable->GetComponent(i, 0) != 0;
    }
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
  const std::vector<palpate::BodyId> bodies = BodiesOfPoints(data);
  const bool hasBodies = fields->HasArray(BodyNumbers) != 0;
  vtkDataArray* bodyNumbers = hasBodies ? Required(fields, BodyNumbers, 1) : nullptr;
  vtkDataArray* places = hasBodies ? Required(fields, MaterialPoints, 3) : nullptr;
  vtkIdType numPressing = 0;
  vtkDataArray* coefficients = arrays->GetArray("Coefficients");
  const int most = coefficients ? coefficients->GetNumberOfComponents() : 0;
  vtkDataArray* gradients = most > 0 ? Required(arrays, "CoefficientGradient", 3 * most) : nullptr;
  for (vtkIdType s = 0; s < toolSpaces->GetNumberOfTuples(); ++s)
  {
    TouchToolSpace& toolSpace = space.tool_spaces.emplace_back();
    const auto node = static_cast<Index>(toolSpaces->GetComponent(s, 0));
    toolSpace.setup.id = node;
    toolSpace.setup.interaction.active_node = node;
    if (hasBodies)
    {
      toolSpace.setup.body = static_cast<palpate::BodyId>(bodyNumbers->GetComponent(s, 0));
    }
    VisitSetup(toolSpace.setup,
      [&](const char* name, auto& value)
      {
        value =
          static_cast<std::decay_t<decltype(value)>>(Required(fields, name, 1)->GetComponent(s, 0));
      });
    ReadRegion(fields, s, toolSpace.setup);
    std::vector<vtkIdType> ids;
    for (vtkIdType i = 0; i < count; ++i)
    {
      if (static_cast<Index>(nodes->GetComponent(i, 0)) == node &&
        bodies[static_cast<std::size_t>(i)] == toolSpace.setup.body)
      {
        ids.push_back(i);
      }
    }
    // A stock filter may have changed their order.
    std::sort(ids.begin(), ids.end(), [&](vtkIdType a, vtkIdType b) { return all[a] < all[b]; });
    if (node >= 0)
    {
      toolSpace.modes =
        ReadModes(surface->GetPointData(), surface->GetNumberOfPoints(), toolSpace.setup.key());
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
      ReadContact(fields, numPressing++, toolSpace.setup);
    }
    else if (places)
    {
      places->GetTuple(s, toolSpace.setup.interaction.material_point.data());
    }
    else if (const Index point = space.surface.find(node); point >= 0)
    {
      toolSpace.setup.interaction.material_point = space.surface.points[point];
    }
  }
  std::sort(space.tool_spaces.begin(), space.tool_spaces.end(),
    [](const TouchToolSpace& a, const TouchToolSpace& b) { return a.setup.key() < b.setup.key(); });
}

/// Reads the intermediate states of the tool spaces that the space has.
void ReadIntermediateStates(vtkDataSet* data, TouchSpace& space)
{
  vtkPointData* arrays = data->GetPointData();
  std::vector<IntermediateState> all(data->GetNumberOfPoints());
  ForEachDoubleArrayOfStates(DoubleReader(arrays, all));
  ForEachIntArrayOfStates(IntReader(arrays, all));
  ReadOutcomes(arrays, all);
  vtkDataArray* nodes = Required(arrays, "ActiveNode", 1);
  const std::vector<palpate::BodyId> bodies = BodiesOfPoints(data);
  for (TouchToolSpace& toolSpace : space.tool_spaces)
  {
    std::vector<IntermediateState>& states = toolSpace.intermediate_states;
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      if (nodes->GetComponent(static_cast<vtkIdType>(i), 0) ==
          toolSpace.setup.interaction.active_node &&
        bodies[i] == toolSpace.setup.body)
      {
        states.push_back(all[i]);
      }
    }
    std::sort(states.begin(), states.end());
  }
}

/// The partitions on this rank of the blocks of a name that have points.
template <class Data = vtkPointSet>
std::vector<vtkSmartPointer<Data>> PiecesOfBlocks(
  vtkPartitionedDataSetCollection* collection, const std::string& name)
{
  std::vector<vtkSmartPointer<Data>> pieces;
  for (const unsigned int block : FindBlocks(collection, name))
  {
    for (unsigned int p = 0; p < collection->GetNumberOfPartitions(block); ++p)
    {
      auto* data = Data::SafeDownCast(collection->GetPartitionAsDataObject(block, p));
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

/// Checks that all pieces are of one space. @throws InputError they are pieces of different spaces.
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
/// @param keys The arrays by which a point is known, and their components. BodyNumber is one more,
///   where it is there.
vtkSmartPointer<vtkDataSet> Join(
  const vtkPalpatePieces& pieces, std::vector<std::pair<const char*, int>> keys)
{
  if (pieces.empty())
  {
    return nullptr;
  }
  if (pieces.front()->GetPointData()->HasArray(BodyNumber))
  {
    keys.emplace_back(BodyNumber, 1);
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

vtkPalpatePieces vtkPalpateBody(vtkPartitionedDataSetCollection* collection, palpate::BodyId body)
{
  return PiecesOfBlocks(collection, BodyBlockName(body));
}

std::vector<vtkSmartPointer<vtkUnstructuredGrid>> vtkPalpateGatherBodies(
  vtkPartitionedDataSetCollection* collection, vtkMultiProcessController* controller)
{
  std::vector<vtkSmartPointer<vtkUnstructuredGrid>> bodies;
  // The blocks are the same on every rank.
  const palpate::BodyId last = vtkPalpateLastBody(collection);
  for (palpate::BodyId number = palpate::kFirstBody; number <= last; ++number)
  {
    bodies.push_back(vtkPalpateGatherBody(vtkPalpateBody(collection, number), controller));
  }
  return bodies;
}

palpate::BodyId vtkPalpateLastBody(vtkPartitionedDataSetCollection* collection)
{
  palpate::BodyId last = palpate::kFirstBody;
  while (!FindBlocks(collection, BodyBlockName(last + 1)).empty())
  {
    ++last;
  }
  return last;
}

std::vector<vtkSmartPointer<vtkDataSet>> vtkPalpateConfigurations(
  vtkPartitionedDataSetCollection* collection)
{
  return PiecesOfBlocks<vtkDataSet>(collection, BlockNames[2]);
}

TouchSpace vtkPalpateSpaceFromCollection(
  vtkPartitionedDataSetCollection* collection, vtkMultiProcessController* controller)
{
  const auto gather = [&](const char* name)
  { return vtkPalpateGatherPieces(PiecesOfBlocks(collection, name), controller); };
  const vtkPalpatePieces surfaces = gather(BlockNames[1]);
  const vtkPalpatePieces allConfigurations = gather(BlockNames[2]);
  const vtkPalpatePieces allStates = gather(BlockNames[3]);
  std::vector<vtkSmartPointer<vtkUnstructuredGrid>> bodies;
  if (HasContact(allConfigurations, controller))
  {
    bodies = vtkPalpateGatherBodies(collection, controller);
  }
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
  std::vector<palpate::SpaceBody> pressed;
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    const palpate::BodyId number = toolSpace.setup.body;
    if (!toolSpace.setup.presses() || (!pressed.empty() && pressed.back().number == number))
    {
      continue;
    }
    const auto place = static_cast<std::size_t>(number - palpate::kFirstBody);
    if (place >= bodies.size())
    {
      throw InputError("The state space has no block " + BodyBlockName(number) +
        ". Use the output of Precompute State Space or State Space Reader.");
    }
    palpate::SpaceBody& body = pressed.emplace_back();
    body.number = number;
    body.scene =
      std::make_shared<const palpate::Scene>(vtkPalpateSceneOfSpace(bodies[place], body.at_rest));
  }
  palpate::add_clearances(pressed, space);
  return space;
}
