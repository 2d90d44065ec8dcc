// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSolveDynamics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/memory_error.h"
#include "dynamics/dynamic_solver.h"
#include "interaction/bonded_patch.h"
#include "interaction/hertz_stiffness.h"
#include "interaction/mesh_error.h"
#include "interaction/rigid_tool.h"
#include "interaction/tool_clearance.h"
#include "soft_contact/soft_contact.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateActiveNodes.h"
#include "vtkPalpateFields.h"
#include "vtkPalpateFrameTimes.h"
#include "vtkPalpateFrames.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateKeptRun.h"
#include "vtkPalpatePartContact.h"
#include "vtkPalpateProgress.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateToolPath.h"
#include "vtkPointData.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::DynamicState;
using palpate::InputError;
using palpate::NodalVector;

/// The displacement between two states, by a cubic that has their velocities too.
NodalVector Between(const palpate::BodyMotion& from, const palpate::BodyMotion& to, double time)
{
  const double h = to.time - from.time;
  const double s = h > 0 ? std::clamp((time - from.time) / h, 0.0, 1.0) : 1;
  const double r = 1 - s;
  return r * r * (1 + 2 * s) * from.u + s * s * (1 + 2 * r) * to.u +
    h * s * r * (r * from.velocity - s * to.velocity);
}

/// A row of the table.
struct Step
{
  explicit Step(const DynamicState& state)
    : Time(state.motion.time)
    , Length(state.motion.step)
    , Energy(state.energy)
    , Position(state.tools)
    , Force(state.force)
    , MinimumDetF(state.minimum_det_f)
    , LocalError(state.local_error)
    , Residual(state.residual)
    , Iterations(state.iterations)
    , Halvings(state.halvings)
    , Flags(state.flags)
  {
  }

  double Time;
  double Length;
  palpate::EnergyAccount Energy;
  Eigen::VectorXd Position;
  Eigen::VectorXd Force;
  double MinimumDetF;
  double LocalError;
  double Residual;
  int Iterations;
  int Halvings;
  palpate::Flags Flags;
};

vtkSmartPointer<vtkTable> TableOf(const std::vector<Step>& steps, palpate::Outcome outcome)
{
  auto table = vtkSmartPointer<vtkTable>::New();
  const auto number = [&](const char* name, auto get)
  {
    vtkPalpateAddColumn<vtkDoubleArray>(
      table, name, 1, steps, [get](const Step& step, int) { return get(step); });
  };
  number("Time", [](const Step& step) { return step.Time; });
  number("StepLength", [](const Step& step) { return step.Length; });
  number("KineticEnergy", [](const Step& step) { return step.Energy.kinetic; });
  number("ElasticEnergy", [](const Step& step) { return step.Energy.elastic; });
  number("WeightEnergy", [](const Step& step) { return step.Energy.weight; });
  number("ViscousEnergy", [](const Step& step) { return step.Energy.viscous_stored; });
  number("Dissipated", [](const Step& step) { return step.Energy.dissipated; });
  number("Work", [](const Step& step) { return step.Energy.work; });
  vtkPalpateAddToolColumns(table, steps);
  number("MinimumDetF", [](const Step& step) { return step.MinimumDetF; });
  number("LocalError", [](const Step& step) { return step.LocalError; });
  number("Residual", [](const Step& step) { return step.Residual; });
  const auto integer = [&](const char* name, auto get)
  {
    vtkPalpateAddColumn<vtkIntArray>(
      table, name, 1, steps, [get](const Step& step, int) { return get(step); });
  };
  integer("Iterations", [](const Step& step) { return step.Iterations; });
  integer("Halvings", [](const Step& step) { return step.Halvings; });
  integer("Flags", [](const Step& step) { return step.Flags; });
  integer("Outcome",
    [&steps, outcome](const Step& step)
    { return static_cast<int>(&step == &steps.back() ? outcome : palpate::Outcome::converged); });
  return table;
}
}

struct vtkPalpateSolveDynamics::Setup
{
  palpate::Scene Scene;
  std::vector<palpate::Rheology> Rheologies;
  palpate::InteractionList Tools;
  /// The rigid ones among them.
  std::vector<palpate::RigidContact> Contacts;
  palpate::ToolPath Path{ Eigen::VectorXd() };
  /// Where the tools do not act on the body at rest [d].
  Eigen::VectorXd Clear;
};

struct vtkPalpateSolveDynamics::Run
{
  /// On rank 0 alone; null where the body was one that a filter before could not make.
  vtkSmartPointer<vtkUnstructuredGrid> Body;
  std::vector<palpate::RigidContact> Contacts;
  /// The modulus of the body where the tools press, Pa, and the order of its cells.
  double ContactModulus = 0;
  /// The contact of the parts with each other; null: they have none.
  std::shared_ptr<const palpate::SoftContact> PartContact;
  palpate::ElementOrder Order{};
  std::unique_ptr<vtkPalpateFrames> Frames;
  std::vector<Step> Steps;
  vtkSmartPointer<vtkTable> History;
  palpate::Outcome Outcome = palpate::Outcome::converged;
  std::string Message;
};

vtkStandardNewMacro(vtkPalpateSolveDynamics);

vtkPalpateSolveDynamics::vtkPalpateSolveDynamics()
  : LastRun(std::make_unique<vtkPalpateKeptRun<Run>>())
{
  this->Tolerance = 1e-8;
  this->SetNumberOfInputPorts(NumberOfInputs + 1);
  this->SetNumberOfOutputPorts(vtkPalpateKeptRun<Run>::NumberOfOutputs);
}

vtkPalpateSolveDynamics::~vtkPalpateSolveDynamics() = default;

int vtkPalpateSolveDynamics::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port != PathPort)
  {
    return this->Superclass::FillInputPortInformation(port, info);
  }
  vtkPalpateTakeWhole(info, "vtkTable");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

int vtkPalpateSolveDynamics::FillOutputPortInformation(int port, vtkInformation* info)
{
  return vtkPalpateKeptRun<Run>::FillOutputPortInformation(port, info);
}

std::vector<double> vtkPalpateSolveDynamics::FrameTimes() const
{
  return vtkPalpateFrameTimes(this->EndTime, this->FrameRate);
}

void vtkPalpateSolveDynamics::CheckProperties() const
{
  if (this->Integrator != static_cast<int>(palpate::TimeIntegrator::bdf2) &&
    this->Integrator != static_cast<int>(palpate::TimeIntegrator::generalised_alpha))
  {
    throw InputError("Integrator is " + std::to_string(this->Integrator) +
      "; there are 0 (BDF2) and 1 (Generalised alpha).");
  }
  vtkPalpateCheckTimes(this->EndTime, this->FrameRate, this->TimeStep);
}

int vtkPalpateSolveDynamics::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkPalpateKeptRun<Run>::RequestInformation(this->FrameTimes(), outputVector);
}

int vtkPalpateSolveDynamics::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  this->ErrorCode = this->LastRun->RequestData(
    this, request, inputVector, outputVector,
    [&](palpate::Communicator& communicator, vtkUnstructuredGrid* output)
    { return this->Compute(inputVector, communicator, output); },
    [this](const Run& run, double time, vtkUnstructuredGrid* output, vtkTable* history)
    { this->Show(run, time, output, history); });
  return 1;
}

std::unique_ptr<vtkPalpateSolveDynamics::Run> vtkPalpateSolveDynamics::Compute(
  vtkInformationVector** inputs, palpate::Communicator& communicator, vtkUnstructuredGrid* output)
{
  this->CheckProperties();
  auto run = std::make_unique<Run>();
  Setup setup;
  const auto setUp = [&](vtkUnstructuredGrid* body, vtkPolyData* surface) -> const palpate::Scene&
  {
    setup = this->MakeSetup(body, vtkPalpateInput<vtkTable>(inputs[PathPort]), surface);
    return setup.Scene;
  };
  const auto solve =
    [&](vtkUnstructuredGrid* body, std::unique_ptr<palpate::LinearSolver> linearSolver, int threads)
  {
    run->Body = body;
    run->Contacts = setup.Contacts;
    run->PartContact = palpate::make_soft_contact(setup.Scene);
    run->ContactModulus = setup.Contacts.empty() ? 0 : palpate::mean_contact_modulus(setup.Scene);
    run->Order = setup.Scene.body.mesh.order;
    palpate::with_memory("to solve for the motion of the body",
      [&] { this->Simulate(setup, std::move(linearSolver), threads, *run); });
  };
  this->SolveOnRanks(inputs, communicator, output, setUp, solve);
  return run;
}

vtkPalpateSolveDynamics::Setup vtkPalpateSolveDynamics::MakeSetup(
  vtkUnstructuredGrid* body, vtkTable* paths, vtkPolyData* surface)
{
  Setup setup;
  setup.Scene = vtkPalpateSceneFromGrid(body, setup.Rheologies);
  const std::vector<palpate::Index> nodes = vtkPalpateActiveNodes(this->ActiveNodes);
  const int bonded = static_cast<int>(nodes.size());
  const int tools = vtkPalpateCountTools(paths);
  const bool hasRigid = this->Tool != nullptr;
  if (hasRigid ? tools <= bonded : tools != bonded)
  {
    throw InputError("The table of the tools has columns for " + std::to_string(tools) +
      " of them, and the active nodes are " + std::to_string(bonded) +
      (hasRigid ? ", besides a rigid tool. Give it columns for all, those of the rigid tools last"
                : ". Give it columns for each of these, and for no others") +
      ": Time (s), Tool0_X, Tool0_Y, Tool0_Z (m), Tool1_X, …");
  }
  if (tools == 0)
  {
    return setup;
  }
  setup.Path = vtkPalpateToolPath(paths);
  setup.Clear.setZero(3 * tools);
  if (bonded > 0)
  {
    setup.Tools = palpate::BondedPatches(setup.Scene.body, this->TipRadius).around_each(nodes);
  }
  if (!hasRigid)
  {
    return setup;
  }
  const palpate::RigidTool tool =
    palpate::with_defaults(this->Tool->Describe(surface), setup.Scene);
  const palpate::RigidContact contact = palpate::make_contact(setup.Scene.body, tool);
  if (contact.num_coordinates() != 3)
  {
    throw InputError("The table of the tools has the place of a rigid tool, and none of its "
                     "orientations. Choose the Motion Translated or Trocar.");
  }
  const palpate::ToolClearance clearance(setup.Scene.body, {}, contact);
  const Eigen::VectorXd first = setup.Path.at(0);
  for (int rigid = bonded; rigid < tools; ++rigid)
  {
    setup.Tools.add(contact);
    setup.Contacts.push_back(contact);
    setup.Clear.segment<3>(3 * rigid) = clearance.start_for(first.segment<3>(3 * rigid));
  }
  return setup;
}

void vtkPalpateSolveDynamics::Simulate(
  const Setup& setup, std::unique_ptr<palpate::LinearSolver> linearSolver, int threads, Run& run)
{
  palpate::DynamicsOptions options;
  options.integrator = static_cast<palpate::TimeIntegrator>(this->Integrator);
  options.spectral_radius = this->SpectralRadius;
  options.time_step = this->TimeStep;
  options.tolerance = this->StepTolerance;
  options.max_halvings = this->MaximumHalvings;
  options.gravity = palpate::Vec3(this->BodyForce);
  options.settled = this->Settled;
  options.equilibrium.tolerance = this->Tolerance;
  options.equilibrium.max_iterations = this->MaximumIterations;
  options.equilibrium.max_seconds = this->MaximumSeconds;
  options.equilibrium.threads = threads;
  options.equilibrium.abort_requested = vtkPalpateAbortRequested(
    this, [this, &run] { return run.Steps.empty() ? 0 : run.Steps.back().Time / this->EndTime; });

  const std::vector<double> times = this->FrameTimes();
  run.Frames = std::make_unique<vtkPalpateFrames>(3 * setup.Scene.body.mesh.points.size());
  palpate::BodyMotion before;
  const auto takeState = [&](const DynamicState& state)
  {
    if (run.Steps.empty())
    {
      before = state.motion;
    }
    const double now = state.motion.time + vtkPalpateTimeRounding * this->TimeStep;
    for (std::size_t next = run.Frames->Number(); next < times.size() && times[next] <= now; ++next)
    {
      run.Frames->Append(Between(before, state.motion, times[next]));
    }
    run.Steps.emplace_back(state);
    before = state.motion;
    return true;
  };
  palpate::DynamicSolver solver(
    setup.Scene, setup.Rheologies, setup.Tools, options, std::move(linearSolver));
  const DynamicState end = solver.run(setup.Path, this->EndTime, takeState, setup.Clear);
  if (run.Steps.empty())
  {
    run.Steps.emplace_back(end);
    run.Frames->Append(end.motion.u);
  }
  run.Outcome = end.outcome;
  run.Message = end.message;
  run.History = TableOf(run.Steps, run.Outcome);
  if (!run.Message.empty())
  {
    vtkPalpateWarn(this, run.Message);
  }
}

void vtkPalpateSolveDynamics::Show(
  const Run& run, double time, vtkUnstructuredGrid* output, vtkTable* history) const
{
  output->ShallowCopy(run.Body);
  history->ShallowCopy(run.History);
  const std::vector<double> times = this->FrameTimes();
  const std::size_t frame =
    std::min(vtkPalpateFrameAt(time, times, this->FrameRate), run.Frames->Number() - 1);
  const NodalVector u = run.Frames->Read(frame);
  output->GetPointData()->AddArray(vtkPalpateNodalArray(vtkPalpateArray::Displacement, u));
  output->GetPointData()->SetActiveVectors(vtkPalpateArray::Displacement);
  output->GetPointData()->SetActiveScalars(vtkPalpateArray::Displacement);

  // Of the tools between two steps.
  const auto next = std::lower_bound(run.Steps.begin(), run.Steps.end(), times[frame],
    [](const Step& step, double at) { return step.Time < at; });
  const Step& to = next == run.Steps.end() ? run.Steps.back() : *next;
  const Step& from = next == run.Steps.begin() ? to : *std::prev(next);
  const double share = to.Time > from.Time
    ? std::clamp((times[frame] - from.Time) / (to.Time - from.Time), 0.0, 1.0)
    : 1;
  const Eigen::VectorXd force = (1 - share) * from.Force + share * to.Force;
  const Eigen::VectorXd position = (1 - share) * from.Position + share * to.Position;
  if (run.PartContact)
  {
    vtkPalpateAddPartContact(*run.PartContact, u, output);
  }
  if (!run.Contacts.empty())
  {
    vtkNew<vtkDoubleArray> pressure;
    pressure->SetName(vtkPalpateArray::ContactPressure);
    pressure->SetNumberOfTuples(output->GetNumberOfPoints());
    pressure->Fill(0);
    const auto rigid = static_cast<Eigen::Index>(run.Contacts.size());
    Eigen::VectorXd layerForce(rigid);
    Eigen::VectorXd meshError(rigid);
    auto coordinate = position.size() - 3 * rigid;
    for (Eigen::Index tool = 0; tool < rigid; ++tool)
    {
      const palpate::RigidContact& contact = run.Contacts[static_cast<std::size_t>(tool)];
      const auto patch = contact.patch(position.segment<3>(coordinate), u);
      const palpate::Vec3 holding = force.segment<3>(coordinate);
      const double stiffness = palpate::hertz_stiffness(
        contact.law(), patch.layer_depth, holding.norm(), run.ContactModulus);
      layerForce[tool] = patch.area > 0 ? palpate::contact_layer_force(patch.layer_depth, holding,
                                            stiffness * palpate::Mat3::Identity())
                                        : 0;
      meshError[tool] = palpate::expected_mesh_error(run.Order, patch.longest_edge, patch.area);
      for (std::size_t point = 0; point < patch.pressure.size(); ++point)
      {
        const auto id = static_cast<vtkIdType>(point);
        pressure->SetValue(id, pressure->GetValue(id) + patch.pressure[point]);
      }
      coordinate += 3;
    }
    output->GetPointData()->AddArray(pressure);
    vtkPalpateAddField<vtkDoubleArray>(output, "ContactLayerForce", 1, layerForce);
    vtkPalpateAddField<vtkDoubleArray>(output, "ContactMeshError", 1, meshError);
  }
  // Between processes VTK loses what follows an array without values.
  if (force.size() > 0)
  {
    vtkPalpateAddField<vtkDoubleArray>(output, "ReactionForce", 3, force);
  }
  vtkPalpateAddNumber(output, "Time", times[frame]);
  vtkPalpateAddInteger(output, "Outcome", static_cast<int>(run.Outcome));
  vtkPalpateAddText(output, "Message", run.Message);
  output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
}

void vtkPalpateSolveDynamics::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Settled: " << this->Settled << '\n'
     << indent << "EndTime: " << this->EndTime << " s\n"
     << indent << "FrameRate: " << this->FrameRate << " 1/s\n"
     << indent << "Integrator: " << this->Integrator << '\n'
     << indent << "SpectralRadius: " << this->SpectralRadius << '\n'
     << indent << "TimeStep: " << this->TimeStep << " s\n"
     << indent << "StepTolerance: " << this->StepTolerance << '\n'
     << indent << "MaximumHalvings: " << this->MaximumHalvings << '\n';
}
