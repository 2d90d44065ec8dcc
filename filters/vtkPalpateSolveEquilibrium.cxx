// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSolveEquilibrium.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "equilibrium/equilibrium.h"
#include "equilibrium/solve_cost.h"
#include "equilibrium/tangent_solver.h"
#include "interaction/bonded_patch.h"
#include "interaction/tool_clearance.h"
#include "linear/group.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateActiveNodes.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateEstimate.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateRigidTool.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateStress.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPalpateWholeSurface.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
constexpr const char* AutomaticSolver = "Automatic";
/// The one that a group of ranks can share.
constexpr const char* GroupSolver = "MUMPS";
/// How many iterations go by until the progress bar is half full. How many there will be is not
/// known; a solve of a moderate displacement has about ten.
constexpr double IterationsAtHalf = 10;
/// A rigid tool comes from where it touches nothing: in so many steps as a rule.
constexpr double StepsOfContact = 3;
/// A factor of more takes too long to be made without being asked for.
constexpr long MostUnknownsTriedAgain = 150000;

/// One row after the other, as tuples of `components`.
template <class Array, class Matrix>
void AddField(vtkDataObject* output, const char* name, int components, const Matrix& values)
{
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(values.size() / components);
  vtkIdType next = 0;
  for (Eigen::Index row = 0; row < values.rows(); ++row)
  {
    for (Eigen::Index column = 0; column < values.cols(); ++column)
    {
      array->SetValue(next++, values(row, column));
    }
  }
  output->GetFieldData()->AddArray(array);
}

void AddNumber(vtkDataObject* output, const char* name, double value)
{
  AddField<vtkDoubleArray>(output, name, 1, Eigen::Matrix<double, 1, 1>(value));
}

void AddInteger(vtkDataObject* output, const char* name, int value)
{
  AddField<vtkIntArray>(output, name, 1, Eigen::Matrix<int, 1, 1>(value));
}

void AddResult(vtkUnstructuredGrid* output, const palpate::Equilibrium& state)
{
  output->GetPointData()->AddArray(vtkPalpateNodalArray(vtkPalpateArray::Displacement, state.u));
  output->GetPointData()->SetActiveVectors(vtkPalpateArray::Displacement);
  output->GetPointData()->SetActiveScalars(vtkPalpateArray::Displacement);

  AddField<vtkDoubleArray>(output, "ReactionForce", 3, state.reaction);
  AddField<vtkDoubleArray>(
    output, "HapticStiffness", static_cast<int>(state.stiffness.size()), state.stiffness);
  AddNumber(output, "Energy", state.energy);
  AddInteger(output, "Outcome", static_cast<int>(state.outcome));
  AddInteger(output, "Flags", state.flags);
  vtkNew<vtkStringArray> message;
  message->SetName("Message");
  message->InsertNextValue(state.message);
  output->GetFieldData()->AddArray(message);
  AddInteger(output, "Iterations", state.iterations);
  AddInteger(output, "Steps", state.steps);
  AddNumber(output, "Seconds", state.seconds);
  AddNumber(output, "Residual", state.residual);
  AddNumber(output, "DisplacementError", state.displacement_error);
  AddNumber(output, "MinimumDetF", state.minimum_det_f);
  AddInteger(output, "NegativePivots", state.negative_pivots);
  if (!std::isnan(state.lowest_eigenvalue))
  {
    AddNumber(output, "LowestEigenvalue", state.lowest_eigenvalue);
  }
}

void AddFolds(vtkDataObject* output, const std::vector<palpate::Fold>& folds)
{
  constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();
  vtkNew<vtkDoubleArray> array;
  array->SetName("Folds");
  array->SetNumberOfComponents(5);
  int component = 0;
  for (const char* name : { "Way", "EnergyBefore", "EnergyAfter", "ForceBefore", "ForceAfter" })
  {
    array->SetComponentName(component++, name);
  }
  for (const palpate::Fold& fold : folds)
  {
    const double row[] = { fold.way, fold.energy, fold.lands ? fold.landing_energy : Nothing,
      fold.reaction.norm(), fold.lands ? fold.landing_reaction.norm() : Nothing };
    array->InsertNextTuple(row);
  }
  output->GetFieldData()->AddArray(array);
}

void AddCells(vtkUnstructuredGrid* output, const char* name, const std::vector<double>& values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  output->GetCellData()->AddArray(array);
}

/// Solves for the equal parts of the way from where a tool starts to t, one after the other, as far
/// as they converge.
palpate::Equilibrium Follow(palpate::EquilibriumSolver& solver, const Eigen::VectorXd& start,
  const Eigen::VectorXd& t, int increments)
{
  palpate::Equilibrium state = solver.rest(start);
  for (int increment = 0; increment < increments && state.outcome == palpate::Outcome::converged;
       ++increment)
  {
    palpate::Equilibrium next = solver.solve(increment + 1 == increments
        ? t
        : Eigen::VectorXd(start + (t - start) * (increment + 1) / increments),
      state);
    next.iterations += state.iterations;
    next.steps += state.steps;
    next.seconds += state.seconds;
    for (palpate::Fold& fold : next.folds)
    {
      fold.way = (increment + fold.way) / increments;
    }
    next.folds.insert(next.folds.begin(), state.folds.begin(), state.folds.end());
    state = std::move(next);
  }
  return state;
}

}

vtkStandardNewMacro(vtkPalpateSolveEquilibrium);

struct vtkPalpateSolveEquilibrium::Route
{
  std::unique_ptr<palpate::Interaction> Tool;
  Eigen::VectorXd Start;
  Eigen::VectorXd End;
  /// The same tool where it is a rigid one, else null.
  const palpate::RigidContact* Contact = nullptr;
};

vtkPalpateSolveEquilibrium::vtkPalpateSolveEquilibrium()
{
  this->SetNumberOfInputPorts(2);
  this->LinearSolverNames->InsertNextValue(AutomaticSolver);
  for (const std::string& name : palpate::tangent_solver_names())
  {
    this->LinearSolverNames->InsertNextValue(name);
  }
}

vtkPalpateSolveEquilibrium::~vtkPalpateSolveEquilibrium() = default;

void vtkPalpateSolveEquilibrium::AddActiveNode(vtkIdType node)
{
  this->ActiveNodes.push_back(node);
  this->Modified();
}

void vtkPalpateSolveEquilibrium::ClearActiveNodes()
{
  this->ActiveNodes.clear();
  this->Modified();
}

void vtkPalpateSolveEquilibrium::AddDisplacement(double x, double y, double z)
{
  this->Displacements.insert(this->Displacements.end(), { x, y, z });
  this->Modified();
}

void vtkPalpateSolveEquilibrium::ClearDisplacements()
{
  this->Displacements.clear();
  this->Modified();
}

vtkStringArray* vtkPalpateSolveEquilibrium::GetLinearSolverNames()
{
  return this->LinearSolverNames;
}

int vtkPalpateSolveEquilibrium::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 1)
  {
    vtkPalpateTakeWhole(info, "vtkPolyData");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
    return 1;
  }
  vtkPalpateTakeWhole(info, "vtkUnstructuredGrid");
  return 1;
}

int vtkPalpateSolveEquilibrium::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkUnstructuredGrid::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  // A request that ended the run before is not for this one, and nobody else takes it back.
  this->SetAbortExecute(0);
  const auto compute = [&]
  {
    const auto communicator = vtkPalpateCommunicator(controller);
    // On rank 0 alone.
    vtkSmartPointer<vtkUnstructuredGrid> body;
    std::optional<palpate::Scene> scene;
    Route route;
    palpate::agree(*communicator,
      [&]
      {
        body =
          vtkPalpateGatherBody(vtkPalpateInput<vtkUnstructuredGrid>(inputVector[0]), controller);
        const auto surface = this->Tool == vtkPalpateSurfaceTool
          ? vtkPalpateGatherSurface(vtkPalpateInput<vtkPolyData>(inputVector[1]), controller)
          : nullptr;
        if (!body || vtkPalpatePassFailure(body, output))
        {
          return;
        }
        scene = vtkPalpateSceneFromGrid(body);
        route = this->Tool == vtkPalpateBondedNode ? this->BondedRoute(*scene)
                                                   : this->ContactRoute(*scene, surface);
      });

    const bool together =
      palpate::any(*communicator, scene && this->SolvesTogether(*scene, communicator->size()));
    const void* comm = together ? vtkPalpateMpiComm(controller) : nullptr;
    if (scene)
    {
      auto linearSolver =
        together ? palpate::make_group_solver(comm) : this->MakeLinearSolver(*scene);
      output->ShallowCopy(body);
      this->Solve(*scene, route, std::move(linearSolver), output);
    }
    else if (together)
    {
      palpate::serve_group_solver(comm);
    }
  };

  this->ErrorCode = vtkPalpateProduce(this, output, controller, compute);
  return 1;
}

void vtkPalpateSolveEquilibrium::UpdateEstimate()
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->Estimate = vtkPalpateEstimate(controller,
    [&]
    {
      const auto scene = vtkPalpateSceneToEstimate(
        { vtkPointSet::SafeDownCast(this->GetInputDataObject(0, 0)) }, controller);
      if (!scene)
      {
        return std::string();
      }
      const palpate::SolveCost& cost = this->Cost.Of(*scene);
      const palpate::EquilibriumOptions options;
      const bool isRigid = this->Tool != vtkPalpateBondedNode;
      palpate::WorkCount work = palpate::work_of_equilibrium();
      work.right_hand_sides += 3. * static_cast<double>(this->ActiveNodes.size());
      const double seconds = this->Increments * (isRigid ? StepsOfContact : 1) *
        palpate::seconds_of(work, cost, options.single_precision);
      return "An equilibrium of " + vtkPalpateTellNumber(cost.num_unknowns) +
        " unknowns. It takes " + vtkPalpateTellSeconds(seconds) + " and " +
        vtkPalpateTellBytes(
          palpate::solver_bytes(cost, options.kept_factors, options.single_precision)) +
        " of memory.";
    });
}

bool vtkPalpateSolveEquilibrium::SolvesTogether(const palpate::Scene& scene, int numRanks) const
{
  const bool suits = this->LinearSolver == GroupSolver ||
    (this->LinearSolver == AutomaticSolver &&
      palpate::linear_solver_names().front() == GroupSolver &&
      !palpate::may_do_without_factor(scene));
  return numRanks > 1 && suits && palpate::count_unknowns(scene) >= this->GroupUnknowns;
}

std::unique_ptr<palpate::LinearSolver> vtkPalpateSolveEquilibrium::MakeLinearSolver(
  const palpate::Scene& scene) const
{
  if (this->LinearSolver != AutomaticSolver)
  {
    return palpate::make_tangent_solver(this->LinearSolver);
  }
  return this->EstimateCondition ? palpate::make_linear_solver()
                                 : palpate::choose_tangent_solver(scene);
}

vtkPalpateSolveEquilibrium::Route vtkPalpateSolveEquilibrium::BondedRoute(
  const palpate::Scene& scene) const
{
  Route route;
  route.Tool = palpate::BondedPatches(scene, this->TipRadius)
                 .around_each(vtkPalpateActiveNodes(this->ActiveNodes))
                 .clone();
  route.End = Eigen::Map<const Eigen::VectorXd>(
    this->Displacements.data(), static_cast<Eigen::Index>(this->Displacements.size()));
  route.Start = Eigen::VectorXd::Zero(route.Tool->num_coordinates());
  return route;
}

vtkPalpateSolveEquilibrium::Route vtkPalpateSolveEquilibrium::ContactRoute(
  const palpate::Scene& scene, vtkPolyData* surface)
{
  const palpate::RigidTool tool =
    palpate::with_defaults(vtkPalpateRigidTool(vtkPalpateToolPropertiesOf(*this), surface), scene);
  const palpate::RigidContact contact = palpate::make_contact(scene, tool);
  Route route;
  route.End = palpate::Vec3(this->ToolPosition);
  route.Start = palpate::ToolClearance(scene, contact).start_for(route.End);
  route.Tool = contact.clone();
  route.Contact = static_cast<const palpate::RigidContact*>(route.Tool.get());
  return route;
}

void vtkPalpateSolveEquilibrium::AddContact(
  const Route& route, const palpate::Equilibrium& state, vtkUnstructuredGrid* output)
{
  const palpate::RigidContact::Patch patch = route.Contact->patch(state.t, state.u);
  vtkNew<vtkDoubleArray> pressure;
  pressure->SetName(vtkPalpateArray::ContactPressure);
  pressure->SetNumberOfTuples(static_cast<vtkIdType>(patch.pressure.size()));
  std::copy(patch.pressure.begin(), patch.pressure.end(), pressure->GetPointer(0));
  output->GetPointData()->AddArray(pressure);
  AddNumber(output, "ContactArea", patch.area);
  const double radius = 0.5 * route.Contact->shape().bounds().sizes().minCoeff();
  if (patch.longest_edge > radius)
  {
    vtkWarningMacro("The edges of the mesh under the tool are up to "
      << patch.longest_edge << " m long, and the tool's radius is " << radius
      << " m. The force along the surface ripples by about 2 % of the force where edges are as "
         "long "
         "as the radius, and by 7 % where they are twice as long. Mesh the body more finely "
         "there.");
  }
}

void vtkPalpateSolveEquilibrium::Solve(const palpate::Scene& scene, const Route& route,
  std::unique_ptr<palpate::LinearSolver> linearSolver, vtkUnstructuredGrid* output)
{
  palpate::EquilibriumOptions options;
  options.tolerance = this->Tolerance;
  options.max_iterations = this->MaximumIterations;
  options.max_seconds = this->MaximumSeconds;
  options.abort_requested = [this, iterations = 0]() mutable
  {
    ++iterations;
    // ParaView handles its events, an abort among them, when it hears of progress.
    this->UpdateProgress(iterations / (iterations + IterationsAtHalf));
    return this->GetAbortExecute() != 0;
  };
  // What is beyond a fold, and tangents that are hard to solve for, need a factor.
  const bool mayTryAgain = this->LinearSolver == AutomaticSolver && !linearSolver &&
    palpate::count_unknowns(scene) <= MostUnknownsTriedAgain;
  palpate::EquilibriumSolver solver(scene, options, std::move(linearSolver));
  solver.set_interaction(*route.Tool);
  palpate::Equilibrium state = Follow(solver, route.Start, route.End, this->Increments);
  if (mayTryAgain &&
    (state.outcome == palpate::Outcome::not_converged ||
      state.outcome == palpate::Outcome::tangent_not_solved))
  {
    solver = palpate::EquilibriumSolver(scene, options, palpate::make_linear_solver());
    solver.set_interaction(*route.Tool);
    state = Follow(solver, route.Start, route.End, this->Increments);
  }

  AddResult(output, state);
  AddInteger(output, "Unknowns", solver.assembly().pattern().size);
  AddCells(output, "MinimumDetF", solver.assembly().minimum_det_f_of_cells(state.u));
  if (this->Stress)
  {
    const palpate::BodyStress stress =
      palpate::find_stress(solver.assembly(), scene.mesh, state.u, state.p);
    vtkPalpateAddStress(stress.of_cells, output->GetCellData());
    vtkPalpateAddStress(stress.at_points, output->GetPointData());
  }
  if (route.Contact)
  {
    this->AddContact(route, state, output);
  }
  if (!state.folds.empty())
  {
    AddFolds(output, state.folds);
  }
  if (this->EstimateCondition)
  {
    AddNumber(output, "Condition", solver.condition(state));
  }
  if (!state.message.empty())
  {
    vtkWarningMacro(<< state.message);
  }
}

void vtkPalpateSolveEquilibrium::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ActiveNodes:";
  for (const vtkIdType node : this->ActiveNodes)
  {
    os << ' ' << node;
  }
  os << '\n' << indent << "Displacements:";
  for (const double component : this->Displacements)
  {
    os << ' ' << component;
  }
  os << " m\n"
     << indent << "TipRadius: " << this->TipRadius << " m\n"
     << indent << "Tool: " << this->Tool << '\n'
     << indent << "ToolRadius: " << this->ToolRadius << " m\n"
     << indent << "ToolAxis: " << this->ToolAxis[0] << ' ' << this->ToolAxis[1] << ' '
     << this->ToolAxis[2] << '\n'
     << indent << "ToolLength: " << this->ToolLength << " m\n"
     << indent << "ToolPosition: " << this->ToolPosition[0] << ' ' << this->ToolPosition[1] << ' '
     << this->ToolPosition[2] << " m\n"
     << indent << "ContactThickness: " << this->ContactThickness << " m\n"
     << indent << "ContactStiffness: " << this->ContactStiffness << " Pa\n"
     << indent << "Tolerance: " << this->Tolerance << '\n'
     << indent << "MaximumIterations: " << this->MaximumIterations << '\n'
     << indent << "MaximumSeconds: " << this->MaximumSeconds << '\n'
     << indent << "Increments: " << this->Increments << '\n'
     << indent << "EstimateCondition: " << this->EstimateCondition << '\n'
     << indent << "Stress: " << this->Stress << '\n'
     << indent << "GroupUnknowns: " << this->GroupUnknowns << '\n'
     << indent << "LinearSolver: " << this->LinearSolver << '\n'
     << indent << "Estimate: " << this->Estimate << '\n';
}
