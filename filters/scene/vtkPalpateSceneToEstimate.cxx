// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSceneToEstimate.h"

#include <algorithm>
#include <iterator>

#include "schedule/communicator.h"
#include "vtkMultiProcessController.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateEstimate.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkUnstructuredGrid.h"

std::optional<palpate::Scene> vtkPalpateSceneToEstimate(const vtkPalpatePieces& own,
  vtkMultiProcessController* controller, const palpate::Vec3& bodyForce)
{
  vtkPalpatePieces pieces;
  std::copy_if(own.begin(), own.end(), std::back_inserter(pieces),
    [](vtkPointSet* piece) { return piece != nullptr; });
  std::optional<palpate::Scene> scene;
  palpate::agree(*vtkPalpateCommunicator(controller),
    [&]
    {
      const auto body = vtkPalpateGatherBody(pieces, controller);
      if (controller && controller->GetLocalProcessId() != 0)
      {
        return;
      }
      if (!body || body->GetNumberOfCells() == 0)
      {
        vtkPalpateNothingToEstimate();
      }
      scene = vtkPalpateSceneFromGrid(body, bodyForce);
    });
  return scene;
}
