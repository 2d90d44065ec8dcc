// SPDX-License-Identifier: BSD-3-Clause
// A state space as VTK's data: a vtkPartitionedDataSetCollection, complete for touching, that stock
// filters, readers and writers understand. It has these blocks:
//
//   `Body`            vtkUnstructuredGrid   the first body at rest, see vtkPalpateScene.h
//   `Surface`         vtkPolyData           the surface at rest that is shown
//   `Configurations`  vtkPolyData           a vertex for each configuration, at the displaced
//                                           active node, and a line for each transition
//   `IntermediateStates`  vtkPolyData       where a space has them: a vertex for each, at the
//                                           displaced active node
//   `Body2`, …        vtkUnstructuredGrid   the further bodies, of a space of several
//
// Point arrays of `Surface`:
//
//   `MeshPoint`       id of the point in `Body`
//   `Modes`           basis of the displacement, r modes: x y z of the first, then of the next, …
//                     [3r]; where there are several active nodes `Modes 8`, and on another body
//                     `Modes 8 of Body 2`
//
// Point arrays of `Configurations`:
//
//   `ActiveNode`      id of the point in the body; −1: a rigid tool
//   `BodyNumber`      the body, of a space with tool spaces on several
//   `CheckPoint`, `ParentCheckPoint`   place on the grid, in steps from rest [3]
//   `Level`, `ParentLevel`             which of the equilibria at the check-point
//   `LevelsReached`   of a space with levels: the level that is reached at each neighbour,
//                     (−1,−1,−1) first, z fastest; −1 none, −2 not tried, −3 one beyond those that
//                     are kept [27]
//   `Displacement`    of the active node, m [3]
//   `Force`           that holds it, N [3]
//   `Energy`          J
//   `Stiffness`       ∂force/∂displacement, N/m [9]
//   `ThirdDerivative` of a space that has them: ∂stiffness/∂displacement, N/m², in the order xxx,
//                     xxy, xxz, xyy, xyz, xzz, yyy, yyz, yzz, zzz [10]; NaN where it was not found
//   `MeshError`       of a space in which it was estimated: by how much Force is too large because
//                     of the size of the cells, N [3]
//   `MeshErrorEnergy` the energy that a finer mesh would still release there, J; NaN: not estimated
//   `MeshErrorReliable`   1: the estimate may be trusted
//   `Coefficients`    of the modes [r]
//   `CoefficientGradient`   ∂/∂x of all, then ∂/∂y, ∂/∂z, 1/m [3r]
//   `Outcome`, `Flags`      see solvers/base/outcome.h
//   `SolveStatus`     both in one: 0 good, 1 near a fold, 2 beyond the force limit, 3 unstable, 4
//                     inverted, 5 not solved
//   `Residual`, `MinimumDetF`, `NegativePivots`, `Iterations`, `Seconds`
//
// Point arrays of `IntermediateStates`:
//
//   `ActiveNode`, `BodyNumber`, `Displacement`, `Force`, `Energy`, `Outcome`, `Flags`, `Seconds`
//                     as those of configurations
//   `TargetCheckPoint`      of the configuration to which it is on the way [3]
//   `Number`          along that way, from 1
//
// Field arrays of `Configurations`: `SceneHash`, `SchemaVersion`; `LargestDisplacement`,
// `DisplacementError`, `SensitivityError` (m, of the modes); and for each tool space:
//
//   `ActiveNodes`; `BodyNumbers` and `MaterialPoints` (m), of a space with tool spaces on several
//                     bodies; `TipRadius` (m), `HalfWidth` (m), `Resolution`, `ForceLimit` (N),
//                     `CoarsestCell` (in steps of the grid), `Tolerance` (of the force, 0: uniform
//                     grid), `ToleranceIsRelative` (1: a share of the largest force, 0: N),
//                     `History` (0 flat, 1 automatic, 2 levels), `IntermediateStates` (to each
//                     configuration), `ThirdDerivatives` (1: there are), `NumberOfConfigurations`;
//                     of a space with regions, `RegionCentre` (m), `RegionBand` (m, 0: of an active
//                     node), `RegionSize` (m), `RegionTolerance` (of the force, −1: the whole
//                     organ)
#pragma once

#include <string>
#include <vector>

#include "PalpateStateSpaceModule.h"
#include "state_space/touch_space.h"
#include "vtkPalpatePieces.h"
#include "vtkSmartPointer.h"

class vtkDataSet;
class vtkFieldData;
class vtkMultiProcessController;
class vtkPartitionedDataSetCollection;
class vtkUnstructuredGrid;

namespace palpate
{
class Communicator;
}

/// Names the blocks of an empty collection, which must be the same on every rank: three, a fourth
/// one for intermediate states, and one for each further body.
PALPATESTATESPACE_EXPORT void vtkPalpateNameBlocks(
  vtkPartitionedDataSetCollection* output, bool hasIntermediateStates, std::size_t numBodies = 1);

/// The number of bodies that rank 0 has, on all ranks.
/// @note Collective.
PALPATESTATESPACE_EXPORT std::size_t vtkPalpateNumberOfBodies(
  const std::vector<palpate::SpaceBody>& bodies, palpate::Communicator& communicator);

PALPATESTATESPACE_EXPORT bool vtkPalpateHasIntermediateStates(const palpate::TouchSpace& space);

/// Fills the collection on the rank that has the space. Its blocks are named; the fourth one is, if
/// the space has intermediate states. A space that is moved here gives its modes away one active
/// node after another, so that those of many are not in memory twice.
/// @param bodies In the order of their numbers.
PALPATESTATESPACE_EXPORT void vtkPalpateFillCollection(
  const std::vector<palpate::SpaceBody>& bodies, palpate::TouchSpace space,
  vtkPartitionedDataSetCollection* output);

/// Adds the field arrays `FileName` and `Complete` (1: nothing is left to find).
PALPATESTATESPACE_EXPORT void vtkPalpateAddFile(
  const std::string& fileName, bool complete, vtkFieldData* fields);

/// Adds the field array `LeftOut`: the names of the parts that are damaged in the file, and so are
/// missing here.
PALPATESTATESPACE_EXPORT void vtkPalpateAddLeftOut(
  const std::vector<std::string>& leftOut, vtkFieldData* fields);

/// The part of the block of a body that this rank has: the partitions with points.
PALPATESTATESPACE_EXPORT vtkPalpatePieces vtkPalpateBody(
  vtkPartitionedDataSetCollection* collection, palpate::BodyId body = palpate::kFirstBody);

/// The number of the last body that has a block, or of the first body.
PALPATESTATESPACE_EXPORT palpate::BodyId vtkPalpateLastBody(
  vtkPartitionedDataSetCollection* collection);

/// The bodies, in the order of their numbers: whole on rank 0.
/// @note Collective.
PALPATESTATESPACE_EXPORT std::vector<vtkSmartPointer<vtkUnstructuredGrid>> vtkPalpateGatherBodies(
  vtkPartitionedDataSetCollection* collection, vtkMultiProcessController* controller);

/// The part of `Configurations` that this rank has: the partitions with points.
PALPATESTATESPACE_EXPORT std::vector<vtkSmartPointer<vtkDataSet>> vtkPalpateConfigurations(
  vtkPartitionedDataSetCollection* collection);

/// Makes a space from a collection whose blocks may lie on any rank, in any number of partitions.
/// The result is whole on rank 0, and empty on the others.
/// @note Collective.
/// @throws palpate::InputError on rank 0: a block or an array is missing or has another size, or
/// partitions belong to different spaces.
PALPATESTATESPACE_EXPORT palpate::TouchSpace vtkPalpateSpaceFromCollection(
  vtkPartitionedDataSetCollection* collection, vtkMultiProcessController* controller);
