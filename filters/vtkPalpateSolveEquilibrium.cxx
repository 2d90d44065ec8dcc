// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSolveEquilibrium.h"

#include "equilibrium/equilibrium.h"
#include "equilibrium/tip.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateActiveNodes.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
constexpr const char* AutomaticSolver = "Automatic";
/// How many iterations go by until the progress bar is half full. How many there will be is not
/// known; a solve of a moderate displacement has about ten.
constexpr double IterationsAtHalf = 10;

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
  AddNumber(output, "Residual", state.residual);
  AddNumber(output, "MinimumDetF", state.minimum_det_f);
  AddInteger(output, "NegativePivots", state.negative_pivots);
}
}

vtkStandardNewMacro(vtkPalpateSolveEquilibrium);

vtkPalpateSolveEquilibrium::vtkPalpateSolveEquilibrium()
{
  this->LinearSolverNames->InsertNextValue(AutomaticSolver);
  for (const std::string& name : palpate::linear_solver_names())
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

int vtkPalpateSolveEquilibrium::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkUnstructuredGrid::GetData(outputVector);
  return vtkPalpateProduce(this, output,
    [&]
    {
      const auto body = vtkPalpateGatherBody(vtkUnstructuredGrid::GetData(inputVector[0]),
        vtkMultiProcessController::GetGlobalController());
      if (!body || vtkPalpatePassFailure(body, output))
      {
        return;
      }
      // A request that ended the run before is not for this one, and nobody else takes it back.
      this->SetAbortExecute(0);
      const palpate::Scene scene = vtkPalpateSceneFromGrid(body);
      const auto constraint =
        palpate::Tip(scene, this->TipRadius).hold(vtkPalpateActiveNodes(this->ActiveNodes));

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
      palpate::EquilibriumSolver solver(scene, options,
        this->LinearSolver == AutomaticSolver ? palpate::make_linear_solver()
                                              : palpate::make_linear_solver(this->LinearSolver));
      solver.hold(constraint);
      const auto t = Eigen::Map<const Eigen::VectorXd>(
        this->Displacements.data(), static_cast<Eigen::Index>(this->Displacements.size()));
      const palpate::Equilibrium state = solver.solve(t, solver.rest());

      output->ShallowCopy(body);
      AddResult(output, state);
      if (!state.message.empty())
      {
        vtkWarningMacro(<< state.message);
      }
    });
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
     << indent << "Tolerance: " << this->Tolerance << '\n'
     << indent << "MaximumIterations: " << this->MaximumIterations << '\n'
     << indent << "MaximumSeconds: " << this->MaximumSeconds << '\n'
     << indent << "LinearSolver: " << this->LinearSolver << '\n';
}
