// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateAccuracyReport.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>

#include "accuracy/accuracy.h"
#include "base/content_hash.h"
#include "base/error.h"
#include "exploration/exploration_estimate.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateEstimate.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateProgress.h"
#include "vtkPalpateSceneToEstimate.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPalpateStateSpaceArrays.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::AccuracyPoint;
using palpate::AccuracyResult;
using palpate::AccuracyRow;

constexpr double PerCent = 100;
/// The number of factors that are in memory at the same time: those of an anchor, of rest and of a
/// step.
constexpr int FactorsOfReport = 3;
/// The time of a test point, in times of a configuration: the anchors are reached too, and are
/// farther away than a neighbour.
constexpr double TimeOfPoint = 2;
/// The time of a solve on a mesh with eight times the cells, in times of one, and its memory.
constexpr double TimeOnFinerMesh = 20;
constexpr double MemoryOfFinerMesh = 12;

/// The key of everything that a report depends on.
std::string KeyOf(const palpate::TouchSpace& space, const palpate::AccuracyOptions& options)
{
  palpate::ContentHash key;
  key.add(space.scene_hash).add(space.file);
  for (const palpate::TouchToolSpace& toolSpace : space.tool_spaces)
  {
    const palpate::ToolSpaceSetup& s = toolSpace.setup;
    key.add(s.interaction.active_node).add(s.interaction.tip_radius).add(s.name());
    key.add(s.grid.half_width).add(s.grid.resolution).add(s.grid.coarsest);
    key.add(s.policy.force_limit).add(s.policy.depth);
    key.add(toolSpace.modes).add(toolSpace.coefficients);
    for (const palpate::ConfigurationSummary& c : toolSpace.configurations)
    {
      key.add(c.check_point).add(c.level).add(c.t).add(c.energy).add(c.force).add(c.stiffness);
      key.add(c.third_derivative).add(c.flags).add(c.outcome).add(c.seconds);
      key.add(c.mesh_error.energy).add(c.mesh_error.force).add(c.mesh_error.is_reliable);
    }
    for (const palpate::IntermediateState& state : toolSpace.intermediate_states)
    {
      key.add(state.t).add(state.energy).add(state.force);
    }
  }
  key.add(options.exact.test_points).add(options.exact.seed);
  key.add(options.exact.equilibrium.tolerance).add(options.exact.file.string());
  key.add(options.methods).add(options.measures_mesh_error);
  return key.text();
}

template <class Array, class Rows, class Get>
vtkSmartPointer<Array> Column(const std::string& name, const Rows& rows, Get&& get)
{
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name.c_str());
  for (const auto& row : rows)
  {
    array->InsertNextValue(get(row));
  }
  return array;
}

void FillTable(const std::vector<AccuracyRow>& rows, bool ofNodes, vtkTable* table)
{
  table->Initialize();
  const auto integer = [&](const char* name, auto member)
  {
    table->AddColumn(
      Column<vtkIntArray>(name, rows, [=](const AccuracyRow& row) { return row.*member; }));
  };
  const auto number = [&](const char* name, double AccuracyRow::*member, double factor = 1)
  {
    table->AddColumn(Column<vtkDoubleArray>(
      name, rows, [=](const AccuracyRow& row) { return factor * row.*member; }));
  };
  table->AddColumn(
    Column<vtkStringArray>("Method", rows, [](const AccuracyRow& row) { return row.method; }));
  if (ofNodes)
  {
    integer("ActiveNode", &AccuracyRow::active_node);
    table->AddColumn(
      Column<vtkStringArray>("Tool", rows, [](const AccuracyRow& row) { return row.tool; }));
  }
  integer("Resolution", &AccuracyRow::resolution);
  number("Spacing", &AccuracyRow::spacing);
  number("Samples", &AccuracyRow::samples);
  number("PrecomputeSeconds", &AccuracyRow::precompute_seconds);
  number("EvaluationP50", &AccuracyRow::p50_nanoseconds);
  number("EvaluationP999", &AccuracyRow::p999_nanoseconds);
  number("Bytes", &AccuracyRow::bytes);
  number("SetupSeconds", &AccuracyRow::setup_seconds);
  number("MeanError", &AccuracyRow::mean_error, PerCent);
  number("P99Error", &AccuracyRow::p99_error, PerCent);
  number("LargestError", &AccuracyRow::largest_error, PerCent);
  number("MeanErrorN", &AccuracyRow::mean_absolute_error);
  number("P99ErrorN", &AccuracyRow::p99_absolute_error);
  number("LargestErrorN", &AccuracyRow::largest_absolute_error);
  number("LargestForce", &AccuracyRow::largest_force);
  number("MeanMeshErrorN", &AccuracyRow::mean_mesh_error);
  number("LargestMeshErrorN", &AccuracyRow::largest_mesh_error);
  number("MeshErrorReliable", &AccuracyRow::reliable_mesh_error, PerCent);
  number("MeanMeasuredMeshErrorN", &AccuracyRow::mean_measured_mesh_error);
  number("LargestMeasuredMeshErrorN", &AccuracyRow::largest_measured_mesh_error);
  number("MeanLeftMeshErrorN", &AccuracyRow::mean_left_mesh_error);
  number("LargestLeftMeshErrorN", &AccuracyRow::largest_left_mesh_error);
  number("Noticeable", &AccuracyRow::noticeable, PerCent);
  number("NearRestError", &AccuracyRow::near_rest_error, PerCent);
  number("MeanMarkedError", &AccuracyRow::mean_marked_error, PerCent);
  number("LargestMarkedError", &AccuracyRow::largest_marked_error, PerCent);
  number("LargestExtrapolatedError", &AccuracyRow::largest_extrapolated_error, PerCent);
  number("MeanStiffnessError", &AccuracyRow::mean_stiffness_error, PerCent);
  number("MeanDisplacementError", &AccuracyRow::mean_displacement_error, PerCent);
  number("LargestDisplacementError", &AccuracyRow::largest_displacement_error, PerCent);
  number("LoopWork", &AccuracyRow::loop_work);
  number("ForceJump", &AccuracyRow::force_jump);
  number("StiffnessJump", &AccuracyRow::stiffness_jump);
  integer("TestPoints", &AccuracyRow::test_points);
  integer("Counted", &AccuracyRow::counted);
  integer("Marked", &AccuracyRow::marked);
  integer("Extrapolated", &AccuracyRow::extrapolated);
  integer("Irregular", &AccuracyRow::irregular);
  integer("Failed", &AccuracyRow::failed);
}

/// Fills the table for a chart of error against cost. Each method has a column of mean errors, with
/// nothing in the rows of other methods, so that it becomes a line through its grids.
void FillChart(std::vector<AccuracyRow> rows, vtkTable* table)
{
  table->Initialize();
  // A line goes through rows that follow each other.
  std::stable_sort(rows.begin(), rows.end(),
    [](const AccuracyRow& a, const AccuracyRow& b) { return a.method < b.method; });
  const auto number = [&](const std::string& name, auto&& get)
  { table->AddColumn(Column<vtkDoubleArray>(name, rows, get)); };
  // The name that ParaView's charts take for their x axis by themselves.
  number("Time", [](const AccuracyRow& row) { return row.p50_nanoseconds; });
  number("Bytes", [](const AccuracyRow& row) { return row.bytes; });
  number("PrecomputeSeconds", [](const AccuracyRow& row) { return row.precompute_seconds; });
  for (const AccuracyRow& first : rows)
  {
    if (!table->GetColumnByName(first.method.c_str()))
    {
      constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
      number(first.method,
        [&](const AccuracyRow& row)
        { return row.method == first.method ? PerCent * row.mean_error : nothing; });
    }
  }
}

/// @param get The vector of a point.
template <class Get>
void AddVectors(
  vtkPolyData* data, const char* name, const std::vector<AccuracyPoint>& all, const Get& get)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(3);
  for (const AccuracyPoint& point : all)
  {
    const palpate::Vec3 vector = get(point);
    array->InsertNextTuple(vector.data());
  }
  data->GetPointData()->AddArray(array);
}

void FillPoints(const palpate::TouchSpace& space, const AccuracyResult& result, vtkPolyData* data)
{
  data->Initialize();
  const std::vector<AccuracyPoint>& all = result.points;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices;
  for (const AccuracyPoint& point : all)
  {
    const palpate::Vec3 place =
      space.find({ point.active_node, point.body })->setup.interaction.material_point +
      point.exact.t;
    vertices->InsertNextCell({ points->InsertNextPoint(place.data()) });
  }
  data->SetPoints(points);
  data->SetVerts(vertices);

  vtkPointData* arrays = data->GetPointData();
  const auto integers = [&](const char* name, auto&& get)
  { arrays->AddArray(Column<vtkIntArray>(name, all, get)); };
  arrays->AddArray(Column<vtkIdTypeArray>(
    "ActiveNode", all, [](const AccuracyPoint& point) { return point.active_node; }));
  if (space.has_other_bodies())
  {
    arrays->AddArray(Column<vtkIdTypeArray>(
      "BodyNumber", all, [](const AccuracyPoint& point) { return point.body; }));
  }
  integers("Kind", [](const AccuracyPoint& p) { return static_cast<int>(p.exact.kind); });
  AddVectors(data, "Displacement", all, [](const AccuracyPoint& p) { return p.exact.t; });
  AddVectors(data, "Force", all, [](const AccuracyPoint& p) { return p.exact.force; });
  const auto isFiner = [](const AccuracyPoint& point) { return point.finer.has_value(); };
  if (std::any_of(all.begin(), all.end(), isFiner))
  {
    const palpate::Vec3 nothing = palpate::Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    AddVectors(data, "MeasuredMeshError", all,
      [&](const AccuracyPoint& p)
      { return p.finer ? palpate::Vec3(p.exact.force - *p.finer) : nothing; });
  }
  arrays->AddArray(Column<vtkDoubleArray>(
    "Energy", all, [](const AccuracyPoint& point) { return point.exact.energy; }));
  integers("Outcome", [](const AccuracyPoint& p) { return static_cast<int>(p.exact.outcome); });
  integers("Flags", [](const AccuracyPoint& p) { return p.exact.flags; });
  integers("Found", [](const AccuracyPoint& p) { return static_cast<int>(p.support); });
  integers("Class", [](const AccuracyPoint& p) { return static_cast<int>(p.point_class); });
  for (std::size_t m = 0; m < result.methods.size(); ++m)
  {
    const std::string name = "Error (" + result.methods[m] + ')';
    arrays->AddArray(Column<vtkDoubleArray>(
      name, all, [m](const AccuracyPoint& point) { return PerCent * point.errors[m]; }));
    if (m == 0 || result.methods[m] == to_string(palpate::Method::energy_hermite))
    {
      arrays->SetActiveScalars(name.c_str());
    }
  }
}

void AddRun(const AccuracyResult& result, int numberOfRanks, vtkFieldData* fields)
{
  const auto add = [&](const char* name, double value)
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->InsertNextValue(value);
    fields->AddArray(array);
  };
  add("Ranks", numberOfRanks);
  add("Solved", static_cast<double>(result.num_solved));
  add("Reused", static_cast<double>(result.num_reused));
  add("ExactSeconds", result.exact_seconds);
  add("MeasureSeconds", result.measure_seconds);
  add("SolveSeconds", result.mean_solve_seconds);
  add("Complete", result.complete ? 1 : 0);
}
}

vtkStandardNewMacro(vtkPalpateAccuracyReport);

vtkPalpateAccuracyReport::vtkPalpateAccuracyReport()
{
  this->SetNumberOfOutputPorts(4);
}

vtkPalpateAccuracyReport::~vtkPalpateAccuracyReport() = default;

void vtkPalpateAccuracyReport::AddMethod(int method)
{
  this->Methods.push_back(method);
  this->Modified();
}

void vtkPalpateAccuracyReport::ClearMethods()
{
  this->Methods.clear();
  this->Modified();
}

int vtkPalpateAccuracyReport::FillInputPortInformation(int, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, "vtkPartitionedDataSetCollection");
  return 1;
}

int vtkPalpateAccuracyReport::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 1 ? "vtkPolyData" : "vtkTable");
  return 1;
}

int vtkPalpateAccuracyReport::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* rows = vtkTable::GetData(outputVector, 0);
  auto* points = vtkPolyData::GetData(outputVector, 1);
  auto* rowsOfNodes = vtkTable::GetData(outputVector, 2);
  auto* chart = vtkTable::GetData(outputVector, 3);
  // Nobody else resets the abort of an earlier run.
  this->SetAbortExecute(0);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  const auto compute = [&](palpate::Communicator& communicator)
  {
    auto* input = vtkPalpateInput<vtkPartitionedDataSetCollection>(inputVector[0]);
    const int rank = communicator.rank();
    if (palpate::any(communicator, vtkPalpatePassFailure(input, rows)))
    {
      return;
    }
    palpate::TouchSpace space;
    std::vector<vtkSmartPointer<vtkUnstructuredGrid>> bodies;
    // One after the other: both are collective, and may fail on the first rank alone.
    palpate::agree(communicator, [&] { space = vtkPalpateSpaceFromCollection(input, controller); });
    palpate::agree(communicator, [&] { bodies = vtkPalpateGatherBodies(input, controller); });

    palpate::AccuracyOptions options;
    options.exact.test_points = this->TestPoints;
    options.exact.seed = this->Seed;
    options.exact.file = this->FileName;
    options.exact.equilibrium.tolerance = this->SolverTolerance;
    options.exact.equilibrium.single_precision = true;
    options.exact.equilibrium.threads = this->Threads;
    options.measures_mesh_error = this->MeasureMeshError;
    for (const int method : this->Methods)
    {
      options.methods.push_back(static_cast<palpate::Method>(method));
    }
    const std::string of = rank == 0 ? KeyOf(space, options) : "";
    const bool fileIsThere = this->FileName.empty() || std::filesystem::exists(this->FileName);
    if (!palpate::any(communicator, rank == 0 && (of != this->LastOf || !fileIsThere)))
    {
      rows->ShallowCopy(this->LastRows);
      points->ShallowCopy(this->LastPoints);
      rowsOfNodes->ShallowCopy(this->LastRowsOfNodes);
      chart->ShallowCopy(this->LastChart);
      return;
    }
    this->LastOf.clear();

    std::vector<std::shared_ptr<const palpate::Scene>> scenes;
    for (const auto& body : bodies)
    {
      scenes.push_back(
        std::make_shared<const palpate::Scene>(vtkPalpateShareSceneOfSpace(body, communicator)));
    }
    const AccuracyResult result = palpate::measure_accuracy(scenes, space, options, communicator,
      vtkPalpateProgress(this, rank, this->LogInterval, "Accuracy Report", "test points"));
    if (rank != 0)
    {
      return;
    }
    FillTable(result.rows, false, rows);
    FillPoints(space, result, points);
    FillTable(result.rows_of_tool_spaces, true, rowsOfNodes);
    FillChart(result.rows, chart);
    AddRun(result, communicator.size(), rows->GetFieldData());
    if (!result.complete)
    {
      vtkWarningMacro(
        "Aborted. " << (this->FileName.empty() ? std::string("Nothing is kept.")
                                               : "The test points that were solved are in " +
              this->FileName + ": the next run goes on from there."));
      return;
    }
    this->LastOf = of;
    this->LastRows->ShallowCopy(rows);
    this->LastPoints->ShallowCopy(points);
    this->LastRowsOfNodes->ShallowCopy(rowsOfNodes);
    this->LastChart->ShallowCopy(chart);
  };

  // On several ranks ParaView executes anew for the second output. A failure is reported once.
  const vtkMTimeType time =
    std::max(this->GetMTime(), vtkDataObject::GetData(inputVector[0])->GetMTime());
  const bool isTold = this->ErrorCode != 0 && time == this->ExecutedAt;
  this->ErrorCode = vtkPalpateProduce(isTold ? nullptr : this, rows, controller, compute);
  this->ExecutedAt = time;
  return 1;
}

void vtkPalpateAccuracyReport::UpdateEstimate()
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->Estimate = vtkPalpateEstimate(controller,
    [&]
    {
      const auto communicator = vtkPalpateCommunicator(controller);
      auto* input = vtkPartitionedDataSetCollection::SafeDownCast(this->GetInputDataObject(0, 0));
      if (!input)
      {
        vtkPalpateNothingToEstimate();
      }
      palpate::TouchSpace space;
      palpate::agree(
        *communicator, [&] { space = vtkPalpateSpaceFromCollection(input, controller); });
      // Of several bodies the last one stands for all: the first may only be shown.
      const auto scene =
        vtkPalpateSceneToEstimate(vtkPalpateBody(input, vtkPalpateLastBody(input)), controller);
      const int threads = palpate::num_threads(*communicator, this->Threads);
      if (!scene)
      {
        return std::string();
      }
      const palpate::SolveCost& cost = this->Cost.Of(*scene, threads);
      double points = 0;
      double seconds = 0;
      for (const palpate::TouchToolSpace& of : space.tool_spaces)
      {
        points += this->TestPoints;
        seconds += TimeOfPoint * this->TestPoints *
          palpate::seconds_of(palpate::work_of_configuration(of.setup.presses()), cost, true);
      }
      double bytes = palpate::solver_bytes(cost, FactorsOfReport, true);
      if (this->MeasureMeshError)
      {
        seconds *= 1 + TimeOnFinerMesh;
        bytes *= MemoryOfFinerMesh;
      }
      return "About " + vtkPalpateTellNumber(points) + " equilibria of " +
        vtkPalpateTellNumber(cost.num_unknowns) + " unknowns. They take " +
        vtkPalpateTellSeconds(seconds / communicator->size()) + " and " +
        vtkPalpateTellBytes(bytes) + " of memory a rank.";
    });
}

void vtkPalpateAccuracyReport::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "TestPoints: " << this->TestPoints << '\n'
     << indent << "Seed: " << this->Seed << '\n'
     << indent << "Methods:";
  for (const int method : this->Methods)
  {
    os << ' ' << method;
  }
  os << '\n'
     << indent << "MeasureMeshError: " << this->MeasureMeshError << '\n'
     << indent << "FileName: " << this->FileName << '\n'
     << indent << "SolverTolerance: " << this->SolverTolerance << '\n'
     << indent << "Threads: " << this->Threads << '\n'
     << indent << "LogInterval: " << this->LogInterval << '\n'
     << indent << "Estimate: " << this->Estimate << '\n';
}
