// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSolve.h"

#include "equilibrium/options.h"
#include "equilibrium/tangent_solver.h"
#include "linear/group.h"
#include "vtkMultiProcessController.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPalpateWholeSurface.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
/// The name of the choice that suits the body.
constexpr const char* AutomaticSolver = "Automatic";
/// The name of the solver that a group of ranks can share.
constexpr const char* GroupSolver = "MUMPS";
}

vtkPalpateSolve::vtkPalpateSolve()
  : LinearSolver(AutomaticSolver)
  , LinearSolverNames(vtkSmartPointer<vtkStringArray>::New())
{
  this->LinearSolverNames->InsertNextValue(AutomaticSolver);
  for (const std::string& name : palpate::tangent_solver_names())
  {
    this->LinearSolverNames->InsertNextValue(name);
  }
}

vtkPalpateSolve::~vtkPalpateSolve() = default;

vtkStringArray* vtkPalpateSolve::GetLinearSolverNames()
{
  return this->LinearSolverNames;
}

bool vtkPalpateSolve::IsSolverAutomatic() const
{
  return this->LinearSolver == AutomaticSolver;
}

std::unique_ptr<palpate::LinearSolver> vtkPalpateSolve::MakeLinearSolver(
  const palpate::Scene& scene, int threads) const
{
  return this->IsSolverAutomatic() ? palpate::choose_tangent_solver(scene, threads)
                                   : palpate::make_tangent_solver(this->LinearSolver);
}

palpate::EquilibriumOptions vtkPalpateSolve::SolverOptions(int threads, double iterationsAtHalf)
{
  palpate::EquilibriumOptions options;
  options.threads = threads;
  options.tolerance = this->Tolerance;
  options.max_iterations = this->MaximumIterations;
  options.max_seconds = this->MaximumSeconds;
  options.abort_requested = [this, iterationsAtHalf, iterations = std::make_shared<double>(0)]
  {
    ++*iterations;
    // ParaView handles its events, an abort among them, when it hears of progress.
    this->UpdateProgress(*iterations / (*iterations + iterationsAtHalf));
    return this->GetAbortExecute() != 0;
  };
  return options;
}

bool vtkPalpateSolve::SolvesTogether(const palpate::Scene& scene, int numRanks) const
{
  const bool suits = this->LinearSolver == GroupSolver ||
    (this->IsSolverAutomatic() && palpate::linear_solver_names().front() == GroupSolver &&
      !palpate::may_do_without_factor(scene));
  return numRanks > 1 && suits && this->IsOneSystem() &&
    palpate::count_unknowns(scene) >= this->GroupUnknowns;
}

void vtkPalpateSolve::SolveOnRanks(vtkInformationVector** inputs,
  palpate::Communicator& communicator, vtkUnstructuredGrid* output, const SetUpScene& setUp,
  const SolveScene& solve)
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  // On rank 0 alone.
  vtkSmartPointer<vtkUnstructuredGrid> body;
  const palpate::Scene* scene = nullptr;
  palpate::agree(communicator,
    [&]
    {
      body =
        vtkPalpateGatherBody(vtkPalpateInput<vtkUnstructuredGrid>(inputs[BodyPort]), controller);
      const auto surface = this->Tool && this->Tool->HasShapeOfSurface()
        ? vtkPalpateGatherSurface(vtkPalpateInput<vtkPolyData>(inputs[SurfacePort]), controller)
        : nullptr;
      if (body && !vtkPalpatePassFailure(body, output))
      {
        scene = &setUp(body, surface);
      }
    });

  const bool together =
    palpate::any(communicator, scene && this->SolvesTogether(*scene, communicator.size()));
  const int threads = palpate::num_threads(communicator, this->Threads);
  const void* comm = together ? vtkPalpateMpiComm(controller) : nullptr;
  palpate::agree(communicator,
    [&]
    {
      if (together)
      {
        palpate::prepare_group_solver();
      }
    });
  if (scene)
  {
    solve(body,
      together ? palpate::make_group_solver(comm) : this->MakeLinearSolver(*scene, threads),
      threads);
  }
  else if (together)
  {
    palpate::serve_group_solver(comm);
  }
}

void vtkPalpateSolve::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Tolerance: " << this->Tolerance << '\n'
     << indent << "MaximumIterations: " << this->MaximumIterations << '\n'
     << indent << "GroupUnknowns: " << this->GroupUnknowns << '\n'
     << indent << "LinearSolver: " << this->LinearSolver << '\n';
}
