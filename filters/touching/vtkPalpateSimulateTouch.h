// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateSimulateTouch
 * @brief the motion of a reduced model as tools move it along given paths, as a hand would
 *
 * Inputs: a body with its reduced model (vtkPalpateReducedModel.h); the paths of the tools, a table
 * (vtkPalpateToolPath.h), of the displacement of each active node. The steps are those that the
 * haptic loop takes.
 *
 * First output: the body at the time that is asked for, s, with the point array `Displacement` (m)
 * and the field arrays `Time` (s), `ReactionForce` (N, a tuple a tool), `Trust`, `Outcome`. Second
 * output: a table of all steps,
 *
 *   `Time` (s), `KineticEnergy`, `ElasticEnergy`, `ViscousEnergy`, `Dissipated`, `Work` (J),
 *   `Position0`, … (m) and `Force0`, … (N) of each tool, `Trust`, `MinimumDetF`, `Residual`,
 *   `Iterations`, `Tangents`, `Halvings`, `Outcome`, `StepSeconds` (s)
 *
 * The outcomes are those of palpate::ReducedOutcome. The whole result is on rank 0.
 */
#pragma once

#include <memory>
#include <vector>

#include "PalpateTouchingModule.h"
#include "vtkUnstructuredGridAlgorithm.h"

class vtkTable;
template <class Run>
class vtkPalpateKeptRun;

class PALPATETOUCHING_EXPORT vtkPalpateSimulateTouch : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpateSimulateTouch* New();
  vtkTypeMacro(vtkPalpateSimulateTouch, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The motion goes from 0 to this time, s; above 0.
  vtkSetMacro(EndTime, double);
  vtkGetMacro(EndTime, double);
  ///@}
  ///@{
  /// Time steps of the output in a second, above 0.
  vtkSetMacro(FrameRate, double);
  vtkGetMacro(FrameRate, double);
  ///@}
  ///@{
  /// The length of a step, s; above 0.
  vtkSetMacro(TimeStep, double);
  vtkGetMacro(TimeStep, double);
  ///@}

protected:
  vtkPalpateSimulateTouch();
  ~vtkPalpateSimulateTouch() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateSimulateTouch(const vtkPalpateSimulateTouch&) = delete;
  void operator=(const vtkPalpateSimulateTouch&) = delete;

  /// The simulated motion, on the rank that has the body.
  struct Run;

  void Simulate(vtkUnstructuredGrid* body, vtkTable* paths, Run& run);
  void Show(const Run& run, double time, vtkUnstructuredGrid* output, vtkTable* history) const;

  double EndTime = 1;
  double FrameRate = 50;
  double TimeStep = 0.002;

  std::unique_ptr<vtkPalpateKeptRun<Run>> LastRun;
};
