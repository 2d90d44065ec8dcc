// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSolveCost.h"

#include "assembly/scene.h"
#include "equilibrium/solve_cost.h"

vtkPalpateSolveCost::vtkPalpateSolveCost() = default;
vtkPalpateSolveCost::~vtkPalpateSolveCost() = default;

const palpate::SolveCost& vtkPalpateSolveCost::Of(const palpate::Scene& scene, int threads)
{
  const std::string hash = palpate::hash(scene);
  if (!this->Cost || hash != this->Hash || threads != this->Threads)
  {
    this->Cost =
      std::make_unique<const palpate::SolveCost>(palpate::measure_solve_cost(scene, {}, threads));
    this->Hash = hash;
    this->Threads = threads;
  }
  return *this->Cost;
}
