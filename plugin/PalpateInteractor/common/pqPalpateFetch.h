// SPDX-License-Identifier: BSD-3-Clause
/// Makes the client's own copy of data in the pipeline.
#pragma once

#include <memory>
#include <vector>

#include "vtkPalpateReducedModel.h"
#include "vtkPalpateStateSpace.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

class pqOutputPort;
class vtkUnstructuredGrid;

/// Whether the port gives a state space, as far as its data are known.
bool pqPalpateGivesStateSpace(pqOutputPort* port);

/// Whether the port gives a body with a reduced model, as far as its data are known.
bool pqPalpateGivesReducedModel(pqOutputPort* port);

/// The number of tools of a reduced model.
int pqPalpateCountTools(pqOutputPort* port);

/// Whether a state space has a rigid tool, and whether it has active nodes.
bool pqPalpateHasRigidTool(pqOutputPort* port);
bool pqPalpateHasActiveNodes(pqOutputPort* port);

/// Whether the space has the stages of a cut, which can tear.
bool pqPalpateHasCut(pqOutputPort* port);

/// Whether the space is explored around the hand while it is touched.
bool pqPalpateIsExploredAroundHand(pqOutputPort* port);

/// Figures of a reduced model that tell it from another one.
std::vector<double> pqPalpateMarkReduced(pqOutputPort* port);

/// Brings the pipeline up to date and copies the state space: from this process where the server is
/// built in, else over the connection.
/// @throws palpate::InputError, std::runtime_error the data are no state space, or cannot be
///   fetched.
palpate::TouchSpace pqPalpateFetchSpace(pqOutputPort* port);

/// A body with its reduced model.
struct pqPalpateReducedSpace
{
  std::shared_ptr<const palpate::ReducedModel> Model;
  palpate::Surface Surface;
  /// The active node of each tool, and its place at rest, m.
  std::vector<vtkIdType> ActiveNodes;
  std::vector<palpate::Vec3> Places;
};
pqPalpateReducedSpace pqPalpateFetchReduced(pqOutputPort* port);

/// Fetches a body of which no state space was made yet; nullptr: the data are no unstructured grid.
vtkSmartPointer<vtkUnstructuredGrid> pqPalpateFetchBody(pqOutputPort* port);

/// A time that changes when the data of a built-in server change; 0: the server is another process,
/// of which that is not known.
vtkMTimeType pqPalpateDataTime(pqOutputPort* port);
