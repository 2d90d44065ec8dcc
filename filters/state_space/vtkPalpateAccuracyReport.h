// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateAccuracyReport
 * @brief how wrong each way to interpolate a state space is, and what it costs
 *
 * Input: a state space (see vtkPalpateStateSpace.h). Outputs:
 *
 * 0  vtkTable: a row for each method and grid, see palpate::AccuracyRow
 *
 *   `Method`                    the method of interpolation
 *   `Resolution`, `Spacing`     the number of check-points along an axis, and their distance, m
 *   `Samples`                   the number of configurations and intermediate states
 *   `PrecomputeSeconds`         the time to compute these on one core, for an active node, s
 *   `SetupSeconds`, `Bytes`     the setup time, s, and the memory of the method, for an active node
 *   `EvaluationP50`, `EvaluationP999`
 *                               the median and the 99.9th percentile of the time of an evaluation,
 *                               ns
 *   `MeanError`, `P99Error`, `LargestError`
 *                               the relative error of the force, %
 *   `MeanErrorN`, `P99ErrorN`, `LargestErrorN`
 *                               the absolute error of the force, N
 *   `LargestForce`              the largest exact force at the test points that count, N
 *   `MeanMeshErrorN`, `LargestMeshErrorN`, `MeshErrorReliable`
 *                               the estimated error that the mesh makes in the force, N, and the
 *                               share of points at which it is reliable, %
 *   `MeanMeasuredMeshErrorN`, `LargestMeasuredMeshErrorN`
 *                               the error of the mesh against a finer one, N; NaN where it was not
 *                               asked for
 *   `MeanLeftMeshErrorN`, `LargestLeftMeshErrorN`
 *                               what is left of it where a reliable estimate is taken off, N
 *   `Noticeable`                the share of test points whose relative error exceeds 10 %, %
 *   `NearRestError`             the largest relative error within 1 % of the half-width from rest,
 *                               or where a rigid tool begins to touch, %
 *   `MeanMarkedError`, `LargestMarkedError`
 *                               the relative error in marked regions, %
 *   `LargestExtrapolatedError`  the largest relative error where the force is extrapolated, %
 *   `MeanStiffnessError`        the relative error of the stiffness, %
 *   `MeanDisplacementError`, `LargestDisplacementError`
 *                               the error of the surface's displacement, % of the largest one
 *   `LoopWork`                  the largest work around a closed path, as a share of the largest
 *                               energy on the path
 *   `ForceJump`, `StiffnessJump`
 *                               the largest jumps across cells, as shares of the largest force and
 *                               stiffness
 *   `TestPoints`                the number of test points
 *   `Counted`, `Marked`, `Extrapolated`, `Irregular`, `Failed`
 *                               the number of test points in each class
 *
 * 1  vtkPolyData: the test points, each a vertex at the displaced active node, or at the place of
 *    the rigid tool
 *
 *   `ActiveNode`                the active node; −1: a rigid tool
 *   `BodyNumber`                the body that is touched, of a space with several
 *   `Kind`                      0 anywhere, 1 on a walk or slide, 2 near rest or where the tool
 *                               begins to touch
 *   `Displacement`              the displacement of the node, or the place of a rigid tool, m
 *   `Force`, `Energy`           the exact force, N, and energy, J
 *   `MeasuredMeshError`         where it was asked for, by how much the force of the mesh is too
 *                               large against that of a finer one, N; NaN where it is not known
 *   `Outcome`, `Flags`          how the exact solve ended
 *   `Found`                     how far the space can be trusted there, see palpate::Support
 *   `Class`                     0 counted, 1 marked, 2 extrapolated, 3 irregular, 4 failed
 *   `Error (<method>)`          the relative error of each method, %; NaN where nothing is known
 *
 * 2  vtkTable: as output 0, but with a row for each active node, or for the rigid tool, and with
 *    two more columns
 *
 *   `ActiveNode`                the active node; −1: a rigid tool
 *   `Tool`                      the name of the tool
 *
 * 3  vtkTable: for charts, with a row for each method and grid
 *
 *   `Time`                      `EvaluationP50` of output 0
 *   `Bytes`, `PrecomputeSeconds`
 *                               as in output 0
 *   `<method>`                  `MeanError` in the rows of the method, NaN in the others
 *
 * Output 0 has field arrays of the run:
 *
 *   `Solved`, `Reused`          the numbers of test points that were solved in this run, and that
 *                               were taken from the file
 *   `Ranks`                     the number of ranks
 *   `ExactSeconds`              the time of the exact solves, s
 *   `MeasureSeconds`            the time of the measurements, s
 *   `SolveSeconds`              the mean time of an exact solve on one core, s
 *   `Complete`                  1 unless the run was aborted
 *
 * Runs on all ranks of the global controller. The results are whole on rank 0 and empty elsewhere.
 */
#pragma once

#include <string>
#include <vector>

#include "PalpateStateSpaceModule.h"
#include "vtkNew.h"
#include "vtkPalpateSolveCost.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkTableAlgorithm.h"

class PALPATESTATESPACE_EXPORT vtkPalpateAccuracyReport : public vtkTableAlgorithm
{
public:
  static vtkPalpateAccuracyReport* New();
  vtkTypeMacro(vtkPalpateAccuracyReport, vtkTableAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Test points of each active node, or of the rigid tool, at least 1.
  vtkSetMacro(TestPoints, int);
  vtkGetMacro(TestPoints, int);
  ///@}
  ///@{
  /// The seed of the random numbers.
  vtkSetMacro(Seed, int);
  vtkGetMacro(Seed, int);
  ///@}
  ///@{
  /// Numbers of palpate::Method; none: all.
  void AddMethod(int method);
  void ClearMethods();
  ///@}
  ///@{
  /// Whether the test points are solved on a mesh as well whose cells are all divided.
  vtkSetMacro(MeasureMeshError, bool);
  vtkGetMacro(MeasureMeshError, bool);
  vtkBooleanMacro(MeasureMeshError, bool);
  ///@}
  ///@{
  /// Where exact equilibria are kept (.palpate) and taken from; empty: in memory alone.
  vtkSetStdStringFromCharMacro(FileName);
  vtkGetCharFromStdStringMacro(FileName);
  ///@}
  ///@{
  /// Largest residual of an exact equilibrium, as a share of the scene's force scale.
  vtkSetMacro(SolverTolerance, double);
  vtkGetMacro(SolverTolerance, double);
  ///@}
  ///@{
  /// Threads of a rank that solve for a large body without a factor, to 1024; 0: as many as there
  /// are cores for it.
  vtkSetMacro(Threads, int);
  vtkGetMacro(Threads, int);
  ///@}
  ///@{
  /// A line on the terminal says how far the run is each time so many s have gone by; 0: none.
  vtkSetMacro(LogInterval, double);
  vtkGetMacro(LogInterval, double);
  ///@}

  ///@{
  /// The expected cost of the filter, by its properties and its present input.
  /// @note Collective.
  void UpdateEstimate();
  vtkGetCharFromStdStringMacro(Estimate);
  ///@}

protected:
  vtkPalpateAccuracyReport();
  ~vtkPalpateAccuracyReport() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateAccuracyReport(const vtkPalpateAccuracyReport&) = delete;
  void operator=(const vtkPalpateAccuracyReport&) = delete;

  int TestPoints = 500;
  int Seed = 1;
  bool MeasureMeshError = false;
  std::vector<int> Methods;
  std::string FileName;
  double SolverTolerance = 1e-9;
  int Threads = 0;
  double LogInterval = 10;
  std::string Estimate;
  vtkPalpateSolveCost Cost;

  /// The last complete result and the input that it belongs to, as in
  /// vtkPalpatePrecomputeStateSpace.
  std::string LastOf;
  vtkNew<vtkTable> LastRows;
  vtkNew<vtkPolyData> LastPoints;
  vtkNew<vtkTable> LastRowsOfNodes;
  vtkNew<vtkTable> LastChart;
  /// Time of input and properties at the last execution.
  vtkMTimeType ExecutedAt = 0;
};
