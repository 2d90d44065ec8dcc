// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateBuildReducedModel.h"

#include <set>
#include <string>

#include "base/memory_error.h"
#include "interaction/bonded_patch.h"
#include "reduction/kept_model.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateActiveNodes.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFields.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateProgress.h"
#include "vtkPalpateReducedModel.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

namespace
{
void FillErrors(const std::vector<palpate::MeasuredError>& rows, const palpate::ReducedModel& model,
  vtkTable* table)
{
  using Row = palpate::MeasuredError;
  vtkNew<vtkStringArray> cases;
  cases->SetName("Case");
  for (const Row& row : rows)
  {
    cases->InsertNextValue(row.kind);
  }
  table->AddColumn(cases);
  const auto integer = [&](const char* name, auto get)
  {
    vtkPalpateAddColumn<vtkIntArray>(
      table, name, 1, rows, [get](const Row& row, int) { return get(row); });
  };
  const auto number = [&](const char* name, auto get)
  {
    vtkPalpateAddColumn<vtkDoubleArray>(
      table, name, 1, rows, [get](const Row& row, int) { return get(row); });
  };
  integer("Compared", [](const Row& row) { return row.error.num_compared; });
  number("LargestForce", [](const Row& row) { return row.error.largest_force; });
  number("MeanError", [](const Row& row) { return row.error.mean; });
  number("RmsError", [](const Row& row) { return row.error.rms; });
  number("MaximumError", [](const Row& row) { return row.error.max; });
  number("LargestTrust", [](const Row& row) { return row.error.largest_trust; });
  integer("Failed", [](const Row& row) { return row.error.num_failed; });
  integer("Modes", [&](const Row&) { return model.num_modes; });
  integer("Points", [&](const Row&) { return model.points.num_points(); });
  number("MedianStep", [](const Row& row) { return row.median_step; });
  number("LongestStep", [](const Row& row) { return row.longest_step; });
  number("WholeStep", [](const Row& row) { return row.whole_step; });
}

/// The tools at each place of training.
/// @param nodes Each run of as many nodes as there are tools is a place.
std::vector<std::vector<palpate::BondedPatch>> PlacesOf(
  const palpate::BondedPatches& patches, const std::vector<palpate::Index>& nodes, size_t tools)
{
  if (tools == 0)
  {
    throw palpate::InputError("A reduced model needs a tool. Give at least one active node.");
  }
  if (nodes.size() % tools != 0)
  {
    throw palpate::InputError("TrainingPlaces has a length of " + std::to_string(nodes.size()) +
      ", which is no multiple of the number of active nodes, " + std::to_string(tools) +
      ". Give each place a point for each active node.");
  }
  std::vector<std::vector<palpate::BondedPatch>> places;
  std::set<std::vector<palpate::Index>> different;
  for (auto node = nodes.begin(); node != nodes.end(); node += static_cast<std::ptrdiff_t>(tools))
  {
    const std::vector<palpate::Index> place(node, node + static_cast<std::ptrdiff_t>(tools));
    if (!different.insert(place).second)
    {
      throw palpate::InputError("Training place " + std::to_string(places.size()) +
        " (counted from 0) is the same as one before it. Name each once.");
    }
    // Tools that share a point.
    (void)patches.around_each(place);
    std::vector<palpate::BondedPatch>& at = places.emplace_back();
    for (const palpate::Index tool : place)
    {
      at.push_back(patches.around(tool));
    }
  }
  return places;
}
}

vtkStandardNewMacro(vtkPalpateBuildReducedModel);

vtkPalpateBuildReducedModel::vtkPalpateBuildReducedModel()
  : KeptPlaces(std::make_unique<palpate::KeptPlaces>())
{
  this->SetNumberOfOutputPorts(NumberOfOutputs);
}

vtkPalpateBuildReducedModel::~vtkPalpateBuildReducedModel() = default;

void vtkPalpateBuildReducedModel::AddActiveNode(vtkIdType node)
{
  this->ActiveNodes.push_back(node);
  this->Modified();
}

void vtkPalpateBuildReducedModel::ClearActiveNodes()
{
  this->ActiveNodes.clear();
  this->Modified();
}

void vtkPalpateBuildReducedModel::AddTrainingPlace(vtkIdType node)
{
  this->TrainingPlaces.push_back(node);
  this->Modified();
}

void vtkPalpateBuildReducedModel::ClearTrainingPlaces()
{
  this->TrainingPlaces.clear();
  this->Modified();
}

int vtkPalpateBuildReducedModel::FillInputPortInformation(int, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, "vtkUnstructuredGrid");
  return 1;
}

int vtkPalpateBuildReducedModel::FillOutputPortInformation(int port, vtkInformation* info)
{
  if (port == ErrorPort)
  {
    info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkTable");
    return 1;
  }
  return this->Superclass::FillOutputPortInformation(port, info);
}

int vtkPalpateBuildReducedModel::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkUnstructuredGrid::GetData(outputVector, ModelPort);
  auto* errors = vtkTable::GetData(outputVector, ErrorPort);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&](palpate::Communicator& communicator)
    {
      vtkSmartPointer<vtkUnstructuredGrid> body;
      palpate::agree(communicator,
        [&] {
          body =
            vtkPalpateGatherBody(vtkPalpateInput<vtkUnstructuredGrid>(inputVector[0]), controller);
        });
      if (palpate::any(communicator, body && vtkPalpatePassFailure(body, output)))
      {
        return;
      }
      palpate::with_memory(
        "to build the reduced model", [&] { this->Build(body, communicator, output, errors); });
    });
  return 1;
}

void vtkPalpateBuildReducedModel::Build(vtkUnstructuredGrid* body,
  palpate::Communicator& communicator, vtkUnstructuredGrid* output, vtkTable* errors)
{
  std::vector<palpate::Rheology> rheologies;
  const palpate::Scene scene = vtkPalpateShareScene(body, communicator, rheologies);
  if (this->Seed < 0)
  {
    throw palpate::InputError(
      "Seed is " + std::to_string(this->Seed) + "; it must not be negative.");
  }
  if (this->TestPaths < 0)
  {
    throw palpate::InputError(
      "TestPaths is " + std::to_string(this->TestPaths) + "; it must not be negative.");
  }
  const palpate::BondedPatches patches(scene.body, this->TipRadius);
  const std::vector<palpate::Index> nodes = vtkPalpateActiveNodes(this->ActiveNodes);
  if (!nodes.empty())
  {
    // Tools that share a point.
    (void)patches.around_each(nodes);
  }
  palpate::ReductionTools tools;
  tools.nodes = nodes;
  for (const palpate::Index node : nodes)
  {
    tools.patches.push_back(patches.around(node));
  }
  if (!this->TrainingPlaces.empty())
  {
    tools.places = PlacesOf(palpate::BondedPatches(scene.body, this->TipRadius, "training place"),
      vtkPalpateActiveNodes(this->TrainingPlaces, "Training place"), nodes.size());
  }

  palpate::ReductionOptions options;
  options.modes = this->Modes;
  options.tolerance = this->Tolerance;
  options.max_points = this->MaximumPoints;
  options.training_paths = this->TrainingPaths;
  options.seed = static_cast<std::uint64_t>(this->Seed);
  options.reach = this->Reach;
  options.gravity = palpate::Vec3(this->BodyForce);
  options.path_duration = this->PathDuration;
  options.bandwidth = this->Bandwidth;
  options.taps = this->Taps;
  options.shortest_tap = this->ShortestTap;
  options.time_step = this->TimeStep;
  options.equilibrium.tolerance = this->SolverTolerance;
  // A request that has ended an earlier run is not meant for this one, and nobody else resets it.
  this->SetAbortExecute(0);
  options.report = [this](const std::string& what) { this->SetProgressText(what.c_str()); };
  // The remaining work is not known, so that the progress never reaches its end.
  options.equilibrium.abort_requested =
    vtkPalpateAbortRequested(this, [told = 0.0]() mutable { return told += (1 - told) / 500; });
  palpate::validate(options);
  palpate::check_steps(options, this->TestPaths, "TestPaths, PathDuration and TimeStep");
  palpate::MeasureOptions measure;
  measure.paths = this->TestPaths;
  measure.abort_requested = [this] { return this->GetAbortExecute() != 0; };
  palpate::KeptModel kept = palpate::build_kept_model(scene, rheologies, tools, options, measure,
    this->FileName, communicator, this->KeptPlaces.get());
  if (communicator.rank() != 0)
  {
    return;
  }
  if (kept.aborted)
  {
    output->ShallowCopy(body);
    return;
  }
  if (!kept.damaged.empty())
  {
    vtkWarningMacro(<< palpate::describe_left_out(this->FileName, kept.damaged)
                    << " What the reduced model needs of it was computed again.");
  }
  if (!kept.not_kept.empty())
  {
    vtkPalpateWarn(this,
      kept.not_kept +
        " Nothing had to be trained, so that there is a reduced model all the same, but it is not "
        "kept in the file.");
  }
  if (!kept.within_tolerance)
  {
    vtkWarningMacro(<< "The " << kept.model.points.num_points()
                    << " points of the reduced model have an error of " << kept.residual
                    << " of the forces in training, more than Tolerance, " << this->Tolerance
                    << ". Allow more points (MaximumPoints), or a larger Tolerance.");
  }
  FillErrors(kept.errors, kept.model, errors);
  output->ShallowCopy(body);
  vtkPalpateWriteReducedModel(
    { std::move(kept.model), std::move(kept.basis), std::move(kept.rest), this->ActiveNodes },
    output);
}

void vtkPalpateBuildReducedModel::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ActiveNodes:";
  for (const vtkIdType node : this->ActiveNodes)
  {
    os << ' ' << node;
  }
  os << '\n' << indent << "TrainingPlaces:";
  for (const vtkIdType node : this->TrainingPlaces)
  {
    os << ' ' << node;
  }
  os << '\n'
     << indent << "TipRadius: " << this->TipRadius << " m\n"
     << indent << "Reach: " << this->Reach << " m\n"
     << indent << "BodyForce: " << this->BodyForce[0] << ' ' << this->BodyForce[1] << ' '
     << this->BodyForce[2] << " m/s^2\n"
     << indent << "Modes: " << this->Modes << '\n'
     << indent << "Tolerance: " << this->Tolerance << '\n'
     << indent << "MaximumPoints: " << this->MaximumPoints << '\n'
     << indent << "TrainingPaths: " << this->TrainingPaths << '\n'
     << indent << "PathDuration: " << this->PathDuration << " s\n"
     << indent << "Bandwidth: " << this->Bandwidth << " Hz\n"
     << indent << "Taps: " << this->Taps << " 1/s\n"
     << indent << "ShortestTap: " << this->ShortestTap << " s\n"
     << indent << "TimeStep: " << this->TimeStep << " s\n"
     << indent << "Seed: " << this->Seed << '\n'
     << indent << "TestPaths: " << this->TestPaths << '\n'
     << indent << "FileName: " << this->FileName << '\n'
     << indent << "SolverTolerance: " << this->SolverTolerance << '\n';
}
