// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpatePrecomputeStateSpace.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <utility>

#include "base/content_hash.h"
#include "base/error.h"
#include "cutting/opened_scene.h"
#include "exploration/precompute.h"
#include "exploration/region_bodies.h"
#include "following/begin_following.h"
#include "storage/state_space_file.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateActiveNodes.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateEstimate.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFollowing.h"
#include "vtkPalpateGrowth.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateProgress.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateSceneToEstimate.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPalpateWholeSurface.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

namespace
{
/// The key of everything that a state space depends on.
/// @param region The region of the tool; null: there is none.
/// @param meshes What the properties ask of the meshes of regions. @param cutStages Which stages of
///   a cut they ask for.
std::string KeyOf(const palpate::Scene& scene, const palpate::PrecomputeOptions& options,
  vtkImplicitFunction* region, const palpate::RegionOptions& meshes, int cutStages)
{
  palpate::ContentHash key;
  key.add(meshes.tolerance).add(meshes.size).add(meshes.max_cells).add(cutStages);
  key.add(palpate::hash(scene)).add(scene.body.touchable).add(options.active_nodes);
  key.add(options.tip_radius).add(options.half_width).add(options.resolution);
  key.add(options.tolerance).add(options.tolerance_is_relative).add(options.force_limit);
  key.add(options.history).add(options.intermediate_states).add(options.estimate_mesh_error);
  key.add(options.touch_bound).add(options.keep).add(options.file.string());
  const palpate::EquilibriumOptions& equilibrium = options.equilibrium;
  key.add(equilibrium.third_derivatives).add(equilibrium.tolerance);
  key.add(equilibrium.max_seconds).add(equilibrium.single_precision);
  key.add(options.ranks_per_solve);
  if (options.contact)
  {
    const auto& [tool, spacing, shell, turnSpacing, most] = *options.contact;
    key.add(tool.shape).add(tool.radius).add(tool.axis).add(tool.length);
    key.add(tool.points).add(tool.triangles).add(tool.motion).add(tool.motion_numbers);
    key.add(turnSpacing);
    key.add(tool.law.thickness).add(tool.law.stiffness).add(tool.law.offset);
    key.add(spacing).add(shell.depth).add(shell.begin_at).add(most);
    // A function may be evaluated anywhere, so that its values at some places do not tell it from
    // others.
    key.add(region ? region->GetMTime() : vtkMTimeType(0));
  }
  return key.text();
}

std::string ToText(const palpate::ExplorationEstimate& estimate)
{
  std::string text = "About " +
    vtkPalpateTellNumber(static_cast<double>(estimate.num_configurations)) + " configurations of " +
    vtkPalpateTellNumber(estimate.num_unknowns) + " unknowns";
  if (estimate.num_free > 0)
  {
    text += ", and " + vtkPalpateTellNumber(static_cast<double>(estimate.num_free)) +
      " places where the tool touches nothing";
  }
  return text + ". They take " + vtkPalpateTellSeconds(estimate.seconds) + ", " +
    vtkPalpateTellBytes(estimate.bytes_per_rank) + " of memory a rank and " +
    vtkPalpateTellBytes(estimate.file_bytes) + " of disk until it is complete, if there is a file.";
}

/// What an estimate of the whole space says of one that is explored around the hand.
constexpr const char* AroundTheHand =
  "One configuration is solved for now, the others around the hand while you touch. All of them "
  "would be: ";

/// What an estimate for the mesh that is given does not say.
constexpr const char* OnFinerMeshes =
  " That is for the mesh as it is given. The meshes of the regions are made first, and are finer: "
  "what they take is told then.";

/// The time that the window has for itself between two executions of a space that grows. It asks
/// every second, and makes up at once for questions that it could not ask meanwhile.
constexpr std::chrono::seconds TimeForWindow(1);

/// Check-points along an axis that a space with a tolerance begins with: the fewest that its errors
/// can be estimated from.
constexpr int CoarsestResolution = 5;

/// Whether an exploration can be kept from one execution to the next: the communicator of a single
/// rank needs no other rank to end with it.
bool CanBeKept(const palpate::PrecomputeOptions& options, const palpate::Communicator& communicator)
{
  const bool hasBoth = options.contact && !options.active_nodes.empty();
  return communicator.size() == 1 && !hasBoth;
}

/// A text that counts the configurations which are not as they should be; empty if all are.
std::string Doubts(const palpate::PrecomputeReport& report)
{
  std::string text;
  const auto add = [&](std::int64_t count, const std::string& what)
  { text += (text.empty() ? "" : ", ") + std::to_string(count) + ' ' + what; };
  for (const auto& [outcome, count] : report.num_by_outcome)
  {
    if (outcome != palpate::Outcome::converged)
    {
      add(count, palpate::to_string(outcome));
    }
  }
  namespace flags = palpate::flags;
  for (const auto& [flag, count] : report.num_by_flag)
  {
    if (flag != flags::beyond_force_limit && flag != flags::inertia_not_computed &&
      flag != flags::touches_nothing)
    {
      add(count, palpate::flags_to_string(flag));
    }
  }
  return text;
}

/// @param meshSeconds The time in which the meshes of regions were made, s.
void AddReport(const palpate::PrecomputeReport& report, double meshSeconds, vtkFieldData* fields)
{
  const auto add = [&](const char* name, double value)
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->InsertNextValue(value);
    fields->AddArray(array);
  };
  const palpate::Work& work = report.work;
  const auto mean = [](double seconds, long count) { return count > 0 ? seconds / count : 0; };
  add("Ranks", report.num_ranks);
  add("Cells", report.num_cells);
  add("Unknowns", report.num_unknowns);
  add("Shares", static_cast<double>(report.schedule.steals_granted));
  add("IdleSeconds", report.schedule.idle_seconds);
  add("Solved", static_cast<double>(report.num_solved));
  add("Reused", static_cast<double>(report.num_reused));
  add("Rounds", report.num_rounds);
  add("NotReached", static_cast<double>(report.num_not_reached));
  add("LevelTransitions", static_cast<double>(report.num_transitions));
  add("Levels", static_cast<double>(report.num_levels));
  add("BeyondMostLevels", static_cast<double>(report.num_beyond_most_levels));
  add("IntermediateStatesSolved", static_cast<double>(report.num_intermediate_states));
  add("IntermediateStatesFailed", static_cast<double>(report.num_intermediate_states_failed));
  add("IntermediateStatesSeconds", report.intermediate_seconds);
  add("ExplorationSeconds", report.exploration_seconds);
  add("FinishingSeconds", report.finishing_seconds);
  add("AssemblySeconds", mean(work.assembly_seconds, work.assemblies));
  add("FactorisationSeconds", mean(work.factorisation_seconds, work.factorisations));
  add("SolveSeconds", mean(work.solve_seconds, work.right_hand_sides));
  add("FloorSeconds", work.floor_seconds());
  add("MeshSeconds", meshSeconds);
}
}

struct vtkPalpatePrecomputeStateSpace::Growth
{
  Growth(const std::vector<palpate::BodyOfRun>& bodies, const palpate::PrecomputeOptions& options,
    std::string of)
    : Of(std::move(of))
    , Communicator(palpate::make_serial_communicator())
    , Session(palpate::begin_exploration(bodies, options, *this->Communicator,
        [this](const palpate::ProgressState& state) { return this->Tell(state); }))
  {
  }

  /// Goes on for an interval, in which something is found however short it is.
  /// @param tell The progress of this execution.
  palpate::PrecomputeResult GoOn(double interval, palpate::Progress tell)
  {
    this->Tell = std::move(tell);
    const auto begin = std::chrono::steady_clock::now();
    std::int64_t numBefore = -1;
    const auto isDue = [&](const palpate::ProgressState& state)
    {
      numBefore = numBefore < 0 ? state.num_solved : numBefore;
      const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin;
      return since.count() >= interval && state.num_solved > numBefore;
    };
    const bool isPaused = this->Session->run(isDue) == palpate::ExplorationSession::State::paused;
    palpate::PrecomputeResult result =
      isPaused ? this->Session->publish() : this->Session->finish();
    palpate::combine(result.report, *this->Communicator);
    return result;
  }

  std::string Of;
  palpate::Progress Tell = [](const palpate::ProgressState&) { return true; };
  std::unique_ptr<palpate::Communicator> Communicator;
  std::unique_ptr<palpate::ExplorationSession> Session;
};

vtkStandardNewMacro(vtkPalpatePrecomputeStateSpace);

vtkPalpatePrecomputeStateSpace::vtkPalpatePrecomputeStateSpace() = default;

vtkPalpatePrecomputeStateSpace::~vtkPalpatePrecomputeStateSpace()
{
  vtkPalpateStopGrowing(this);
}

bool vtkPalpatePrecomputeStateSpace::GetNeedsUpdate()
{
  const auto since = std::chrono::steady_clock::now() - this->LastEnd;
  if (!vtkPalpateGrows(this) || since < TimeForWindow)
  {
    return false;
  }
  vtkPalpateGoOn();
  return true;
}

void vtkPalpatePrecomputeStateSpace::SetToolRegion(vtkImplicitFunction* region)
{
  if (this->ToolRegion != region)
  {
    this->ToolRegion = region;
    this->Modified();
  }
}

vtkImplicitFunction* vtkPalpatePrecomputeStateSpace::GetToolRegion()
{
  return this->ToolRegion;
}

vtkMTimeType vtkPalpatePrecomputeStateSpace::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->ToolRegion ? std::max(own, this->ToolRegion->GetMTime()) : own;
}

palpate::ContactOptions vtkPalpatePrecomputeStateSpace::Contact(vtkPolyData* surface)
{
  palpate::ContactOptions contact;
  contact.tool = this->Tool->Describe(surface);
  contact.spacing = this->Spacing;
  contact.turn_spacing = this->TurnSpacing * M_PI / 180;
  contact.shell.depth = this->Depth;
  contact.shell.begin_at = palpate::Vec3(this->BeginAt);
  contact.most_configurations = this->MaximumConfigurations;
  if (this->UseToolRegion && this->ToolRegion)
  {
    contact.shell.region = [region = this->ToolRegion](const palpate::Vec3& place)
    { return region->FunctionValue(place.data()) <= 0; };
  }
  return contact;
}

palpate::PrecomputeOptions vtkPalpatePrecomputeStateSpace::Options(
  vtkPolyData* surface, vtkMultiProcessController* controller)
{
  palpate::PrecomputeOptions options;
  const bool isRigid = this->Tool != nullptr;
  if (isRigid && this->Graspable && this->ActiveNodes.empty())
  {
    throw palpate::InputError("The rigid tool is to grasp active nodes, but none is named. Name "
                              "some as ActiveNodes, or set Graspable to 0.");
  }
  if (!isRigid || this->Graspable)
  {
    options.active_nodes = vtkPalpateActiveNodes(this->ActiveNodes);
  }
  options.tip_radius = this->TipRadius;
  options.half_width = this->HalfWidth;
  options.resolution = this->Tolerance > 0 ? CoarsestResolution : this->Resolution;
  options.tolerance = this->Tolerance;
  options.tolerance_is_relative = this->ToleranceType == RELATIVE;
  options.force_limit = this->ForceLimit;
  options.history = static_cast<palpate::History>(this->History);
  options.intermediate_states = this->IntermediateStates;
  options.equilibrium.third_derivatives = this->ThirdDerivatives;
  options.estimate_mesh_error = this->EstimateMeshError || this->MeshTolerance > 0;
  options.file = this->FileName;
  options.keep = static_cast<palpate::Keep>(this->Keep);
  options.touch_bound = this->DisplacementBound;
  options.equilibrium.tolerance = this->SolverTolerance;
  options.equilibrium.max_seconds = this->MaximumSeconds;
  options.equilibrium.single_precision = this->SinglePrecisionFactors;
  options.ranks_per_solve = this->RanksPerSolve;
  options.equilibrium.threads = this->Threads;
  if (isRigid)
  {
    options.contact = this->Contact(
      vtkPalpateShareSurface(vtkPalpateGatherSurface(surface, controller), controller));
  }
  return options;
}

void vtkPalpatePrecomputeStateSpace::UpdateEstimate()
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->Estimate = vtkPalpateEstimate(controller,
    [&]
    {
      const auto scene = vtkPalpateSceneToEstimate(
        { vtkPointSet::SafeDownCast(this->GetInputDataObject(BodyPort, 0)) }, controller,
        palpate::Vec3(this->BodyForce));
      const palpate::PrecomputeOptions options = this->Options(
        vtkPolyData::SafeDownCast(this->GetInputDataObject(SurfacePort, 0)), controller);
      const auto communicator = vtkPalpateCommunicator(controller);
      const int threads = palpate::num_threads(*communicator, this->Threads);
      if (!scene)
      {
        return std::string();
      }
      const std::string whole = ToText(palpate::estimate_exploration(
        *scene, options, this->Cost.Of(*scene, threads), communicator->size()));
      return (this->Exploration == AROUND_THE_HAND ? AroundTheHand : std::string()) + whole +
        (this->MeshTolerance > 0 ? OnFinerMeshes : "");
    });
}

std::vector<palpate::BodyOfRun> vtkPalpatePrecomputeStateSpace::BodiesOfRun(
  const std::shared_ptr<const palpate::Scene>& scene, const palpate::PrecomputeOptions& options,
  palpate::Communicator& communicator)
{
  this->MeshSeconds = 0;
  if (this->HasStages(*scene))
  {
    return this->Stages(*scene, options);
  }
  if (this->MeshTolerance == 0)
  {
    return { { scene, options.active_nodes } };
  }
  const auto begin = std::chrono::steady_clock::now();
  auto told = begin;
  const auto tell = [&](std::size_t made, std::size_t all)
  {
    if (communicator.rank() == 0)
    {
      const std::string text =
        "Meshes of regions: " + std::to_string(made) + " of " + std::to_string(all);
      this->SetProgressText(text.c_str());
      this->UpdateProgress(0);
      const std::chrono::duration<double> since = std::chrono::steady_clock::now() - told;
      if (this->LogInterval > 0 && since.count() > this->LogInterval)
      {
        std::cerr << "Precompute State Space: " << text << std::endl;
        told = std::chrono::steady_clock::now();
      }
    }
    return this->GetAbortExecute() == 0;
  };
  palpate::DividedOrgan organ = palpate::divide_organ(scene, options,
    { this->MeshTolerance, this->RegionSize, this->MaximumCells }, communicator, tell);
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin;
  this->MeshSeconds = since.count();
  if (communicator.rank() == 0)
  {
    if (this->LogInterval > 0 && this->MeshSeconds > this->LogInterval)
    {
      const auto [least, most] = std::minmax_element(organ.meshes.begin(), organ.meshes.end(),
        [](const auto& a, const auto& b) { return a.num_cells < b.num_cells; });
      std::cerr << "Precompute State Space: " << organ.meshes.size() << " meshes of "
                << least->num_cells << " to " << most->num_cells << " cells took "
                << vtkPalpateTellSeconds(this->MeshSeconds) << '.' << std::endl;
    }
    this->WarnOf(organ.meshes);
  }
  return std::move(organ.bodies);
}

bool vtkPalpatePrecomputeStateSpace::HasStages(const palpate::Scene& scene) const
{
  const palpate::Cut& cut = scene.body.cut;
  return this->CutStages == ALL_STAGES && !cut.faces.empty() && cut.stage == 0;
}

std::vector<palpate::BodyOfRun> vtkPalpatePrecomputeStateSpace::Stages(
  const palpate::Scene& scene, const palpate::PrecomputeOptions& options) const
{
  if (this->MeshTolerance > 0)
  {
    throw palpate::InputError(
      "MeshTolerance is set, but the body has a cut, whose stages need one mesh. Refine the mesh "
      "before Place Cut, and set MeshTolerance to 0.");
  }
  if (options.contact)
  {
    throw palpate::InputError(
      "The body has a cut, and the tool is rigid: it is not known yet how a "
      "cut opens under a rigid tool. Choose the tool Bonded Node, or set "
      "CutStages to This Stage, for which the cut stays as it is.");
  }
  if (scene.has_load())
  {
    throw palpate::InputError(
      "The body has a cut and a load, under which each stage of the cut rests "
      "elsewhere, so that their energies cannot be compared. Take the load "
      "away (BodyForce, or that of Set Boundary), or set CutStages to This "
      "Stage.");
  }
  if (this->Exploration != WHOLE_SPACE)
  {
    throw palpate::InputError("The stages of a cut are explored as a whole only. Set Exploration "
                              "to Whole Space, or CutStages to This Stage.");
  }
  std::vector<palpate::Index> nodes = options.active_nodes;
  // Points that the cut doubles are no nodes of their own.
  const palpate::Body& body = scene.body;
  for (palpate::Index p = 0; options.active_nodes.empty() && p < body.mesh.num_points(); ++p)
  {
    if (body.touchable[p] != 0 && body.fixed[p] == 0)
    {
      nodes.push_back(p);
    }
  }
  std::vector<palpate::BodyOfRun> bodies;
  for (palpate::Scene& stage : palpate::open_stages(scene))
  {
    bodies.push_back({ std::make_shared<const palpate::Scene>(std::move(stage)), nodes });
  }
  return bodies;
}

void vtkPalpatePrecomputeStateSpace::WarnOf(const std::vector<palpate::RegionMesh>& meshes)
{
  std::size_t number = 0;
  double largest = 0;
  bool isKnown = true;
  bool isFull = false;
  for (const palpate::RegionMesh& mesh : meshes)
  {
    if (mesh.was_in_file || mesh.end == palpate::AdaptationEnd::reached)
    {
      continue;
    }
    ++number;
    isKnown = isKnown && mesh.is_known;
    isFull = isFull || mesh.end == palpate::AdaptationEnd::too_many_cells;
    largest = std::fmax(largest, mesh.error);
  }
  if (number == 0)
  {
    return;
  }
  std::ostringstream text;
  text.precision(2);
  text << number << " of " << meshes.size()
       << " meshes are not as fine as MeshTolerance asks: the error of a force may be "
       << 100 * largest << " %" << (isKnown ? "" : ", and is not known at some place") << ". "
       << (isFull ? "Raise MaximumCells or MeshTolerance. " : "")
       << "Configurations tell their own error (MeshError, MeshErrorReliable).";
  vtkPalpateWarn(this, text.str());
}

void vtkPalpatePrecomputeStateSpace::BeginFollowing(std::shared_ptr<const palpate::Scene> scene,
  const palpate::PrecomputeOptions& options, palpate::Communicator& communicator,
  vtkPartitionedDataSetCollection* output)
{
  constexpr const char* orWhole = ", or set Exploration to Whole Space.";
  if (!options.contact || !options.active_nodes.empty())
  {
    throw palpate::InputError(
      std::string("A space is explored around the hand for a rigid tool alone. Choose one as Tool "
                  "and set Graspable to 0") +
      orWhole);
  }
  if (this->MeshTolerance > 0)
  {
    throw palpate::InputError(
      std::string("Meshes of regions are made before the body is touched. Set MeshTolerance to 0") +
      orWhole);
  }
  if (this->FileName.empty())
  {
    throw palpate::InputError(
      std::string("What is found around the hand is kept in a file. Set FileName") + orWhole);
  }
  if (const auto explored = vtkPalpateFindLiveSpace(this->FileName))
  {
    if (explored->body().hash != palpate::hash(*scene))
    {
      throw palpate::InputError(
        "FileName has the space of the body as it was, which is being touched. Give the body as "
        "it is now another file, and press Apply again.");
    }
    // Who touches it goes on with what this execution begins.
    explored->end();
    vtkPalpateSetLiveSpace(this->FileName, nullptr);
  }
  palpate::agree(communicator,
    [&]
    {
      if (communicator.rank() != 0)
      {
        return;
      }
      palpate::BegunSpace begun = palpate::begin_following(scene, options,
        [this]
        {
          this->UpdateProgress(0);
          return this->GetAbortExecute() != 0;
        });
      vtkPalpateFillCollection({ begun.body }, std::move(begun.space), output);
      for (const auto& configurations : vtkPalpateConfigurations(output))
      {
        vtkPalpateAddFile(this->FileName, false, configurations->GetFieldData());
        output->GetFieldData()->ShallowCopy(configurations->GetFieldData());
      }
      auto following = std::make_shared<vtkPalpateFollowing>();
      following->Scene = std::move(scene);
      following->Options = options;
      this->Following = std::move(following);
    });
}

int vtkPalpatePrecomputeStateSpace::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkPartitionedDataSetCollection");
  return 1;
}

int vtkPalpatePrecomputeStateSpace::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkPartitionedDataSetCollection::GetData(outputVector);
  // Nobody else resets the abort of an earlier run.
  this->SetAbortExecute(0);
  this->Following.reset();
  const bool goesOn = vtkPalpateStopGrowing(this);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  const auto compute = [&](palpate::Communicator& communicator)
  {
    auto* piece = vtkPalpateInput<vtkUnstructuredGrid>(inputVector[BodyPort]);
    vtkPalpateNameBlocks(output, this->IntermediateStates > 0);

    vtkSmartPointer<vtkUnstructuredGrid> body;
    palpate::agree(communicator, [&] { body = vtkPalpateGatherBody(piece, controller); });
    if (palpate::any(communicator, body && vtkPalpatePassFailure(body, output)))
    {
      return;
    }
    const auto scene = std::make_shared<const palpate::Scene>(
      vtkPalpateShareScene(body, communicator, palpate::Vec3(this->BodyForce)));
    if (this->UpdateInterval > 0 && this->FileName.empty())
    {
      throw palpate::InputError("A space with an update interval goes on from its file. Set "
                                "FileName, or the interval to 0.");
    }

    palpate::PrecomputeOptions options =
      this->Options(vtkPalpateInput<vtkPolyData>(inputVector[SurfacePort]), controller);
    if (this->HasStages(*scene))
    {
      if (this->History == LEVELS)
      {
        throw palpate::InputError(
          "History is Levels, but the body has a cut, and a body that tears "
          "is not followed from branch to branch. Set History to Flat, or "
          "CutStages to This Stage.");
      }
      options.history = palpate::History::flat;
    }
    else if (scene->body.cut.stage > 0 && options.history == palpate::History::automatic)
    {
      // Where the sides of the cut begin to touch, the force has a kink, which is no branch.
      options.history = palpate::History::flat;
    }
    if (this->Exploration == AROUND_THE_HAND)
    {
      this->LastOf.clear();
      this->Kept.reset();
      this->BeginFollowing(scene, options, communicator, output);
      return;
    }
    if (!goesOn)
    {
      // For a space that goes on growing, this was reported before.
      options.expects = [this](const palpate::ExplorationEstimate& estimate)
      {
        const std::string text = ToText(estimate);
        this->SetProgressText(text.c_str());
        this->UpdateProgress(0);
        // What is over before the first line says how far it is needs no announcement.
        if (this->LogInterval > 0 && estimate.seconds > this->LogInterval)
        {
          std::cerr << "Precompute State Space: " << text << std::endl;
        }
      };
    }

    const std::string of =
      KeyOf(*scene, options, this->UseToolRegion ? this->ToolRegion.Get() : nullptr,
        { this->MeshTolerance, this->RegionSize, this->MaximumCells }, this->CutStages);
    const bool fileIsThere = this->FileName.empty() || std::filesystem::exists(this->FileName);
    if (!palpate::any(communicator, of != this->LastOf || !fileIsThere))
    {
      output->ShallowCopy(this->Last);
      return;
    }
    this->LastOf.clear();

    const palpate::Progress tell = vtkPalpateProgress(
      this, communicator.rank(), this->LogInterval, "Precompute State Space", "configurations");
    palpate::PrecomputeResult result;
    if (this->UpdateInterval > 0 && CanBeKept(options, communicator))
    {
      // After an error the exploration is begun anew.
      std::unique_ptr<Growth> growth = std::move(this->Kept);
      if (!growth || growth->Of != of || !fileIsThere)
      {
        growth.reset();
        growth =
          std::make_unique<Growth>(this->BodiesOfRun(scene, options, communicator), options, of);
      }
      result = growth->GoOn(this->UpdateInterval, tell);
      if (growth->Session->state() == palpate::ExplorationSession::State::paused)
      {
        this->Kept = std::move(growth);
      }
    }
    else
    {
      this->Kept.reset();
      // Something is found each time, however short the interval.
      const palpate::Progress progress = [&](const palpate::ProgressState& state)
      {
        const bool isDue = this->UpdateInterval > 0 && state.seconds >= this->UpdateInterval;
        return tell(state) && !(isDue && state.num_solved > 0);
      };
      result = palpate::precompute(
        this->BodiesOfRun(scene, options, communicator), options, communicator, progress);
    }
    const bool grows = this->UpdateInterval > 0 && !result.report.complete &&
      !palpate::any(communicator, this->GetAbortExecute() != 0);
    const auto keep = [&]
    {
      if (grows)
      {
        vtkPalpateGrow(this, controller);
      }
      if (result.report.complete)
      {
        this->LastOf = of;
        this->Last->ShallowCopy(output);
      }
    };
    // The file may have bodies that the input has not.
    const std::size_t numBodies = vtkPalpateNumberOfBodies(result.bodies, communicator);
    if (numBodies > 1)
    {
      vtkPalpateNameBlocks(output, this->IntermediateStates > 0, numBodies);
    }
    if (communicator.rank() != 0)
    {
      keep();
      return;
    }
    vtkPalpateFillCollection(result.bodies, std::move(result.space), output);
    for (const auto& configurations : vtkPalpateConfigurations(output))
    {
      vtkPalpateAddFile(this->FileName, result.report.complete, configurations->GetFieldData());
      AddReport(result.report, this->MeshSeconds, configurations->GetFieldData());
      output->GetFieldData()->ShallowCopy(configurations->GetFieldData());
    }
    keep();
    if (grows)
    {
      return;
    }
    if (!result.damaged.empty())
    {
      vtkWarningMacro(<< palpate::describe_left_out(this->FileName, result.damaged)
                      << " This was removed, and is computed again.");
    }
    if (const std::string doubts = Doubts(result.report); !doubts.empty())
    {
      vtkWarningMacro("Configurations that are marked: "
        << doubts << ". Touching near them gives Found = 2 (extrapolated) or 3 (marked).");
    }
    if (const std::int64_t beyond = result.report.num_beyond_most_levels; beyond > 0)
    {
      vtkWarningMacro(
        << beyond << " transitions have found an equilibrium beyond the " << palpate::kMostLevels
        << " levels that a check-point may have, and count as failed. Touch a smaller "
           "box, or choose another law.");
    }
    if (!result.report.complete)
    {
      std::string kept = "in memory alone.";
      if (!this->FileName.empty())
      {
        kept = "in " + this->FileName + ": the next run goes on from there.";
      }
      vtkWarningMacro("Aborted. " << result.report.num_solved + result.report.num_reused
                                  << " configurations were found; they are " << kept);
    }
  };

  this->ErrorCode = vtkPalpateProduce(this, output, controller, compute);
  this->LastEnd = std::chrono::steady_clock::now();
  return 1;
}

void vtkPalpatePrecomputeStateSpace::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Graspable: " << this->Graspable << '\n'
     << indent << "Exploration: " << this->Exploration << '\n'
     << indent << "UseToolRegion: " << this->UseToolRegion << '\n'
     << indent << "ToolRegion: " << this->ToolRegion.Get() << '\n'
     << indent << "Depth: " << this->Depth << '\n'
     << indent << "Spacing: " << this->Spacing << '\n'
     << indent << "TurnSpacing: " << this->TurnSpacing << " degrees\n"
     << indent << "BeginAt: " << this->BeginAt[0] << ' ' << this->BeginAt[1] << ' '
     << this->BeginAt[2] << '\n'
     << indent << "MaximumConfigurations: " << this->MaximumConfigurations << '\n'
     << indent << "HalfWidth: " << this->HalfWidth << '\n'
     << indent << "Resolution: " << this->Resolution << '\n'
     << indent << "Tolerance: " << this->Tolerance << '\n'
     << indent << "ToleranceType: " << this->ToleranceType << '\n'
     << indent << "ForceLimit: " << this->ForceLimit << '\n'
     << indent << "History: " << this->History << '\n'
     << indent << "IntermediateStates: " << this->IntermediateStates << '\n'
     << indent << "ThirdDerivatives: " << this->ThirdDerivatives << '\n'
     << indent << "EstimateMeshError: " << this->EstimateMeshError << '\n'
     << indent << "CutStages: " << this->CutStages << '\n'
     << indent << "MeshTolerance: " << this->MeshTolerance << '\n'
     << indent << "RegionSize: " << this->RegionSize << '\n'
     << indent << "MaximumCells: " << this->MaximumCells << '\n'
     << indent << "FileName: " << this->FileName << '\n'
     << indent << "Keep: " << this->Keep << '\n'
     << indent << "SolverTolerance: " << this->SolverTolerance << '\n'
     << indent << "SinglePrecisionFactors: " << this->SinglePrecisionFactors << '\n'
     << indent << "RanksPerSolve: " << this->RanksPerSolve << '\n'
     << indent << "UpdateInterval: " << this->UpdateInterval << '\n'
     << indent << "LogInterval: " << this->LogInterval << '\n'
     << indent << "DisplacementBound: " << this->DisplacementBound << '\n'
     << indent << "Estimate: " << this->Estimate << '\n';
}
