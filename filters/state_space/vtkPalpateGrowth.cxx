// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateGrowth.h"

#include <set>

#include "vtkMultiProcessController.h"
#include "vtkObject.h"

namespace
{
/// The tag of rank 0's message that spaces which grow are to go on.
constexpr int GoOnTag = 7403;

/// The objects of this process whose space grows: the same ones on every rank.
std::set<vtkObject*>& Growing()
{
  static std::set<vtkObject*> objects;
  return objects;
}

void GoOn(void*, void*, int, int)
{
  for (vtkObject* object : Growing())
  {
    object->Modified();
  }
}

/// Ranks that serve rank 0 listen for the message.
void ListenForGoOn(vtkMultiProcessController* controller)
{
  static bool listens = false;
  if (!listens && controller && controller->GetLocalProcessId() != 0)
  {
    controller->AddRMICallback(&GoOn, nullptr, GoOnTag);
    listens = true;
  }
}
}

void vtkPalpateGrow(vtkObject* object, vtkMultiProcessController* controller)
{
  ListenForGoOn(controller);
  Growing().insert(object);
}

bool vtkPalpateStopGrowing(vtkObject* object)
{
  return Growing().erase(object) > 0;
}

bool vtkPalpateGrows(vtkObject* object)
{
  return Growing().count(object) > 0;
}

void vtkPalpateGoOn()
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  if (controller && controller->GetNumberOfProcesses() > 1)
  {
    controller->TriggerRMIOnAllChildren(nullptr, 0, GoOnTag);
  }
  GoOn(nullptr, nullptr, 0, 0);
}
