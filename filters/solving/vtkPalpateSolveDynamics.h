// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateSolveDynamics
 * @brief the motion of a body in time, with inertia and viscosity, as tools move it along given
 * paths
 *
 * Inputs: a body with material, density and boundary (see vtkPalpateScene.h); the paths of the
 * tools, a table (vtkPalpateToolPath.h); the surface of the rigid tools, if they have the shape of
 * one. The tools are the active nodes, in their order, and then rigid tools of one shape, as many
 * as the table has columns for. The coordinates of a node are its displacement, and those of a
 * rigid tool are the place of its centre.
 *
 * First output: the body at the requested time, s, with the point array `Displacement` (m), with
 * rigid tools also the point array `ContactPressure` (Pa), and with the field arrays
 *
 *   `Time`                the time of the frame, s
 *   `ReactionForce`       the force that holds each tool, N; a tuple a tool
 *   `ContactLayerForce`   only with rigid tools: the part of the force of each that is the error of
 *                         the layer in which it presses, N, by Hertz's stiffness
 *                         (solvers/interaction/hertz_stiffness.h); a value a tool
 *   `ContactMeshError`    only with rigid tools: the share by which the force of each is expected
 *                         to be too large because of the size of the cells, see
 *                         solvers/interaction/mesh_error.h; a value a tool
 *   `Outcome`, `Message`  how the run has ended, see solvers/base/outcome.h
 *
 * Second output: a table of all steps,
 *
 *   `Time`, `StepLength`      the time at the end of the step, and the length of the step, s
 *   `KineticEnergy`, `ElasticEnergy`, `WeightEnergy`, `ViscousEnergy`, `Dissipated`, `Work`
 *                             the energies, J, see palpate::EnergyAccount
 *   `Position0`, …            the coordinates of each tool, m
 *   `Force0`, …               the force on each tool, N
 *   `MinimumDetF`             the least det F
 *   `LocalError`              an estimate of the error of the displacement in the step, m
 *   `Residual`, `Iterations`, `Halvings`, `Flags`, `Outcome`
 *                             the course of the step, see palpate::DynamicState
 *
 * The run is made once, when the first time is requested; its frames are kept in a file
 * (vtkPalpateFrames.h). A run that does not come to its end is a result, not an error: Outcome is
 * not 0, and the body stays as it was last. The whole result is on rank 0.
 */
#pragma once

#include <memory>
#include <vector>

#include "PalpateSolvingModule.h"
#include "vtkPalpateSolve.h"

class vtkTable;
template <class Run>
class vtkPalpateKeptRun;

class PALPATESOLVING_EXPORT vtkPalpateSolveDynamics : public vtkPalpateSolve
{
public:
  static vtkPalpateSolveDynamics* New();
  vtkTypeMacro(vtkPalpateSolveDynamics, vtkPalpateSolve);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Whether the motion begins in the equilibrium under gravity, else undeformed.
  vtkSetMacro(Settled, bool);
  vtkGetMacro(Settled, bool);
  vtkBooleanMacro(Settled, bool);
  ///@}
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
  /// Number of a palpate::TimeIntegrator: 0 BDF2, 1 generalised alpha.
  vtkSetMacro(Integrator, int);
  vtkGetMacro(Integrator, int);
  ///@}
  ///@{
  /// Of the generalised alpha method, 0 to 1.
  vtkSetMacro(SpectralRadius, double);
  vtkGetMacro(SpectralRadius, double);
  ///@}
  ///@{
  /// The length of a step, with a tolerance the longest, s.
  vtkSetMacro(TimeStep, double);
  vtkGetMacro(TimeStep, double);
  ///@}
  ///@{
  /// See palpate::DynamicsOptions::tolerance; 0: all steps are of one length.
  vtkSetMacro(StepTolerance, double);
  vtkGetMacro(StepTolerance, double);
  ///@}
  ///@{
  /// A step may be halved this often, 0 to 30.
  vtkSetMacro(MaximumHalvings, int);
  vtkGetMacro(MaximumHalvings, int);
  ///@}

protected:
  vtkPalpateSolveDynamics();
  ~vtkPalpateSolveDynamics() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateSolveDynamics(const vtkPalpateSolveDynamics&) = delete;
  void operator=(const vtkPalpateSolveDynamics&) = delete;

  static constexpr int PathPort = NumberOfInputs;

  /// What is simulated, on rank 0.
  struct Setup;
  /// What came of it.
  struct Run;

  /// The times of the frames, s; none where EndTime and FrameRate make none.
  std::vector<double> FrameTimes() const;
  void CheckProperties() const;
  Setup MakeSetup(vtkUnstructuredGrid* body, vtkTable* paths, vtkPolyData* surface);
  /// @note Collective
  std::unique_ptr<Run> Compute(vtkInformationVector** inputs, palpate::Communicator& communicator,
    vtkUnstructuredGrid* output);
  void Simulate(
    const Setup& setup, std::unique_ptr<palpate::LinearSolver> linearSolver, int threads, Run& run);
  void Show(const Run& run, double time, vtkUnstructuredGrid* output, vtkTable* history) const;

  bool Settled = true;
  double EndTime = 1;
  double FrameRate = 50;
  int Integrator = 0;
  double SpectralRadius = 0.8;
  double TimeStep = 0.002;
  double StepTolerance = 0;
  int MaximumHalvings = 10;

  std::unique_ptr<vtkPalpateKeptRun<Run>> LastRun;
};
