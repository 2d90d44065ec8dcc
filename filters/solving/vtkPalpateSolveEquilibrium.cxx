// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSolveEquilibrium.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "assembly/piece_support.h"
#include "assembly/supports.h"
#include "base/error.h"
#include "base/memory_error.h"
#include "discretisation/mesh_error_estimate.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/solve_cost.h"
#include "equilibrium/tangent_solver.h"
#include "interaction/held_points.h"
#include "interaction/interaction.h"
#include "interaction/mesh_error.h"
#include "interaction/rigid_tool.h"
#include "soft_contact/soft_contact.h"
#include "tearing/pressed_sides.h"
#include "tearing/tearing_body.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateEstimate.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFields.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpateOpenedGrid.h"
#include "vtkPalpatePartContact.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateSceneToEstimate.h"
#include "vtkPalpateStress.h"
#include "vtkPalpateToolRoute.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

namespace
{
/// How many iterations go by until the progress bar is half full. How many there will be is not
/// known; a solve of a moderate displacement has about ten.
constexpr double IterationsAtHalf = 10;
/// A rigid tool comes from where it touches nothing: in so many steps as a rule.
constexpr double StepsOfContact = 3;
/// A body that may tear is solved for at its stage and at the next one.
constexpr double BodiesOfTear = 2;

void AddResult(
  vtkUnstructuredGrid* output, const vtkPalpateToolRoute& route, const palpate::Equilibrium& state)
{
  output->GetPointData()->AddArray(vtkPalpateNodalArray(vtkPalpateArray::Displacement, state.u));
  output->GetPointData()->SetActiveVectors(vtkPalpateArray::Displacement);
  output->GetPointData()->SetActiveScalars(vtkPalpateArray::Displacement);

  const Eigen::VectorXd force = route.ForceOf(state.reaction);
  const Eigen::MatrixXd stiffness = state.stiffness.topLeftCorner(force.size(), force.size());
  vtkPalpateAddField<vtkDoubleArray>(output, "ReactionForce", 3, force);
  vtkPalpateAddField<vtkDoubleArray>(
    output, "HapticStiffness", static_cast<int>(stiffness.size()), stiffness);
  vtkPalpateAddNumber(output, "Energy", state.energy);
  vtkPalpateAddInteger(output, "Outcome", static_cast<int>(state.outcome));
  vtkPalpateAddInteger(output, "Flags", state.flags);
  vtkPalpateAddText(output, "Message", state.summary.message);
  vtkPalpateAddInteger(output, "Iterations", state.summary.iterations);
  vtkPalpateAddInteger(output, "Steps", state.summary.steps);
  vtkPalpateAddNumber(output, "Seconds", state.summary.seconds);
  vtkPalpateAddNumber(output, "Residual", state.summary.residual);
  vtkPalpateAddNumber(output, "DisplacementError", state.displacement_error);
  vtkPalpateAddNumber(output, "MinimumDetF", state.minimum_det_f);
  vtkPalpateAddInteger(output, "NegativePivots", state.negative_pivots);
  if (!std::isnan(state.lowest_eigenvalue))
  {
    vtkPalpateAddNumber(output, "LowestEigenvalue", state.lowest_eigenvalue);
  }
}

/// An array of rows, which have five columns.
vtkSmartPointer<vtkDoubleArray> MakeTable(
  const char* title, const std::array<const char*, 5>& columns)
{
  auto table = vtkSmartPointer<vtkDoubleArray>::New();
  table->SetName(title);
  table->SetNumberOfComponents(static_cast<int>(columns.size()));
  int component = 0;
  for (const char* name : columns)
  {
    table->SetComponentName(component++, name);
  }
  return table;
}

void AddFolds(vtkDataObject* output, const std::vector<palpate::Fold>& folds)
{
  constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();
  const auto table =
    MakeTable("Folds", { "Way", "EnergyBefore", "EnergyAfter", "ForceBefore", "ForceAfter" });
  for (const palpate::Fold& fold : folds)
  {
    const double row[] = { fold.way, fold.energy, fold.lands ? fold.landing_energy : Nothing,
      fold.reaction.norm(), fold.lands ? fold.landing_reaction.norm() : Nothing };
    table->InsertNextTuple(row);
  }
  output->GetFieldData()->AddArray(table);
}

void AddTears(
  vtkDataObject* output, const palpate::TearingBody& torn, const vtkPalpateToolRoute& way)
{
  const auto table = MakeTable("Tears", { "Way", "Stage", "Area", "EnergyBefore", "EnergyAfter" });
  const double length = (way.End - way.Start).norm();
  for (const palpate::Tear& tear : torn.tears())
  {
    const double row[] = { (tear.t - way.Start).norm() / length, static_cast<double>(tear.stage),
      torn.scene().body.cut.areas[static_cast<std::size_t>(tear.stage)], tear.energy_before,
      tear.energy_after };
    table->InsertNextTuple(row);
  }
  output->GetFieldData()->AddArray(table);
}

/// The point array `Displacement` [3 × points], m; empty: there is none.
palpate::NodalVector DisplacementOf(vtkUnstructuredGrid* body)
{
  vtkDataArray* array = body->GetPointData()->GetArray(vtkPalpateArray::Displacement);
  if (!array || array->GetNumberOfComponents() != 3)
  {
    return {};
  }
  palpate::NodalVector u(3 * array->GetNumberOfTuples());
  for (vtkIdType point = 0; point < array->GetNumberOfTuples(); ++point)
  {
    array->GetTuple(point, u.data() + 3 * point);
  }
  return u;
}

/// The mean toughness of the tissues at the cut, J/m².
double ToughnessAtCut(const palpate::Cut& cut, vtkUnstructuredGrid* body)
{
  vtkDataArray* array = body->GetCellData()->GetArray(vtkPalpateArray::FractureToughness);
  double sum = 0;
  int count = 0;
  for (std::size_t cell = 0; cell < cut.faces.size(); ++cell)
  {
    if (std::none_of(cut.faces[cell].begin(), cut.faces[cell].end(), palpate::opens))
    {
      continue;
    }
    const double toughness = array ? array->GetComponent(static_cast<vtkIdType>(cell), 0) : 0;
    if (!(toughness > 0))
    {
      throw palpate::InputError(
        "FractureToughness is below 0, but a tissue at the cut has no toughness: of those of "
        "Assign "
        "Material, only Liver has one. Set FractureToughness to a number, J/m².");
    }
    sum += toughness;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

void AddCells(vtkUnstructuredGrid* output, const char* name, const std::vector<double>& values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  output->GetCellData()->AddArray(array);
}

}

vtkStandardNewMacro(vtkPalpateSolveEquilibrium);

vtkPalpateSolveEquilibrium::vtkPalpateSolveEquilibrium()
{
  this->ActiveNodes = { 0 };
}

vtkPalpateSolveEquilibrium::~vtkPalpateSolveEquilibrium() = default;

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

int vtkPalpateSolveEquilibrium::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkUnstructuredGrid");
  return 1;
}

int vtkPalpateSolveEquilibrium::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkUnstructuredGrid::GetData(outputVector);
  // A request that ended the run before is not for this one, and nobody else takes it back.
  this->SetAbortExecute(0);
  const auto compute = [&](palpate::Communicator& communicator)
  {
    palpate::Scene scene;
    vtkPalpateToolRoute route;
    vtkSmartPointer<vtkPolyData> toolSurface;
    const auto setUp = [&](vtkUnstructuredGrid* body, vtkPolyData* surface) -> const palpate::Scene&
    {
      scene = vtkPalpateSceneFromGrid(body, palpate::Vec3(this->BodyForce));
      toolSurface = surface;
      route = this->MakeRoute(scene, surface);
      // Loads act before a tool holds anything.
      palpate::PieceSupport(scene).require_held(
        scene.has_load() ? std::vector<palpate::Index>() : palpate::held_points(*route.Tool));
      return scene;
    };
    const auto solve = [&](vtkUnstructuredGrid* body,
                         std::unique_ptr<palpate::LinearSolver> linearSolver, int threads)
    {
      palpate::with_memory("to solve for the equilibrium of the body",
        [&]
        {
          if (this->FractureToughness != 0)
          {
            const auto makeRoute = [&](const palpate::Scene& atStage)
            { return this->MakeRoute(atStage, toolSurface); };
            this->Tear(scene, makeRoute, threads, body, output);
            return;
          }
          output->ShallowCopy(body);
          this->Solve(scene, route, std::move(linearSolver), threads, output);
        });
    };
    this->SolveOnRanks(inputVector, communicator, output, setUp, solve);
  };

  this->ErrorCode =
    vtkPalpateProduce(this, output, vtkMultiProcessController::GetGlobalController(), compute);
  return 1;
}

void vtkPalpateSolveEquilibrium::UpdateEstimate()
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->Estimate = vtkPalpateEstimate(controller,
    [&]
    {
      const auto scene =
        vtkPalpateSceneToEstimate({ vtkPointSet::SafeDownCast(this->GetInputDataObject(0, 0)) },
          controller, palpate::Vec3(this->BodyForce));
      const int threads = palpate::num_threads(*vtkPalpateCommunicator(controller), this->Threads);
      if (!scene)
      {
        return std::string();
      }
      const palpate::SolveCost& cost = this->Cost.Of(*scene, threads);
      const palpate::EquilibriumOptions options;
      const bool isRigid = this->Tool != nullptr;
      palpate::WorkCount work = palpate::work_of_equilibrium();
      work.right_hand_sides += 3. * static_cast<double>(this->ActiveNodes.size());
      const double seconds = this->Increments * (isRigid ? StepsOfContact : 1) *
        (this->FractureToughness != 0 ? BodiesOfTear : 1) *
        palpate::seconds_of(work, cost, options.single_precision);
      return "An equilibrium of " + vtkPalpateTellNumber(cost.num_unknowns) +
        " unknowns. It takes " + vtkPalpateTellSeconds(seconds) + " and " +
        vtkPalpateTellBytes(
          palpate::solver_bytes(cost, options.kept_factors, options.single_precision)) +
        " of memory.";
    });
}

std::unique_ptr<palpate::LinearSolver> vtkPalpateSolveEquilibrium::MakeLinearSolver(
  const palpate::Scene& scene, int threads) const
{
  return this->EstimateCondition && this->IsSolverAutomatic()
    ? palpate::make_linear_solver()
    : this->Superclass::MakeLinearSolver(scene, threads);
}

vtkPalpateToolRoute vtkPalpateSolveEquilibrium::MakeRoute(
  const palpate::Scene& scene, vtkPolyData* surface) const
{
  if (!this->Tool)
  {
    return vtkPalpateBondedRoute(scene, this->ActiveNodes, this->TipRadius,
      Eigen::Map<const Eigen::VectorXd>(
        this->Displacements.data(), static_cast<Eigen::Index>(this->Displacements.size())));
  }
  palpate::RigidTool tool = this->Tool->Describe(surface);
  palpate::turn(tool,
    { this->ToolOrientation[0], this->ToolOrientation[1], this->ToolOrientation[2],
      this->ToolOrientation[3] });
  return vtkPalpateContactRoute(scene, tool, palpate::Vec3(this->ToolPosition));
}

void vtkPalpateSolveEquilibrium::AddContact(const palpate::Scene& scene,
  const vtkPalpateToolRoute& route, const palpate::Equilibrium& state, vtkUnstructuredGrid* output)
{
  const palpate::RigidContact::Patch patch = route.Contact->patch(state.t, state.u);
  vtkNew<vtkDoubleArray> pressure;
  pressure->SetName(vtkPalpateArray::ContactPressure);
  pressure->SetNumberOfTuples(static_cast<vtkIdType>(patch.pressure.size()));
  std::copy(patch.pressure.begin(), patch.pressure.end(), pressure->GetPointer(0));
  output->GetPointData()->AddArray(pressure);
  vtkPalpateAddNumber(output, "ContactArea", patch.area);
  if (const auto torque = palpate::torque_of(route.Rigid, state.t, state.reaction))
  {
    vtkPalpateAddField<vtkDoubleArray>(output, "ReactionTorque", 3, *torque);
  }
  const double layerForce = palpate::contact_layer_force(
    patch.layer_depth, state.reaction.head<3>(), state.stiffness.topLeftCorner<3, 3>());
  vtkPalpateAddNumber(output, "ContactLayerForce", layerForce);
  const double meshError =
    palpate::expected_mesh_error(scene.body.mesh.order, patch.longest_edge, patch.area);
  vtkPalpateAddNumber(output, "ContactMeshError", meshError);
  const double radius = 0.5 * route.Contact->shape().bounds().sizes().minCoeff();
  if (patch.longest_edge > radius)
  {
    vtkWarningMacro("The edges of the mesh under the tool are up to "
      << patch.longest_edge << " m long, and the tool's radius is " << radius
      << " m. Such cells are too stiff: expect a force that is too large by "
      << (this->EstimateMeshError ? std::string("what MeshError says")
                                  : "about " + std::to_string(std::lround(100 * meshError)) + " %")
      << ", and that ripples along the surface, by 2 to 3 % of it where edges are as long as the "
         "radius and 10 to 12 % where they are twice as long. Mesh the body more finely there.");
  }
}

void vtkPalpateSolveEquilibrium::AddMeshError(const palpate::Scene& scene,
  const vtkPalpateToolRoute& route, const palpate::EquilibriumSolver& solver,
  const palpate::Equilibrium& state, vtkUnstructuredGrid* output)
{
  const palpate::MeshErrorEstimate estimate =
    palpate::MeshErrorEstimator(scene, solver.assembly()).estimate(state, *route.Tool);
  vtkPalpateAddField<vtkDoubleArray>(output, "MeshError", 3, route.ForceOf(estimate.force));
  if (route.Contact)
  {
    if (const auto torque = palpate::torque_of(route.Rigid, state.t, estimate.force))
    {
      vtkPalpateAddField<vtkDoubleArray>(output, "MeshErrorTorque", 3, *torque);
    }
  }
  vtkPalpateAddInteger(output, "MeshErrorReliable", estimate.is_reliable ? 1 : 0);
  AddCells(output, "MeshErrorEnergy", estimate.energy_of_cells);
  if (estimate.is_reliable)
  {
    return;
  }
  std::string why =
    "It is made for quadratic cells, for cells that are not too large for what the tool does to "
    "them, and for tissues whose stiffness hardly changes within the error of the strain. Choose "
    "quadratic cells where the body is meshed (ElementOrder), or mesh it more finely where "
    "MeshErrorEnergy is large.";
  if (estimate.is_bonded_to_few)
  {
    why = "A tool is bonded to fewer than " + std::to_string(palpate::kFewestHeldFaces) +
      " faces of the body: at the rim of a bonded tip the stress is infinite, and only with enough "
      "faces under it is the share of the rim known; of a force that holds a single point "
      "(TipRadius below the edges of the cells) all is error. Give the tool a TipRadius of at "
      "least "
      "two edges, or mesh the body more finely there.";
  }
  else if (estimate.is_mixed)
  {
    why = "The body has mixed cells (a Formulation of the material): they keep their volume in "
          "the mean alone, and the error is between a quarter of the estimate and twice of it. "
          "MeshErrorEnergy says all the same where the body should be meshed more finely.";
  }
  vtkPalpateWarn(
    this, "The estimate of the error of the mesh (MeshError) cannot be trusted. " + why);
}

void vtkPalpateSolveEquilibrium::Solve(const palpate::Scene& scene, vtkPalpateToolRoute& route,
  std::unique_ptr<palpate::LinearSolver> linearSolver, int threads, vtkUnstructuredGrid* output)
{
  const palpate::EquilibriumOptions options = this->SolverOptions(threads, IterationsAtHalf);
  const vtkPalpateFollowOptions follow = { this->Increments,
    this->IsSolverAutomatic() && !linearSolver };
  palpate::EquilibriumSolver solver(scene, options, std::move(linearSolver));
  if (this->StartFromDisplacement)
  {
    route.Near = DisplacementOf(output);
    const auto contact = palpate::make_soft_contact(scene);
    if (contact && scene.body.cut.stage > 0 && route.Near.size() > 0)
    {
      route.Near = palpate::press_sides(scene, solver.assembly(), *contact, std::move(route.Near));
    }
  }
  const palpate::Equilibrium state = vtkPalpateFollow(scene, route, follow, options, solver);
  this->AddState(scene, route, solver, state, output);
}

void vtkPalpateSolveEquilibrium::Tear(const palpate::Scene& scene,
  const std::function<vtkPalpateToolRoute(const palpate::Scene&)>& makeRoute, int threads,
  vtkUnstructuredGrid* body, vtkUnstructuredGrid* output)
{
  const palpate::EquilibriumOptions options = this->SolverOptions(threads, IterationsAtHalf);
  const vtkPalpateToolRoute way = makeRoute(scene);
  palpate::TearingBody torn(
    scene,
    this->FractureToughness < 0 ? ToughnessAtCut(scene.body.cut, body) : this->FractureToughness,
    way.Start, [&](const palpate::Scene& atStage) { return std::move(makeRoute(atStage).Tool); },
    [&](const palpate::Scene& atStage) {
      return palpate::EquilibriumSolver(atStage, options, this->MakeLinearSolver(atStage, threads));
    });
  const Eigen::VectorXd whole = way.End - way.Start;
  for (int part = 1; part <= this->Increments; ++part)
  {
    torn.move(way.Start + part * whole / this->Increments);
  }
  output->ShallowCopy(vtkPalpateOpenedGrid(body, torn.scene().body.mesh, torn.originals()));
  vtkPalpateWriteCut(torn.scene().body.cut, output);
  palpate::Equilibrium state = torn.state();
  for (palpate::Fold& fold : state.summary.folds)
  {
    fold.way = (fold.t - way.Start).norm() / whole.norm();
  }
  this->AddState(torn.scene(), makeRoute(torn.scene()), torn.solver(), state, output);
  vtkPalpateAddNumber(output, "TornArea", torn.scene().body.cut.area());
  vtkPalpateAddNumber(output, "ReleaseRate", torn.release_rate());
  if (!torn.tears().empty())
  {
    AddTears(output, torn, way);
  }
}

void vtkPalpateSolveEquilibrium::AddState(const palpate::Scene& scene,
  const vtkPalpateToolRoute& route, palpate::EquilibriumSolver& solver,
  const palpate::Equilibrium& state, vtkUnstructuredGrid* output)
{
  // What is added to each point and each cell, in numbers, at the most.
  constexpr std::size_t perPoint = 30;
  constexpr std::size_t perCell = 20;
  palpate::require_memory(sizeof(double) *
      (perPoint * scene.body.mesh.points.size() +
        perCell * static_cast<std::size_t>(scene.body.mesh.num_cells())),
    "for the deformed body");
  AddResult(output, route, state);
  vtkPalpateAddInteger(output, "Unknowns", solver.assembly().pattern().size);
  AddCells(output, "MinimumDetF", solver.assembly().minimum_det_f_of_cells(state.u));
  if (this->Stress)
  {
    const palpate::BodyStress stress =
      palpate::find_stress(solver.assembly(), scene.body.mesh, state.u, state.p);
    vtkPalpateAddStress(stress.of_cells, output->GetCellData());
    vtkPalpateAddStress(stress.at_points, output->GetPointData());
  }
  if (route.Contact)
  {
    this->AddContact(scene, route, state, output);
  }
  if (const auto contact = palpate::make_soft_contact(scene))
  {
    vtkPalpateAddPartContact(*contact, state.u, output);
    // A body that finds no rest has no sensitivity.
    if (state.v.cols() > 0)
    {
      vtkPalpateAddField<vtkDoubleArray>(
        output, "PartLayerForce", 3, route.ForceOf(contact->layer_force(state.u, state.v)));
    }
  }
  if (this->EstimateMeshError && state.v.size() > 0)
  {
    this->AddMeshError(scene, route, solver, state, output);
  }
  if (!state.summary.folds.empty())
  {
    AddFolds(output, state.summary.folds);
  }
  if (this->EstimateCondition)
  {
    vtkPalpateAddNumber(output, "Condition", solver.condition(state));
  }
  if (!state.summary.message.empty())
  {
    vtkPalpateWarn(this, state.summary.message);
  }
}

void vtkPalpateSolveEquilibrium::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Displacements:";
  for (const double component : this->Displacements)
  {
    os << ' ' << component;
  }
  os << " m\n"
     << indent << "ToolPosition: " << this->ToolPosition[0] << ' ' << this->ToolPosition[1] << ' '
     << this->ToolPosition[2] << " m\n"
     << indent << "ToolOrientation: " << this->ToolOrientation[0] << ' ' << this->ToolOrientation[1]
     << ' ' << this->ToolOrientation[2] << ' ' << this->ToolOrientation[3] << '\n'
     << indent << "Increments: " << this->Increments << '\n'
     << indent << "EstimateCondition: " << this->EstimateCondition << '\n'
     << indent << "EstimateMeshError: " << this->EstimateMeshError << '\n'
     << indent << "Stress: " << this->Stress << '\n'
     << indent << "StartFromDisplacement: " << this->StartFromDisplacement << '\n'
     << indent << "FractureToughness: " << this->FractureToughness << " J/m2\n"
     << indent << "Estimate: " << this->Estimate << '\n';
}
