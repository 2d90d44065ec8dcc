// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpatePrecomputeStateSpace
 * @brief the configurations of a body around its active nodes
 *
 * Inputs: those of vtkPalpateToolFilter. A tool is bonded to each of the active nodes, or, where
 * there are none, to each point that is touchable. A rigid tool, where there is one, presses
 * anywhere instead. Output: the state space of the body (see vtkPalpateStateSpace.h), with these
 * field arrays of the run on `Configurations`:
 *
 *   `FileName`                  the file of the space
 *   `Ranks`, `Cells`            the numbers of ranks, and of cells of the body
 *   `Unknowns`                  the number of unknowns, without those of the first active node and
 *                               of the patch that moves with it
 *   `Solved`, `Reused`          the numbers of configurations that were solved in this run, and
 *                               that were taken from the file
 *   `NotReached`                the number of check-points to which no usable configuration leads,
 *                               or that an abort left
 *   `Complete`                  1 unless the run was aborted
 *   `IntermediateStatesSolved`  the number of intermediate states that were solved in this run;
 *                               they do not count as configurations
 *   `IntermediateStatesFailed`  the number of those that did not converge
 *   `IntermediateStatesSeconds` the time of the intermediate states, summed over all ranks, s
 *   `ExplorationSeconds`        the wall time of the exploration, s
 *   `FinishingSeconds`          the wall time of what follows the exploration, s
 *   `AssemblySeconds`, `FactorisationSeconds`, `SolveSeconds`
 *                               the mean time of one such operation in this run, s
 *   `MeshSeconds`               the wall time in which the meshes of regions were made, s
 *   `FloorSeconds`              the least time of a configuration, s: one assembly, one
 *                               factorisation and three solves
 *
 * Runs on all ranks of the global controller. The result is whole on rank 0 and empty elsewhere. An
 * abort keeps what was found; with a FileName, the next run continues from there.
 *
 * With an UpdateInterval the space grows: an execution ends after that time with what was found,
 * and the next one goes on. ParaView's window starts the next one by itself, see GetNeedsUpdate().
 */
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "PalpateStateSpaceModule.h"
#include "vtkNew.h"
#include "vtkPalpateSolveCost.h"
#include "vtkPalpateToolFilter.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkSmartPointer.h"

class vtkImplicitFunction;
class vtkMultiProcessController;
class vtkPolyData;

struct vtkPalpateFollowing;

namespace palpate
{
struct BodyOfRun;
class Communicator;
struct ContactOptions;
struct PrecomputeOptions;
struct RegionMesh;
struct Scene;
}

class PALPATESTATESPACE_EXPORT vtkPalpatePrecomputeStateSpace : public vtkPalpateToolFilter
{
public:
  static vtkPalpatePrecomputeStateSpace* New();
  vtkTypeMacro(vtkPalpatePrecomputeStateSpace, vtkPalpateToolFilter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Whether a rigid tool can also hold active nodes, which are explored besides.
  vtkSetMacro(Graspable, bool);
  vtkGetMacro(Graspable, bool);
  vtkBooleanMacro(Graspable, bool);
  ///@}
  enum Explorations : int
  {
    WHOLE_SPACE = 0,
    AROUND_THE_HAND = 1
  };
  enum StagesOfCut : int
  {
    ALL_STAGES = 0,
    THIS_STAGE = 1
  };
  ///@{
  /// Of a body with a cut that is closed (Place Cut): whether all stages of the cut are explored,
  /// so that it can be torn, or the body as it is given.
  vtkSetClampMacro(CutStages, int, ALL_STAGES, THIS_STAGE);
  vtkGetMacro(CutStages, int);
  ///@}
  ///@{
  /// What is explored here: the whole space, or nothing but a first configuration, since the rest
  /// is explored around the hand while the body is touched. Needs a rigid tool and a FileName.
  vtkSetClampMacro(Exploration, int, WHOLE_SPACE, AROUND_THE_HAND);
  vtkGetMacro(Exploration, int);
  ///@}
  ///@{
  /// Where a rigid tool is to press: the places of the surface at rest in which this is not
  /// positive. Without it, on the whole touchable surface.
  vtkSetMacro(UseToolRegion, bool);
  vtkGetMacro(UseToolRegion, bool);
  vtkBooleanMacro(UseToolRegion, bool);
  void SetToolRegion(vtkImplicitFunction* region);
  vtkImplicitFunction* GetToolRegion();
  ///@}
  ///@{
  /// How deep a rigid tool presses, measured at rest, m; 0: as deep as the force limit allows.
  vtkSetMacro(Depth, double);
  vtkGetMacro(Depth, double);
  ///@}
  ///@{
  /// Distance of neighbouring check-points of a rigid tool, m; with a tolerance, of those that the
  /// space begins with. 0: two fifths of the radius of the tool.
  vtkSetMacro(Spacing, double);
  vtkGetMacro(Spacing, double);
  ///@}
  ///@{
  /// The step of the orientations of a tool that is turned at most, degrees; 0:
  /// palpate::kUsualTurnSpacing.
  vtkSetMacro(TurnSpacing, double);
  vtkGetMacro(TurnSpacing, double);
  ///@}
  ///@{
  /// Where the exploration of a rigid tool's space begins, m: the places of the surface near it
  /// come first. The result does not depend on it.
  vtkSetVector3Macro(BeginAt, double);
  vtkGetVector3Macro(BeginAt, double);
  ///@}
  ///@{
  /// The largest number of configurations: the space of a rigid tool is refused if more are
  /// expected.
  vtkSetMacro(MaximumConfigurations, int);
  vtkGetMacro(MaximumConfigurations, int);
  ///@}
  ///@{
  /// Half the side of the box of check-points around each active node, m.
  vtkSetMacro(HalfWidth, double);
  vtkGetMacro(HalfWidth, double);
  ///@}
  ///@{
  /// Check-points along an axis: odd, at least 3. Not used with a tolerance.
  vtkSetMacro(Resolution, int);
  vtkGetMacro(Resolution, int);
  ///@}
  ///@{
  /// Error of the force that is asked for: the grid is refined where it is larger; 0: a uniform
  /// grid.
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}
  enum : int
  {
    RELATIVE = 0,
    ABSOLUTE = 1
  };
  ///@{
  /// Whether the tolerance is a share of the largest force within the limit, or a force in N.
  vtkSetClampMacro(ToleranceType, int, RELATIVE, ABSOLUTE);
  vtkGetMacro(ToleranceType, int);
  ///@}
  ///@{
  /// Force beyond which the space is not explored, N; 0 is none.
  vtkSetMacro(ForceLimit, double);
  vtkGetMacro(ForceLimit, double);
  ///@}
  /// Numbers of palpate::History.
  enum Histories
  {
    FLAT = 0,
    AUTOMATIC = 1,
    LEVELS = 2
  };
  ///@{
  /// Whether a check-point may have several equilibria, see Histories.
  vtkSetClampMacro(History, int, FLAT, LEVELS);
  vtkGetMacro(History, int);
  ///@}
  ///@{
  /// Equilibria at equal parts of the straight way to each configuration, 0 to 100: more places at
  /// which the force is known.
  vtkSetMacro(IntermediateStates, int);
  vtkGetMacro(IntermediateStates, int);
  ///@}
  ///@{
  /// Whether configurations have the third derivative of the energy.
  vtkSetMacro(ThirdDerivatives, bool);
  vtkGetMacro(ThirdDerivatives, bool);
  vtkBooleanMacro(ThirdDerivatives, bool);
  /// Whether the error of the mesh is estimated at each configuration.
  vtkSetMacro(EstimateMeshError, bool);
  vtkGetMacro(EstimateMeshError, bool);
  vtkBooleanMacro(EstimateMeshError, bool);
  ///@}
  ///@{
  /// The largest error of a force that the mesh may cause, as a share of it: the organ is divided
  /// into regions with meshes of their own, each fine where it is touched there, and so is each
  /// active node. The force is corrected by its estimated error where that may be trusted, and what
  /// is left is meant. 0: the space stands on the mesh that is given.
  vtkSetMacro(MeshTolerance, double);
  vtkGetMacro(MeshTolerance, double);
  ///@}
  ///@{
  /// The largest distance of a place of the surface from the centre of its region, m; 0: 2.5
  /// half-widths of the tool.
  vtkSetMacro(RegionSize, double);
  vtkGetMacro(RegionSize, double);
  ///@}
  ///@{
  /// The mesh of a region gets no more cells than this.
  vtkSetMacro(MaximumCells, int);
  vtkGetMacro(MaximumCells, int);
  ///@}
  ///@{
  /// Where the space is kept (.palpate) and resumed; empty: in memory alone.
  vtkSetStdStringFromCharMacro(FileName);
  vtkGetCharFromStdStringMacro(FileName);
  ///@}
  /// Numbers of palpate::Keep.
  enum Keeps
  {
    TOUCH = 0,
    SURFACE = 1,
    ALL = 2
  };
  ///@{
  /// What the file keeps of the displacements when the space is complete, see Keeps.
  vtkSetClampMacro(Keep, int, TOUCH, ALL);
  vtkGetMacro(Keep, int);
  ///@}
  ///@{
  /// Largest residual of an equilibrium, as a share of the scene's force scale.
  vtkSetMacro(SolverTolerance, double);
  vtkGetMacro(SolverTolerance, double);
  ///@}
  ///@{
  /// A line on the terminal says how far the run is each time so many s have gone by; 0: none.
  vtkSetMacro(LogInterval, double);
  vtkGetMacro(LogInterval, double);
  ///@}
  ///@{
  /// An execution gives what it has found after so many s; 0: when all is found. Needs a FileName.
  vtkSetMacro(UpdateInterval, double);
  vtkGetMacro(UpdateInterval, double);
  ///@}
  ///@{
  /// Factors are of single precision where that is safe: it takes less time, and no result changes
  /// but for the last digits.
  vtkSetMacro(SinglePrecisionFactors, bool);
  vtkGetMacro(SinglePrecisionFactors, bool);
  vtkBooleanMacro(SinglePrecisionFactors, bool);
  ///@}
  ///@{
  /// Neighbouring ranks that factorise and solve together, 1 to the number of ranks: for bodies
  /// that are too large for the memory of one.
  vtkSetMacro(RanksPerSolve, int);
  vtkGetMacro(RanksPerSolve, int);
  ///@}
  ///@{
  /// Largest error of the displacement that is carried for touching, as a share of the largest.
  vtkSetMacro(DisplacementBound, double);
  vtkGetMacro(DisplacementBound, double);
  ///@}

  ///@{
  /// The expected cost of the filter, by its properties and its present input.
  /// @note Collective.
  void UpdateEstimate();
  vtkGetCharFromStdStringMacro(Estimate);
  ///@}

  /// What the exploration around a hand needs, as of the last execution; null: it is not asked for.
  [[nodiscard]] std::shared_ptr<const vtkPalpateFollowing> GetFollowing() const
  {
    return this->Following;
  }

  /// Whether the space will grow further. Then the next update continues its exploration, on all
  /// ranks. ParaView's window asks rank 0 now and then (the hint LiveSource).
  bool GetNeedsUpdate();

protected:
  vtkPalpatePrecomputeStateSpace();
  ~vtkPalpatePrecomputeStateSpace() override;

  vtkMTimeType GetMTime() override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpatePrecomputeStateSpace(const vtkPalpatePrecomputeStateSpace&) = delete;
  void operator=(const vtkPalpatePrecomputeStateSpace&) = delete;

  /// What the properties of a rigid tool ask for.
  palpate::ContactOptions Contact(vtkPolyData* surface);
  /// What all properties ask for, but for what is told on the way.
  /// @param surface What this rank has of that of the tool. @note Collective.
  palpate::PrecomputeOptions Options(vtkPolyData* surface, vtkMultiProcessController* controller);

  /// The bodies of a run: the one that is given, or those of the regions that it is divided into.
  /// @note Collective.
  std::vector<palpate::BodyOfRun> BodiesOfRun(const std::shared_ptr<const palpate::Scene>& scene,
    const palpate::PrecomputeOptions& options, palpate::Communicator& communicator);
  /// Whether all stages of a cut are explored.
  bool HasStages(const palpate::Scene& scene) const;
  /// The stages of the cut of a body, the last one first.
  std::vector<palpate::BodyOfRun> Stages(
    const palpate::Scene& scene, const palpate::PrecomputeOptions& options) const;
  void WarnOf(const std::vector<palpate::RegionMesh>& meshes);
  /// Gives what there is of a space that is explored around a hand. @note Collective.
  void BeginFollowing(std::shared_ptr<const palpate::Scene> scene,
    const palpate::PrecomputeOptions& options, palpate::Communicator& communicator,
    vtkPartitionedDataSetCollection* output);

  bool Graspable = false;
  int Exploration = WHOLE_SPACE;
  int CutStages = ALL_STAGES;
  bool UseToolRegion = false;
  vtkSmartPointer<vtkImplicitFunction> ToolRegion;
  double Depth = 0.005;
  double Spacing = 0;
  double TurnSpacing = 0;
  double BeginAt[3] = { 0, 0, 0 };
  int MaximumConfigurations = 30000;
  double HalfWidth = 0.01;
  int Resolution = 7;
  double Tolerance = 0;
  int ToleranceType = RELATIVE;
  double ForceLimit = 0;
  int History = AUTOMATIC;
  int IntermediateStates = 0;
  bool ThirdDerivatives = true;
  bool EstimateMeshError = false;
  double MeshTolerance = 0;
  double RegionSize = 0;
  int MaximumCells = 20000;
  /// The time in which the meshes of regions were made, s.
  double MeshSeconds = 0;
  std::string FileName;
  int Keep = SURFACE;
  double SolverTolerance = 1e-9;
  bool SinglePrecisionFactors = true;
  int RanksPerSolve = 1;
  double LogInterval = 10;
  double UpdateInterval = 0;
  double DisplacementBound = 1e-3;

  std::string Estimate;
  vtkPalpateSolveCost Cost;
  std::shared_ptr<const vtkPalpateFollowing> Following;

  /// The time at which the last execution ended.
  std::chrono::steady_clock::time_point LastEnd;

  /// The exploration of a space that grows, from one execution to the next.
  struct Growth;
  std::unique_ptr<Growth> Kept;

  /// The last complete result and the input that it belongs to. The filter is also run again if a
  /// filter before it ran again but gave the same body, for example because another view of that
  /// body asks for ghost cells.
  std::string LastOf;
  vtkNew<vtkPartitionedDataSetCollection> Last;
};
