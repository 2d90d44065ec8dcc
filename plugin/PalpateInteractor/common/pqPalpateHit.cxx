// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateHit.h"

#include "vtkInteractorObserver.h"
#include "vtkRenderer.h"
#include "vtkStaticCellLocator.h"

bool pqPalpateHit(
  vtkRenderer* renderer, vtkStaticCellLocator* surface, const int* pixel, double* hit)
{
  double near[4];
  double far[4];
  vtkInteractorObserver::ComputeDisplayToWorld(renderer, pixel[0], pixel[1], 0, near);
  vtkInteractorObserver::ComputeDisplayToWorld(renderer, pixel[0], pixel[1], 1, far);
  double along;
  double parametric[3];
  int subId;
  return surface->IntersectWithLine(near, far, 0, along, hit, parametric, subId) != 0;
}
