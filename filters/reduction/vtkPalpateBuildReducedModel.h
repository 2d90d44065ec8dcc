// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateBuildReducedModel
 * @brief a small model of a body and the tools that hold it, with inertia and viscosity, which is
 * computed in real time
 *
 * Input: a body with material and boundary (see vtkPalpateScene.h), with density where it shall
 * have inertia. The tools are bonded to active nodes.
 *
 * First output: the body with its reduced model (vtkPalpateReducedModel.h). Second output: a table
 * of the errors of the force at places and on paths that the model was not made from, as shares of
 * the largest force there,
 *
 *   `Case`, `Compared`, `LargestForce` (N), `MeanError`, `RmsError`, `MaximumError`,
 *   `LargestTrust`, `Failed`, `Modes`, `Points`, `MedianStep`, `LongestStep`, `WholeStep` (s)
 *
 * With training places the body is trained with the tools there, and they are then attached at the
 * active nodes: to move them takes no training. The rows of the table end with "between places".
 *
 * Ranks share the training; the whole result is on rank 0, the same to the bit for any number of
 * them. With a FileName the model and its errors are kept in a .palpate file, of which a complete
 * model is read, and the training of one that is not goes on. Without one the training at places
 * stays in memory.
 */
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "PalpateReductionModule.h"
#include "vtkUnstructuredGridAlgorithm.h"

namespace palpate
{
class Communicator;
struct KeptPlaces;
}
class vtkTable;

class PALPATEREDUCTION_EXPORT vtkPalpateBuildReducedModel : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpateBuildReducedModel* New();
  vtkTypeMacro(vtkPalpateBuildReducedModel, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Ids of the points of the input that tools are bonded to: on the surface and not fixed.
  void AddActiveNode(vtkIdType node);
  void ClearActiveNodes();
  ///@}
  ///@{
  /// Ids of the points at which the tools are in training. Each run of as many ids as there are
  /// active nodes is a training place. None: the tools are trained at the active nodes.
  void AddTrainingPlace(vtkIdType node);
  void ClearTrainingPlaces();
  ///@}
  ///@{
  /// The points of the connected patch of the surface within this distance of an active node move
  /// with it, m; 0: the node alone.
  vtkSetMacro(TipRadius, double);
  vtkGetMacro(TipRadius, double);
  ///@}
  ///@{
  /// How far each coordinate of a tool goes from rest in training, m; above 0.
  vtkSetMacro(Reach, double);
  vtkGetMacro(Reach, double);
  ///@}
  ///@{
  /// The field of gravity under which the body rests, m/s^2. Tools count from their places there.
  vtkSetVector3Macro(BodyForce, double);
  vtkGetVector3Macro(BodyForce, double);
  ///@}
  ///@{
  /// The number of modes, at least 1.
  vtkSetMacro(Modes, int);
  vtkGetMacro(Modes, int);
  ///@}
  ///@{
  /// Error that the choice of points may make of the forces in training, a share between 0 and 1.
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}
  ///@{
  /// The largest number of points, at least 1.
  vtkSetMacro(MaximumPoints, int);
  vtkGetMacro(MaximumPoints, int);
  ///@}
  ///@{
  /// Random paths on which the body is trained to move, at least 1.
  vtkSetMacro(TrainingPaths, int);
  vtkGetMacro(TrainingPaths, int);
  ///@}
  ///@{
  /// The duration of each path, s.
  vtkSetMacro(PathDuration, double);
  vtkGetMacro(PathDuration, double);
  ///@}
  ///@{
  /// The largest frequency of the paths, Hz.
  vtkSetMacro(Bandwidth, double);
  vtkGetMacro(Bandwidth, double);
  ///@}
  ///@{
  /// The number of taps of each tool in a second.
  vtkSetMacro(Taps, double);
  vtkGetMacro(Taps, double);
  ///@}
  ///@{
  /// The time that the shortest tap takes, s.
  vtkSetMacro(ShortestTap, double);
  vtkGetMacro(ShortestTap, double);
  ///@}
  ///@{
  /// The length of a step in motion, s.
  vtkSetMacro(TimeStep, double);
  vtkGetMacro(TimeStep, double);
  ///@}
  ///@{
  /// The seed of all random numbers. The same seed gives the same model.
  vtkSetMacro(Seed, int);
  vtkGetMacro(Seed, int);
  ///@}
  ///@{
  /// Random paths by which the error is measured, 0 or more.
  vtkSetMacro(TestPaths, int);
  vtkGetMacro(TestPaths, int);
  ///@}
  ///@{
  /// The file that keeps the model; empty: none.
  vtkSetStdStringFromCharMacro(FileName);
  vtkGetCharFromStdStringMacro(FileName);
  ///@}
  ///@{
  /// The relative tolerance of the equilibria. If the file has a state space, it must be the same
  /// as that of the space.
  vtkSetMacro(SolverTolerance, double);
  vtkGetMacro(SolverTolerance, double);
  ///@}

protected:
  vtkPalpateBuildReducedModel();
  ~vtkPalpateBuildReducedModel() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateBuildReducedModel(const vtkPalpateBuildReducedModel&) = delete;
  void operator=(const vtkPalpateBuildReducedModel&) = delete;

  enum OutputPort
  {
    ModelPort,
    ErrorPort,
    NumberOfOutputs
  };

  /// @param body The body, on rank 0. @note Collective.
  void Build(vtkUnstructuredGrid* body, palpate::Communicator& communicator,
    vtkUnstructuredGrid* output, vtkTable* errors);

  std::vector<vtkIdType> ActiveNodes;
  std::vector<vtkIdType> TrainingPlaces;
  /// The training at places, if there is no file.
  std::unique_ptr<palpate::KeptPlaces> KeptPlaces;
  double TipRadius = 0;
  double Reach = 0.01;
  double BodyForce[3] = { 0, 0, 0 };
  int Modes = 70;
  double Tolerance = 0.004;
  int MaximumPoints = 400;
  int TrainingPaths = 4;
  double PathDuration = 2;
  double Bandwidth = 3;
  double Taps = 3;
  double ShortestTap = 0.03;
  double TimeStep = 0.002;
  int Seed = 1;
  int TestPaths = 1;
  std::string FileName;
  double SolverTolerance = 1e-9;
};
