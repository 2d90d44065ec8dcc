// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSolveCost.h"

#include "assembly/scene.h"
#include "equilibrium/solve_cost.h"

vtkPalpateSolveCost::vtkPalpateSolveCost() = default;
vtkPalpateSolveCost::~vtkPalpateSolveCost() = default;

const palpate::SolveCost& vtkPalpateSolveCost::Of(
  const palpate::Scene& scene, int threads, bool isRigid)
{
  const std::string hash = palpate::hash(scene);
  if (!this->Cost || hash != this->Hash || threads != this->Threads || isRigid != this->IsRigid)
  {
    this->Cost =
      std::make_unique<const palpate::SolveCost>(palpate::measure_solve_cost(scene, {}, threads,
        isRigid ? palpate::kUnknownsWithoutFactorInContact : palpate::kUnknownsWithoutFactor));
    this->Hash = hash;
    this->Threads = threads;
    this->IsRigid = isRigid;
  }
  return *this->Cost;
}
