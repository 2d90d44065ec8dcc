// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateAccuracyReport
 * @brief how wrong each way to interpolate a state space is, and what it costs
 *
 * Input: a state space (see vtkPalpateStateSpace.h). Outputs:
 *
 *   0  vtkTable: a row for each method and grid; errors in per cent, see palpate::AccuracyRow
 *     `Method`, `Resolution` (check-points along an axis), `Spacing` (of them, m)
 *     `Samples`               configurations and intermediate states
 *     `PrecomputeSeconds` (on one core), `SetupSeconds`, `Bytes`     for each active node
 *     `EvaluationP50`, `EvaluationP999`                              ns
 *     `MeanError`, `P99Error`, `LargestError`                        relative, of the force, %
 *     `MeanErrorN`, `P99ErrorN`, `LargestErrorN`                     absolute, N
 *     `LargestForce`          exact, at the test points that count, N
 *     `Noticeable`            share of test points at which the relative error exceeds 10 %, %
 *     `NearRestError`         largest relative error within 1 % of the half-width, or where a
 *                             rigid tool begins to touch, %
 *     `MeanMarkedError`, `LargestMarkedError`, `LargestExtrapolatedError`   relative, elsewhere, %
 *     `MeanStiffnessError`    relative, %
 *     `MeanDisplacementError`, `LargestDisplacementError`   of the surface, % of the largest
 *     `LoopWork`              around closed paths, share of the largest energy on it
 *     `ForceJump`, `StiffnessJump`                           across cells, share of the largest
 *     `TestPoints`, `Counted`, `Marked`, `Extrapolated`, `Irregular`, `Failed`   numbers of points
 *   1  vtkPolyData: the test points, a vertex each at the displaced active node, or the place of
 *      the rigid tool
 *     `ActiveNode`, `Kind` (0 anywhere, 1 on a walk or slide, 2 near rest or where the tool begins
 *     to touch), `Displacement` (m; of a rigid tool its place),
 *     `Force` (N), `Energy` (J), `Outcome`, `Flags`, `Found`,
 *     `Class` (0 counted, 1 marked, 2 extrapolated, 3 irregular, 4 failed), and for each method
 *     `Error (<method>)`      relative, %; NaN where nothing is known
 *   2  vtkTable: as 0 for each active node, or for the rigid tool, with the columns `ActiveNode`
 *      (−1: a rigid tool) and `Tool` (its name)
 *   3  vtkTable: for charts, a row for each method and grid
 *     `Time` (`EvaluationP50`), `Bytes`, `PrecomputeSeconds`         as above
 *     `<method>`              `MeanError` in the rows of the method, NaN in the others
 *
 * Field arrays of 0: `Solved`, `Reused` (test points), `Ranks`, `ExactSeconds`, `MeasureSeconds`,
 * `SolveSeconds` (mean of an exact solve), `Complete`.
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
