// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSimulateTouch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/memory_error.h"
#include "base/own_seconds.h"
#include "dynamics/tool_path.h"
#include "reduced/reduced_body.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFields.h"
#include "vtkPalpateFrameTimes.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateKeptRun.h"
#include "vtkPalpateProgress.h"
#include "vtkPalpateReducedModel.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateToolPath.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPointData.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

namespace
{
enum InputPort
{
  BodyPort,
  PathPort,
  NumberOfInputs
};
/// A row of the table.
struct Step
{
  double Time;
  palpate::ReducedState State;
  Eigen::VectorXd Position;
  Eigen::VectorXd Force;
  double Seconds;
};

vtkSmartPointer<vtkTable> TableOf(const std::vector<Step>& steps)
{
  auto table = vtkSmartPointer<vtkTable>::New();
  const auto number = [&](const char* name, auto get)
  {
    vtkPalpateAddColumn<vtkDoubleArray>(
      table, name, 1, steps, [get](const Step& step, int) { return get(step); });
  };
  const auto integer = [&](const char* name, auto get)
  {
    vtkPalpateAddColumn<vtkIntArray>(
      table, name, 1, steps, [get](const Step& step, int) { return get(step); });
  };
  number("Time", [](const Step& step) { return step.Time; });
  number("KineticEnergy", [](const Step& step) { return step.State.kinetic; });
  number("ElasticEnergy", [](const Step& step) { return step.State.elastic; });
  number("ViscousEnergy", [](const Step& step) { return step.State.viscous_stored; });
  number("Dissipated", [](const Step& step) { return step.State.dissipated; });
  number("Work", [](const Step& step) { return step.State.work; });
  vtkPalpateAddToolColumns(table, steps);
  number("Trust", [](const Step& step) { return step.State.trust; });
  number("MinimumDetF", [](const Step& step) { return step.State.minimum_det_f; });
  number("Residual", [](const Step& step) { return step.State.residual; });
  integer("Iterations", [](const Step& step) { return step.State.iterations; });
  integer("Tangents", [](const Step& step) { return step.State.tangents; });
  integer("Halvings", [](const Step& step) { return step.State.halvings; });
  integer("Outcome", [](const Step& step) { return static_cast<int>(step.State.outcome); });
  number("StepSeconds", [](const Step& step) { return step.Seconds; });
  return table;
}
}

struct vtkPalpateSimulateTouch::Run
{
  /// Null where the body was one that a filter before could not make.
  vtkSmartPointer<vtkUnstructuredGrid> Body;
  vtkPalpateReducedModel Reduced;
  /// The coordinates y of each frame, and the step that leads to it.
  std::vector<Eigen::VectorXd> Frames;
  std::vector<std::size_t> StepOfFrame;
  std::vector<Step> Steps;
  vtkSmartPointer<vtkTable> History;
  /// Whether the run was not aborted.
  bool IsComplete = true;
};

vtkStandardNewMacro(vtkPalpateSimulateTouch);

vtkPalpateSimulateTouch::vtkPalpateSimulateTouch()
  : LastRun(std::make_unique<vtkPalpateKeptRun<Run>>())
{
  this->SetNumberOfInputPorts(NumberOfInputs);
  this->SetNumberOfOutputPorts(vtkPalpateKeptRun<Run>::NumberOfOutputs);
}

vtkPalpateSimulateTouch::~vtkPalpateSimulateTouch() = default;

int vtkPalpateSimulateTouch::FillInputPortInformation(int port, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, port == BodyPort ? "vtkUnstructuredGrid" : "vtkTable");
  if (port == PathPort)
  {
    // The input is optional, so that ParaView's panel asks for it, and no dialog before.
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

int vtkPalpateSimulateTouch::FillOutputPortInformation(int port, vtkInformation* info)
{
  return vtkPalpateKeptRun<Run>::FillOutputPortInformation(port, info);
}

int vtkPalpateSimulateTouch::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkPalpateKeptRun<Run>::RequestInformation(
    vtkPalpateFrameTimes(this->EndTime, this->FrameRate), outputVector);
}

int vtkPalpateSimulateTouch::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  const auto compute = [&](palpate::Communicator&, vtkUnstructuredGrid* output)
  {
    vtkPalpateCheckTimes(this->EndTime, this->FrameRate, this->TimeStep);
    auto run = std::make_unique<Run>();
    const auto body =
      vtkPalpateGatherBody(vtkPalpateInput<vtkUnstructuredGrid>(inputVector[BodyPort]),
        vtkMultiProcessController::GetGlobalController());
    if (body && !vtkPalpatePassFailure(body, output))
    {
      palpate::with_memory("to simulate the touch",
        [&] { this->Simulate(body, vtkPalpateInput<vtkTable>(inputVector[PathPort]), *run); });
    }
    return run;
  };
  this->ErrorCode = this->LastRun->RequestData(this, request, inputVector, outputVector, compute,
    [this](const Run& run, double time, vtkUnstructuredGrid* output, vtkTable* history)
    { this->Show(run, time, output, history); });
  return 1;
}

void vtkPalpateSimulateTouch::Simulate(vtkUnstructuredGrid* body, vtkTable* paths, Run& run)
{
  run.Reduced = vtkPalpateReadReducedModel(body);
  const palpate::ReducedModel& model = run.Reduced.Model;
  const int tools = vtkPalpateCountTools(paths);
  if (3 * tools != model.num_tool_coordinates)
  {
    throw palpate::InputError("The table of the tools has columns for " + std::to_string(tools) +
      " tools, and the reduced model has " + std::to_string(model.num_tool_coordinates / 3) +
      ". Give it columns for all of them, and for no others: Time (s), Tool0_X, Tool0_Y, Tool0_Z "
      "(m), Tool1_X, …");
  }
  const palpate::ToolPath path = vtkPalpateToolPath(paths);
  palpate::ReducedBodyOptions options;
  options.time_step = this->TimeStep;
  palpate::ReducedBody reduced(model, options);
  const std::vector<double> times = vtkPalpateFrameTimes(this->EndTime, this->FrameRate);
  const auto take = [&](double time, double seconds)
  {
    run.Steps.push_back(
      { time, reduced.state(), reduced.coordinates().tail(3 * tools), reduced.force(), seconds });
  };
  take(0, 0);
  run.Frames.push_back(reduced.coordinates());
  run.StepOfFrame.push_back(0);
  Eigen::VectorXd before = reduced.coordinates();
  const double rounding = vtkPalpateTimeRounding * this->TimeStep;
  const auto abortRequested =
    vtkPalpateAbortRequested(this, [&] { return run.Steps.back().Time / this->EndTime; });
  while (this->EndTime - run.Steps.back().Time > rounding)
  {
    const double last = run.Steps.back().Time;
    if (abortRequested())
    {
      vtkWarningMacro("Aborted at " << last << " s of " << this->EndTime
                                    << " s. Later frames show the last one that was computed.");
      run.IsComplete = false;
      break;
    }
    for (int tool = 0; tool < tools; ++tool)
    {
      if (path.release(tool) <= last + rounding)
      {
        reduced.hold(tool, 0);
      }
    }
    // Steps end where a tool is let go, and otherwise at multiples of their length.
    const double next = this->TimeStep * (std::floor((last + rounding) / this->TimeStep) + 1);
    const double time = std::min({ next, this->EndTime, path.next_release(last + rounding) });
    const Eigen::VectorXd place = path.at(time);
    const double start = palpate::own_seconds();
    (void)reduced.step(place.data(), time - last);
    take(time, palpate::own_seconds() - start);
    while (run.Frames.size() < times.size() &&
      times[run.Frames.size()] <= time + vtkPalpateTimeRounding * this->TimeStep)
    {
      const double share = std::clamp((times[run.Frames.size()] - last) / (time - last), 0.0, 1.0);
      run.Frames.push_back((1 - share) * before + share * reduced.coordinates());
      run.StepOfFrame.push_back(run.Steps.size() - 1);
    }
    before = reduced.coordinates();
  }
  run.History = TableOf(run.Steps);
  run.Body = body;
}

void vtkPalpateSimulateTouch::Show(
  const Run& run, double time, vtkUnstructuredGrid* output, vtkTable* history) const
{
  output->ShallowCopy(run.Body);
  history->ShallowCopy(run.History);
  const std::vector<double> times = vtkPalpateFrameTimes(this->EndTime, this->FrameRate);
  const std::size_t frame =
    std::min(vtkPalpateFrameAt(time, times, this->FrameRate), run.Frames.size() - 1);
  const palpate::NodalVector u = run.Reduced.Rest + run.Reduced.Basis * run.Frames[frame];
  output->GetPointData()->AddArray(vtkPalpateNodalArray(vtkPalpateArray::Displacement, u));
  output->GetPointData()->SetActiveVectors(vtkPalpateArray::Displacement);
  output->GetPointData()->SetActiveScalars(vtkPalpateArray::Displacement);
  const Step& step = run.Steps[run.StepOfFrame[frame]];
  vtkPalpateAddField<vtkDoubleArray>(output, "ReactionForce", 3, step.Force);
  vtkPalpateAddNumber(output, "Time", times[frame]);
  vtkPalpateAddNumber(output, "Trust", step.State.trust);
  vtkPalpateAddInteger(output, "Outcome", static_cast<int>(step.State.outcome));
  vtkPalpateAddInteger(output, "Complete", run.IsComplete ? 1 : 0);
  output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
}

void vtkPalpateSimulateTouch::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "EndTime: " << this->EndTime << " s\n"
     << indent << "FrameRate: " << this->FrameRate << " 1/s\n"
     << indent << "TimeStep: " << this->TimeStep << " s\n";
}
