// SPDX-License-Identifier: BSD-3-Clause
/// The client's own copy of what is in the pipeline.
#pragma once

#include <memory>
#include <vector>

#include "vtkPalpateReducedModel.h"
#include "vtkPalpateStateSpace.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

class pqOutputPort;
class vtkUnstructuredGrid;

/// Whether the port gives a state space, as far as is known of its data.
bool pqPalpateGivesStateSpace(pqOutputPort* port);

/// Whether the port gives a body with a reduced model, as far as is known of its data.
bool pqPalpateGivesReducedModel(pqOutputPort* port);

/// The number of tools of such a model.
int pqPalpateCountTools(pqOutputPort* port);

/// Whether a state space is of a rigid tool, and whether it is of active nodes.
bool pqPalpateHasRigidTool(pqOutputPort* port);
bool pqPalpateHasActiveNodes(pqOutputPort* port);

/// Figures of such a model, by which it is told from another one.
std::vector<double> pqPalpateMarkReduced(pqOutputPort* port);

/// From this process where the server is built in, else over the connection. Brings the pipeline up
/// to date.
/// @throws palpate::InputError, std::runtime_error it is no state space, or cannot be fetched.
palpate::TouchSpace pqPalpateFetchSpace(pqOutputPort* port);

/// The same of a body with its reduced model.
struct pqPalpateReducedSpace
{
  std::shared_ptr<const palpate::ReducedModel> Model;
  palpate::Surface Surface;
  /// The active node of each tool, and where it is at rest, m.
  std::vector<vtkIdType> ActiveNodes;
  std::vector<palpate::Vec3> Places;
};
pqPalpateReducedSpace pqPalpateFetchReduced(pqOutputPort* port);

/// The same of a body on its way to a state space; nullptr: it is no unstructured grid.
vtkSmartPointer<vtkUnstructuredGrid> pqPalpateFetchBody(pqOutputPort* port);

/// Changes when the data of a built-in server change; 0: the server is another process, of
/// which nothing is known.
vtkMTimeType pqPalpateDataTime(pqOutputPort* port);
