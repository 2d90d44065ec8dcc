// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTouchStateSpace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "assembly/assembly.h"
#include "base/error.h"
#include "base/memory_error.h"
#include "base/printable.h"
#include "base/quantity.h"
#include "interaction/mesh_error.h"
#include "interpolation/body_field.h"
#include "interpolation/display_field.h"
#include "interpolation/interpolator.h"
#include "interpolation/outcome_at.h"
#include "interpolation/solution_branches.h"
#include "interpolation/tool_force.h"
#include "interpolation/torn_energy.h"
#include "interpolation/turned_force.h"
#include "state_space/shown_surface.h"
#include "storage/field_cache.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateDisplaySurface.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFollowing.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPalpateStress.h"
#include "vtkPalpateTouchedSurface.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::Index;
using palpate::TouchSpace;
using palpate::TouchToolSpace;

/// The tool space of a node of a body.
/// @throws palpate::InputError the node is not in the space: the message says which nodes are.
const TouchToolSpace& SiteOf(const TouchSpace& space, vtkIdType node, palpate::BodyId body)
{
  if (space.tool_spaces.empty())
  {
    throw palpate::InputError("The state space has no active node. Compute it again.");
  }
  if (node == -1)
  {
    const auto found = std::find_if(space.tool_spaces.begin(), space.tool_spaces.end(),
      [&](const TouchToolSpace& of) { return of.setup.body == body; });
    const TouchToolSpace& first =
      found == space.tool_spaces.end() ? space.tool_spaces.front() : *found;
    if (first.setup.turns())
    {
      return first;
    }
    const std::vector<const TouchToolSpace*> pressing = space.list_pressing();
    if (first.setup.presses() && !pressing.empty() && pressing.front()->setup.region)
    {
      return *pressing.front();
    }
    if (first.setup.presses() &&
      std::find(pressing.begin(), pressing.end(), &first) == pressing.end())
    {
      throw palpate::InputError("What a rigid tool does is shown on the first body of a space, and "
                                "not on body " +
        std::to_string(first.setup.body) + ". Set BodyNumber to 1, or name an active node.");
    }
    return first;
  }
  const auto index = static_cast<palpate::Index>(node);
  if (const TouchToolSpace* toolSpace = space.find({ index, body }); toolSpace && index == node)
  {
    return *toolSpace;
  }
  // The meshes of a divided organ number its points alike, and a node is on its own one.
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    if (toolSpace.setup.region && toolSpace.setup.interaction.active_node == node && node >= 0)
    {
      return toolSpace;
    }
  }
  constexpr int mostNamed = 10;
  int number = 0;
  std::string nodes;
  for (const TouchToolSpace& toolSpace : space.tool_spaces)
  {
    if (toolSpace.setup.presses() || toolSpace.setup.body != body || ++number > mostNamed)
    {
      continue;
    }
    nodes += (number == 1 ? "" : ", ") + std::to_string(toolSpace.setup.interaction.active_node);
  }
  if (number > mostNamed)
  {
    nodes += ", …";
  }
  const bool hasBodies = space.has_other_bodies();
  const std::string notThere = "Active node " + std::to_string(node) + " is not " +
    (hasBodies ? "on body " + std::to_string(body) + " of" : "in") + " the state space, which has ";
  if (number == 0 && hasBodies)
  {
    throw palpate::InputError(
      notThere + "no active node there. Set BodyNumber to the body of the node.");
  }
  if (number == 0)
  {
    throw palpate::InputError(notThere + "none, but a rigid tool: give -1 and its ToolPosition.");
  }
  throw palpate::InputError(notThere + std::to_string(number) + ": " + nodes +
    ". Choose one of them, or compute the space for this one.");
}

void AddVector(vtkDataObject* output, const char* name, int components, const double* values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->InsertNextTuple(values);
  output->GetFieldData()->AddArray(array);
}

void AddInteger(vtkDataObject* output, const char* name, int value)
{
  vtkNew<vtkIntArray> array;
  array->SetName(name);
  array->InsertNextValue(value);
  output->GetFieldData()->AddArray(array);
}

/// The displacement of the surface by the modes of the space [3 x points], m.
Eigen::VectorXf BySurfaceModes(
  const TouchToolSpace& toolSpace, const palpate::DisplayField& field, const palpate::Vec3& t)
{
  Eigen::VectorXf coefficients(field.num_modes());
  if (field.coefficients(t, coefficients.data()) == palpate::Support::none ||
    !coefficients.allFinite())
  {
    coefficients.setZero();
  }
  Eigen::VectorXf u(toolSpace.modes.rows());
  palpate::apply_modes(toolSpace.modes, coefficients.data(), u.data());
  return u;
}

/// The parts of a body that need more than the surface.
struct WholeBodyOf
{
  /// @param bodies The first body of the space, and the one that is meant where it is another.
  explicit WholeBodyOf(std::vector<palpate::SpaceBody> bodies)
    : Bodies(std::move(bodies))
    , Tools(this->Body().scene->body, this->Body().at_rest)
  {
  }

  [[nodiscard]] const palpate::SpaceBody& Body() const { return this->Bodies.back(); }

  /// Values at the points of this body as values at the points that are shown.
  /// @param values [components x points]
  template <class Values>
  [[nodiscard]] Eigen::VectorXf OnShownSurface(
    const Values& values, Eigen::Index components, const palpate::Surface& shown) const
  {
    const palpate::BodyId number = this->Body().number;
    const palpate::Surface& own =
      number == palpate::kFirstBody ? shown : this->Shown.surface_of(number);
    Eigen::VectorXf ofSurface(components * static_cast<Eigen::Index>(own.num_points()));
    for (Index p = 0; p < own.num_points(); ++p)
    {
      const Eigen::Index point = own.mesh_points[static_cast<std::size_t>(p)];
      ofSurface.segment(components * p, components) =
        values.segment(components * point, components).template cast<float>();
    }
    if (number == palpate::kFirstBody)
    {
      return ofSurface;
    }
    return this->Shown.carry(number, ofSurface, components);
  }

  /// The first body, and this one where it is another.
  std::vector<palpate::SpaceBody> Bodies;
  palpate::ShownSurface Shown{ this->Bodies };
  /// It is made when it is first shown.
  vtkSmartPointer<vtkUnstructuredGrid> Rest;
  /// The tools that press it.
  palpate::InteractionFactory Tools;
  /// The assembly, which is made when stress is first asked for.
  std::optional<palpate::Assembly> Assembly;

  /// A displacement from the mesh of the scene on, which may sag under a body force.
  [[nodiscard]] palpate::NodalVector FromMesh(const palpate::NodalVector& u) const
  {
    const palpate::NodalVector& rest = this->Body().at_rest.u;
    return rest.size() == 0 ? u : palpate::NodalVector(u + rest);
  }
  [[nodiscard]] palpate::NodalVector WholePressure(const palpate::NodalVector& p) const
  {
    const palpate::NodalVector& rest = this->Body().at_rest.p;
    if (p.size() == 0)
    {
      return rest;
    }
    return rest.size() == p.size() ? palpate::NodalVector(p + rest) : p;
  }
};

/// The branch whose force is nearest to one that was felt, of those on which the place is.
/// @param evaluate Gives the result on a branch.
template <class Evaluate>
int BranchOfForce(const palpate::Vec3& felt, int size, Evaluate&& evaluate)
{
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int branch = 0; branch < size; ++branch)
  {
    const palpate::TouchResult result = evaluate(branch);
    const bool isThere = branch == 0 || result.support == palpate::Support::inside ||
      result.support == palpate::Support::marked;
    const double off = (result.force - felt).norm();
    if (isThere && off < least)
    {
      nearest = branch;
      least = off;
    }
  }
  return nearest;
}
}

/// A tool space that has a weight where the tool is.
struct vtkPalpateTouchStateSpace::Part
{
  const TouchToolSpace* Space = nullptr;
  double Weight = 1;
  /// The force by this tool space alone.
  const palpate::Interpolator* Force = nullptr;
  /// How the whole body is displaced; null: it was not asked for.
  std::unique_ptr<palpate::BodyField>* Field = nullptr;
  /// How the surface is displaced by the modes of an active node; null: a rigid tool has none.
  std::unique_ptr<palpate::DisplayField>* Shown = nullptr;
  WholeBodyOf* Whole = nullptr;
  /// The displacement of every point from rest [3 x points], m, and the pressures of mixed cells,
  /// Pa.
  palpate::NodalVector Displacement;
  palpate::NodalVector Pressure;
};

struct vtkPalpateTouchStateSpace::Prepared
{
  vtkMTimeType InputTime = 0;
  TouchSpace Space;
  vtkNew<vtkCellArray> Triangles;
  /// A branch of a tool space. The parts are made when they are first needed.
  struct Branch
  {
    /// By the number of the method, and whether the error of the mesh is corrected.
    std::map<std::pair<int, bool>, std::unique_ptr<palpate::Interpolator>> Interpolators;
    std::unique_ptr<palpate::DisplayField> Field;
    std::unique_ptr<palpate::BodyField> BodyField;
    std::optional<TouchToolSpace> Space;
  };
  /// The force on the rigid tool, by the number of the method, and whether the error of the mesh is
  /// corrected.
  std::map<std::pair<int, bool>, std::unique_ptr<palpate::ToolForce>> RigidForces;
  /// The same of a tool that is turned.
  std::map<bool, std::unique_ptr<palpate::TurnedForce>> TurnedForces;
  std::map<palpate::ToolSpaceKey, palpate::SolutionBranches> BranchesOfSpace;
  std::map<std::pair<palpate::ToolSpaceKey, int>, Branch> Branches;
  /// The branch that was asked for: its tool space and its number.
  palpate::ToolSpaceKey Key;
  int OnBranch = 0;
  /// Of a space with the stages of a cut: the area that is open, m², and G, J/m².
  std::optional<std::pair<double, double>> Torn;
  /// The torque of a tool that is turned, N m.
  palpate::Vec3 Torque = palpate::Vec3::Zero();
  /// The whole bodies and their fields, as long as they are asked for.
  std::unique_ptr<palpate::FieldCache> Fields;
  std::optional<palpate::SpaceBody> FirstBody;
  /// The space while it is explored around a hand, in this execution and in the last one, with what
  /// was found when it was last asked; null: the input has all. Its field of the whole body is made
  /// when it is first needed.
  std::shared_ptr<palpate::LiveSpace> Live;
  std::weak_ptr<palpate::LiveSpace> LastLive;
  palpate::LiveSpace::State Found;
  std::unique_ptr<palpate::BodyField> LiveField;
  std::map<palpate::BodyId, WholeBodyOf> WholeBodies;
  /// The reason why there is no whole body, as it was reported.
  std::string Problem;

  /// Looks whether the space is explored now, and what was found.
  void FollowExploration()
  {
    this->Live = vtkPalpateFindLiveSpace(this->Space.file);
    if (this->Live != this->LastLive.lock())
    {
      this->ForgetWholeBodies();
      this->LastLive = this->Live;
      this->Found = {};
      this->LiveField.reset();
    }
    if (!this->Live)
    {
      this->Found = {};
      return;
    }
    const std::int64_t before = this->Found.number;
    this->Found = this->Live->newest();
    if (this->Found.number != before)
    {
      this->LiveField.reset();
    }
  }
  void ForgetWholeBodies()
  {
    this->WholeBodies.clear();
    this->FirstBody.reset();
    this->Fields.reset();
  }
  /// Where the fields of configurations come from.
  /// @throws InputError there is no file.
  palpate::FieldSource& FieldsOfSpace()
  {
    if (this->Live)
    {
      return this->Live->fields();
    }
    if (this->Space.file.empty())
    {
      throw palpate::InputError("Stress, the whole body and what a rigid tool does to the surface "
                                "need the displacement of every point, which is kept in a file "
                                "alone: give Precompute State Space a FileName.");
    }
    if (!this->Fields)
    {
      this->Fields =
        std::make_unique<palpate::FieldCache>(this->Space.file, this->Space.scene_hash);
    }
    return *this->Fields;
  }
  WholeBodyOf& FindWholeBody(palpate::BodyId body)
  {
    const auto known = this->WholeBodies.find(body);
    if (known != this->WholeBodies.end())
    {
      return known->second;
    }
    if (!this->FirstBody)
    {
      this->FirstBody =
        this->Live ? this->Live->body() : this->Fields->read_body(palpate::kFirstBody);
    }
    std::vector<palpate::SpaceBody> bodies{ *this->FirstBody };
    if (body != palpate::kFirstBody)
    {
      bodies.push_back(this->Fields->read_body(body));
    }
    return this->WholeBodies.try_emplace(body, std::move(bodies)).first->second;
  }

  /// The branch that the body is on when the tool has come to t.
  /// @param from Where it came from, in a straight line; nothing: from where the body is on branch
  ///   `without` at t.
  /// @param startBranch The branch that it was on there; -1: that to which it comes from rest.
  /// @param branch The branch that it is on at t; -1: to be found.
  /// @throws InputError there is no such branch.
  palpate::OnBranch FindBranch(const TouchToolSpace& toolSpace,
    const palpate::SolutionBranches* branches, const std::optional<palpate::Vec3>& from,
    int startBranch, const palpate::Vec3& t, int branch, int without)
  {
    const int size = branches ? branches->size() : 1;
    for (const int given : { startBranch, branch })
    {
      if (given < -1 || given >= size)
      {
        throw palpate::InputError("There is no branch " + std::to_string(given) + " of " +
          toolSpace.setup.name() + ": it has " + std::to_string(size) +
          ", counted from 0. Choose one of them, or -1, with which the body finds its own.");
      }
    }
    this->Key = toolSpace.setup.key();
    if (branch >= 0 || !branches)
    {
      return { std::max(branch, 0) };
    }
    if (!from)
    {
      return { without };
    }
    if (startBranch < 0)
    {
      // A rigid tool comes from where it touches nothing.
      startBranch = toolSpace.setup.presses() ? 0 : branches->move(0, palpate::Vec3::Zero(), *from);
    }
    return branches->move(palpate::OnBranch{ startBranch }, *from, t);
  }

  /// The part of the tool space that is on a branch.
  const TouchToolSpace& SpaceOnBranch(
    const TouchToolSpace& toolSpace, const palpate::SolutionBranches* branches, int branch)
  {
    if (!branches || branches->size() == 1)
    {
      return toolSpace;
    }
    auto& space = this->Branches[{ toolSpace.setup.key(), branch }].Space;
    if (!space)
    {
      space = palpate::on_branch(toolSpace, *branches, branch);
    }
    return *space;
  }
};

vtkStandardNewMacro(vtkPalpateTouchStateSpace);

vtkPalpateTouchStateSpace::vtkPalpateTouchStateSpace()
  : Display(std::make_unique<vtkPalpateDisplaySurface>())
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(2);
}

vtkPalpateTouchStateSpace::~vtkPalpateTouchStateSpace() = default;

int vtkPalpateTouchStateSpace::FillInputPortInformation(int port, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, port == 0 ? "vtkPartitionedDataSetCollection" : "vtkPolyData");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

int vtkPalpateTouchStateSpace::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkPolyData" : "vtkUnstructuredGrid");
  return 1;
}

void vtkPalpateTouchStateSpace::SetFeltForce(const double* force)
{
  this->FeltForce.reset();
  if (force)
  {
    this->FeltForce = { force[0], force[1], force[2] };
  }
  this->Modified();
}

std::vector<vtkPalpateTouchStateSpace::Part> vtkPalpateTouchStateSpace::FindStages(
  const TouchToolSpace& toolSpace, const double at[3], palpate::TouchResult& touch)
{
  const palpate::Vec3 t(at);
  Prepared& cache = *this->Cache;
  const std::pair<int, bool> how(this->Interpolation, this->CorrectMeshError);
  palpate::InterpolationOptions options;
  options.correct_mesh_error = this->CorrectMeshError;
  for (const auto& [name, value] : { std::pair{ "TornArea", this->TornArea },
         std::pair{ "FractureToughness", this->FractureToughness } })
  {
    if (!(value >= 0) || !std::isfinite(value))
    {
      throw palpate::InputError(std::string(name) + " is " + palpate::quantity(value) +
        ", but must be a number of 0 or more.");
    }
  }
  const std::vector<const TouchToolSpace*> spaces = cache.Space.find_stages(toolSpace.setup.id);
  if (spaces.empty())
  {
    throw palpate::InputError(toolSpace.setup.name() +
      " was not explored at all stages of the cut. Run Precompute State Space on to its end.");
  }
  const palpate::TornEnergy energy(cache.Space.areas_of_stages());
  const auto interpolator = [&](int stage) -> const palpate::Interpolator&
  {
    const TouchToolSpace& of = *spaces[static_cast<std::size_t>(stage)];
    auto& made = cache.Branches[{ of.setup.key(), 0 }].Interpolators[how];
    if (!made)
    {
      made =
        palpate::make_interpolator(static_cast<palpate::Method>(this->Interpolation), of, options);
    }
    return *made;
  };
  const auto atStage = [&](int stage) { return interpolator(stage).evaluate(t); };
  double area = std::min(this->TornArea, energy.whole_area());
  if (this->FractureToughness > 0)
  {
    area = energy.tear(area, this->FractureToughness, energy.whole_area(), atStage);
  }
  const palpate::TornResult result = energy.evaluate(area, atStage);
  touch = result.touch;
  cache.Torn = { area, result.release_rate };
  cache.Key = toolSpace.setup.key();
  cache.OnBranch = 0;
  std::vector<Part> parts;
  const int below = energy.stage_below(area);
  const double share = energy.share_above(area);
  for (const auto& [stage, weight] : { std::pair(below, 1 - share), std::pair(below + 1, share) })
  {
    if (weight > 0)
    {
      const TouchToolSpace* of = spaces[static_cast<std::size_t>(stage)];
      Prepared::Branch& branch = cache.Branches[{ of->setup.key(), 0 }];
      parts.push_back(
        { of, weight, &interpolator(stage), &branch.BodyField, &branch.Field, nullptr });
    }
  }
  std::sort(
    parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.Weight > b.Weight; });
  return parts;
}

std::vector<vtkPalpateTouchStateSpace::Part> vtkPalpateTouchStateSpace::FindOrientations(
  const double at[3], palpate::TouchResult& touch)
{
  Prepared& cache = *this->Cache;
  if (this->Interpolation != ENERGY_HERMITE)
  {
    throw palpate::InputError(
      "Between orientations the energy is interpolated. Choose the Interpolation Energy Hermite.");
  }
  const std::vector<const TouchToolSpace*> spaces = cache.Space.list_turned();
  auto& force = cache.TurnedForces[this->CorrectMeshError];
  if (!force)
  {
    palpate::InterpolationOptions options;
    options.correct_mesh_error = this->CorrectMeshError;
    force = std::make_unique<palpate::TurnedForce>(spaces, options);
  }
  const palpate::Vec3 angles =
    force->turning().angles_of(palpate::orientation_of(this->Orientation()));
  const palpate::TurnedTouch felt = force->evaluate(palpate::Vec3(at), angles);
  touch = felt;
  cache.Torque = felt.torque;
  cache.OnBranch = 0;
  std::vector<Part> parts;
  force->visit_weights(angles,
    [&](std::size_t number, double weight)
    {
      const TouchToolSpace* of = spaces[number];
      parts.push_back({ of, weight, &force->at_orientation(number),
        &cache.Branches[{ of->setup.key(), 0 }].BodyField });
    });
  std::sort(
    parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.Weight > b.Weight; });
  return parts;
}

std::vector<vtkPalpateTouchStateSpace::Part> vtkPalpateTouchStateSpace::FindParts(
  const TouchToolSpace& toolSpace, const double at[3], palpate::TouchResult& touch)
{
  const palpate::Vec3 t(at);
  Prepared& cache = *this->Cache;
  const auto method = static_cast<palpate::Method>(this->Interpolation);
  const std::pair<int, bool> how(this->Interpolation, this->CorrectMeshError);
  palpate::InterpolationOptions options;
  options.correct_mesh_error = this->CorrectMeshError;
  std::vector<Part> parts;
  cache.Torn.reset();
  if (toolSpace.setup.turns())
  {
    return this->FindOrientations(at, touch);
  }
  if (!toolSpace.setup.presses() && !cache.Space.stages.empty())
  {
    return this->FindStages(toolSpace, at, touch);
  }
  if (!toolSpace.setup.presses())
  {
    const palpate::Vec3 start(this->StartDisplacement);
    const palpate::SolutionBranches& branches =
      cache.BranchesOfSpace.try_emplace(toolSpace.setup.key(), toolSpace).first->second;
    const auto interpolator = [&](int branch) -> const palpate::Interpolator&
    {
      auto& made = cache.Branches[{ toolSpace.setup.key(), branch }].Interpolators[how];
      if (!made)
      {
        // The stiffness at rest is that of the branch that rest is on.
        const int of = method == palpate::Method::linear ? 0 : branch;
        made = palpate::make_interpolator(
          method, cache.SpaceOnBranch(toolSpace, &branches, of), options);
      }
      return *made;
    };
    cache.OnBranch =
      cache.FindBranch(toolSpace, &branches, start, this->StartBranch, t, this->Branch, 0).number;
    if (this->FeltForce && branches.size() > 1)
    {
      cache.OnBranch = BranchOfForce(palpate::Vec3(this->FeltForce->data()), branches.size(),
        [&](int branch) { return interpolator(branch).evaluate(t); });
    }
    touch = interpolator(cache.OnBranch).evaluate(t);
    parts.push_back({ &cache.SpaceOnBranch(toolSpace, &branches, cache.OnBranch), 1,
      &interpolator(cache.OnBranch), &cache.Branches[{ cache.Key, cache.OnBranch }].BodyField,
      &cache.Branches[{ cache.Key, cache.OnBranch }].Field, nullptr });
    return parts;
  }
  std::optional<palpate::Vec3> start;
  if (this->FromStart)
  {
    start = palpate::Vec3(this->StartToolPosition);
  }
  const auto findBranch = [&](const TouchToolSpace& of, const palpate::ToolForce& force)
  {
    palpate::OnBranch branch = cache.FindBranch(of, force.branches(), start, this->StartBranch, t,
      this->Branch, force.branch_from_outside(t));
    if (this->FeltForce && force.num_branches() > 1)
    {
      branch = { BranchOfForce(palpate::Vec3(this->FeltForce->data()), force.num_branches(),
        [&](int number) { return force.evaluate(t, palpate::OnBranch{ number }); }) };
    }
    cache.OnBranch = branch.number;
    touch = force.evaluate(t, branch);
  };
  if (cache.Found.force)
  {
    findBranch(*cache.Found.tool_space, *cache.Found.force);
    parts.push_back({ cache.Found.tool_space.get(), 1, &cache.Found.force->part(0),
      &cache.LiveField, nullptr, nullptr });
    return parts;
  }
  const std::vector<const TouchToolSpace*> pressing = cache.Space.list_pressing();
  auto& force = cache.RigidForces[how];
  if (!force)
  {
    force = std::make_unique<palpate::ToolForce>(pressing, method, options);
  }
  findBranch(*pressing.front(), *force);
  if (force->num_branches() > 1)
  {
    parts.push_back({ &cache.SpaceOnBranch(*pressing.front(), force->branches(), cache.OnBranch), 1,
      &force->on(cache.OnBranch),
      &cache.Branches[{ pressing.front()->setup.key(), cache.OnBranch }].BodyField, nullptr,
      nullptr });
    return parts;
  }
  force->visit_weights(t,
    [&](std::size_t number, double weight)
    {
      const TouchToolSpace* of = pressing[number];
      parts.push_back({ of, weight, &force->part(number),
        &cache.Branches[{ of->setup.key(), 0 }].BodyField, nullptr, nullptr });
    });
  if (parts.empty())
  {
    // The place is not finite.
    parts.push_back({ pressing.front(), 1, &force->part(0),
      &cache.Branches[{ pressing.front()->setup.key(), 0 }].BodyField, nullptr, nullptr });
  }
  std::sort(
    parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.Weight > b.Weight; });
  return parts;
}

void vtkPalpateTouchStateSpace::FindWholeBody(Part& part, const double t[3])
{
  Prepared& cache = *this->Cache;
  const palpate::ToolSpaceSetup& setup = part.Space->setup;
  if (this->Stress && setup.body != palpate::kFirstBody)
  {
    throw palpate::InputError("Stress is shown where the first body of a space is touched, and " +
      setup.name() + " is on another one. Turn Stress off" +
      (setup.region ? "." : ", or set BodyNumber to 1."));
  }
  palpate::FieldSource& fields = cache.FieldsOfSpace();
  part.Whole = &cache.FindWholeBody(setup.body);
  auto& field = *part.Field;
  if (!field)
  {
    field = setup.presses() ? std::make_unique<palpate::BodyField>(*part.Space, part.Force->grid())
                            : std::make_unique<palpate::BodyField>(*part.Space);
  }
  const palpate::Keep needed = this->WholeBody ? palpate::Keep::all
    : this->Stress                             ? palpate::Keep::surface
                                               : palpate::Keep::touch;
  const palpate::NearStates* near = cache.Found.force ? cache.Found.force->near_states() : nullptr;
  field->evaluate(palpate::Vec3(t), fields, needed, part.Displacement, part.Pressure, near);
  if (part.Displacement.size() == 0)
  {
    part.Displacement.setZero(
      3 * static_cast<Eigen::Index>(part.Whole->Body().mesh().num_points()));
  }
}

void vtkPalpateTouchStateSpace::AddContact(const std::vector<Part>& parts, const double t[3],
  const palpate::TouchResult& touch, vtkPolyData* surface)
{
  const palpate::Surface& shown = this->Cache->Space.surface;
  Eigen::VectorXf pressures = Eigen::VectorXf::Zero(static_cast<Eigen::Index>(shown.num_points()));
  double area = 0;
  double layerDepth = 0;
  double meshError = 0;
  for (const Part& part : parts)
  {
    const palpate::RigidContact& contact =
      part.Whole->Tools.contact(part.Space->setup.interaction.tool);
    const palpate::RigidContact::Patch patch =
      contact.patch(contact.coordinates(palpate::Vec3(t)), part.Whole->FromMesh(part.Displacement));
    pressures += static_cast<float>(part.Weight) *
      part.Whole->OnShownSurface(Eigen::Map<const Eigen::VectorXd>(patch.pressure.data(),
                                   static_cast<Eigen::Index>(patch.pressure.size())),
        1, shown);
    area += part.Weight * patch.area;
    layerDepth += part.Weight * patch.layer_depth;
    meshError += part.Weight *
      palpate::expected_mesh_error(part.Whole->Body().mesh().order, patch.longest_edge, patch.area);
  }
  vtkNew<vtkDoubleArray> pressure;
  pressure->SetName(vtkPalpateArray::ContactPressure);
  for (const float value : pressures)
  {
    pressure->InsertNextValue(value);
  }
  surface->GetPointData()->AddArray(pressure);
  AddVector(surface, "ContactArea", 1, &area);
  const double layerForce = palpate::contact_layer_force(layerDepth, touch.force, touch.stiffness);
  AddVector(surface, "ContactLayerForce", 1, &layerForce);
  AddVector(surface, "ContactMeshError", 1, &meshError);
}

void vtkPalpateTouchStateSpace::AddWholeBody(
  const std::vector<Part>& parts, vtkPolyData* surface, vtkUnstructuredGrid* body)
{
  WholeBodyOf& whole = *parts.front().Whole;
  // Regions have meshes of their own, of which that of the most weight is shown. Orientations have
  // one.
  palpate::NodalVector fromRest = parts.front().Displacement;
  palpate::NodalVector pressure = parts.front().Pressure;
  if (parts.front().Space->setup.turns())
  {
    fromRest.setZero();
    pressure.setZero();
    for (const Part& part : parts)
    {
      fromRest += part.Weight * part.Displacement;
      if (part.Pressure.size() == pressure.size())
      {
        pressure += part.Weight * part.Pressure;
      }
    }
  }
  const palpate::NodalVector u = whole.FromMesh(fromRest);
  const palpate::TetMesh& mesh = whole.Body().mesh();
  if (this->WholeBody)
  {
    if (!whole.Rest)
    {
      whole.Rest = vtkPalpateGridFromScene(*whole.Body().scene, whole.Body().at_rest);
    }
    body->ShallowCopy(whole.Rest);
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(mesh.num_points());
    for (Index point = 0; point < mesh.num_points(); ++point)
    {
      const palpate::Vec3 place = mesh.points[point] + u.segment<3>(3 * point);
      points->SetPoint(point, place.data());
    }
    body->SetPoints(points);
    body->GetPointData()->AddArray(vtkPalpateNodalArray(vtkPalpateArray::Displacement, fromRest));
    body->GetPointData()->SetActiveVectors(vtkPalpateArray::Displacement);
  }
  if (this->Stress)
  {
    if (!whole.Assembly)
    {
      whole.Assembly.emplace(*whole.Body().scene);
    }
    const palpate::BodyStress stress =
      palpate::find_stress(*whole.Assembly, mesh, u, whole.WholePressure(pressure));
    vtkPalpateAddStress(
      stress.at_points, surface->GetPointData(), &this->Cache->Space.surface.mesh_points);
    if (this->WholeBody)
    {
      vtkPalpateAddStress(stress.of_cells, body->GetCellData());
      vtkPalpateAddStress(stress.at_points, body->GetPointData());
    }
  }
}

int vtkPalpateTouchStateSpace::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkPolyData::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  bool isWhole = true;
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&](palpate::Communicator& ranks)
    {
      auto* input = vtkPalpateInput<vtkPartitionedDataSetCollection>(inputVector[0]);
      // Decided together: where rank 0 alone meets an error, the others must not wait for it.
      if (palpate::any(ranks, vtkPalpatePassFailure(input, output)))
      {
        return;
      }
      if (palpate::any(ranks, !this->Cache || this->Cache->InputTime != input->GetMTime()))
      {
        this->Cache.reset();
        auto prepared = std::make_unique<Prepared>();
        prepared->Space = vtkPalpateSpaceFromCollection(input, controller);
        for (const auto& [a, b, c] : prepared->Space.surface.triangles)
        {
          prepared->Triangles->InsertNextCell({ a, b, c });
        }
        prepared->InputTime = input->GetMTime();
        this->Cache = std::move(prepared);
      }
      this->Display->Take(this, inputVector[1], this->Cache->InputTime, controller, ranks,
        [&] { return vtkPalpateCarrierOfSpace(this->Cache->Space, input); });
      bool isHere = true;
      palpate::agree(ranks,
        [&]
        {
          if (ranks.rank() == 0)
          {
            isHere = this->Touch(output, vtkUnstructuredGrid::GetData(outputVector, 1));
          }
        });
      isWhole = !palpate::any(ranks, !isHere);
    });
  if (this->ErrorCode == vtkErrorCode::NoError && !isWhole)
  {
    this->ErrorCode = vtkErrorCode::UserError;
  }
  return 1;
}

bool vtkPalpateTouchStateSpace::Touch(vtkPolyData* output, vtkUnstructuredGrid* wholeBody)
{
  this->Cache->FollowExploration();
  // Whoever explores ends that when it likes.
  struct LetGo
  {
    ~LetGo() { this->Of.Live.reset(); }
    Prepared& Of;
  } const letGo{ *this->Cache };
  const TouchSpace& space = this->Cache->Space;
  const TouchToolSpace& toolSpace = SiteOf(space, this->ActiveNode, this->BodyNumber);
  const bool presses = toolSpace.setup.presses();
  const bool hasRigidTool = space.find_pressing() != nullptr || !space.list_turned().empty();
  const palpate::Vec3 t(presses ? this->ToolPosition : this->Displacement);
  if (presses && !toolSpace.setup.turns())
  {
    // An orientation that the tool cannot have is refused.
    palpate::RigidTool tool = toolSpace.setup.interaction.tool;
    palpate::turn(tool, this->Orientation());
  }
  palpate::TouchResult touch;
  std::vector<Part> parts = this->FindParts(toolSpace, t.data(), touch);
  const Part& leading = parts.front();

  const bool needsBody = presses || this->Stress || this->WholeBody;
  std::string problem;
  if (!needsBody)
  {
    this->Cache->ForgetWholeBodies();
  }
  // Touching goes on without this part. As there are many frames a second, the failure is reported
  // once.
  const auto tryWith = [&](auto&& part)
  {
    try
    {
      if (needsBody && problem.empty())
      {
        palpate::with_memory("to find the displacement inside the body", part);
      }
    }
    catch (const std::exception& error)
    {
      problem = error.what();
    }
  };
  tryWith(
    [&]
    {
      for (Part& part : parts)
      {
        this->FindWholeBody(part, t.data());
      }
    });

  const palpate::Surface& surface = space.surface;
  Eigen::VectorXf u = Eigen::VectorXf::Zero(3 * static_cast<Eigen::Index>(surface.num_points()));
  if (!presses)
  {
    for (const Part& part : parts)
    {
      auto& field = *part.Shown;
      if (!field)
      {
        field = std::make_unique<palpate::DisplayField>(*part.Space);
      }
      if (touch.support != palpate::Support::none)
      {
        // The modes are those of all branches.
        u += static_cast<float>(part.Weight) *
          BySurfaceModes(*space.find(part.Space->setup.key()), *field, t);
      }
    }
  }
  else if (problem.empty())
  {
    for (const Part& part : parts)
    {
      u +=
        static_cast<float>(part.Weight) * part.Whole->OnShownSurface(part.Displacement, 3, surface);
    }
  }
  vtkPalpateShowDisplaced(surface, this->Cache->Triangles, u, output);

  AddVector(output, "Force", 3, touch.force.data());
  AddVector(output, "Stiffness", 9, touch.stiffness.data());
  AddVector(output, "Energy", 1, &touch.energy);
  AddInteger(output, "Found", static_cast<int>(touch.support));
  AddInteger(output, "Outcome",
    static_cast<int>(palpate::outcome_at(leading.Force->grid(), leading.Space->configurations, t)));
  if (const palpate::TouchMeshError& error = touch.mesh_error;
      error.trust != palpate::MeshErrorTrust::none)
  {
    AddVector(output, "MeshError", 3, error.force.data());
    AddVector(output, "MeshErrorBound", 1, &error.bound);
    AddInteger(output, "MeshErrorReliable", error.trust == palpate::MeshErrorTrust::reliable);
    AddInteger(output, "MeshErrorCorrected", error.is_corrected);
  }
  if (const auto& torn = this->Cache->Torn)
  {
    AddVector(output, "TornArea", 1, &torn->first);
    AddVector(output, "ReleaseRate", 1, &torn->second);
  }
  if (presses)
  {
    AddVector(output, "ToolPosition", 3, t.data());
    if (toolSpace.setup.turns())
    {
      AddVector(output, "ToolOrientation", 4, this->ToolOrientation);
      AddVector(output, "Torque", 3, this->Cache->Torque.data());
    }
    else if (const auto torque =
               palpate::torque_of(toolSpace.setup.interaction.tool, t, touch.force))
    {
      AddVector(output, "Torque", 3, torque->data());
    }
    AddInteger(output, "Branch", this->Cache->OnBranch);
  }
  else
  {
    const palpate::Vec3 position = toolSpace.setup.interaction.material_point + t;
    AddVector(output, "ActivePosition", 3, position.data());
    AddInteger(output, "Branch", this->Cache->OnBranch);
    vtkNew<vtkIdTypeArray> active;
    active->SetName("ActiveNode");
    active->InsertNextValue(toolSpace.setup.interaction.active_node);
    output->GetFieldData()->AddArray(active);
    if (hasRigidTool)
    {
      // Nothing is pressed: what colours the surface by it goes on.
      vtkNew<vtkDoubleArray> pressure;
      pressure->SetName(vtkPalpateArray::ContactPressure);
      pressure->SetNumberOfTuples(surface.num_points());
      pressure->Fill(0);
      output->GetPointData()->AddArray(pressure);
    }
  }
  tryWith(
    [&]
    {
      if (presses)
      {
        this->AddContact(parts, t.data(), touch, output);
      }
      this->AddWholeBody(parts, output, wholeBody);
    });
  if (this->Display->IsGiven())
  {
    this->Display->Follow(output);
  }
  if (std::exchange(this->Cache->Problem, problem) != problem && !problem.empty())
  {
    vtkErrorMacro(<< palpate::printable_message(problem));
  }
  return problem.empty();
}

void vtkPalpateTouchStateSpace::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ActiveNode: " << this->ActiveNode << '\n'
     << indent << "BodyNumber: " << this->BodyNumber << '\n'
     << indent << "Displacement: " << this->Displacement[0] << ' ' << this->Displacement[1] << ' '
     << this->Displacement[2] << '\n'
     << indent << "ToolPosition: " << this->ToolPosition[0] << ' ' << this->ToolPosition[1] << ' '
     << this->ToolPosition[2] << '\n'
     << indent << "ToolOrientation: " << this->ToolOrientation[0] << ' ' << this->ToolOrientation[1]
     << ' ' << this->ToolOrientation[2] << ' ' << this->ToolOrientation[3] << '\n'
     << indent << "FromStart: " << this->FromStart << '\n'
     << indent << "StartToolPosition: " << this->StartToolPosition[0] << ' '
     << this->StartToolPosition[1] << ' ' << this->StartToolPosition[2] << '\n'
     << indent << "StartDisplacement: " << this->StartDisplacement[0] << ' '
     << this->StartDisplacement[1] << ' ' << this->StartDisplacement[2] << '\n'
     << indent << "StartBranch: " << this->StartBranch << '\n'
     << indent << "Branch: " << this->Branch << '\n'
     << indent << "TornArea: " << this->TornArea << " m^2\n"
     << indent << "FractureToughness: " << this->FractureToughness << " J/m^2\n"
     << indent << "Interpolation: " << this->Interpolation << '\n'
     << indent << "CorrectMeshError: " << this->CorrectMeshError << '\n'
     << indent << "Stress: " << this->Stress << '\n'
     << indent << "WholeBody: " << this->WholeBody << '\n';
}
