// SPDX-License-Identifier: BSD-3-Clause
// What the solves of a body take (equilibrium/solve_cost.h), kept as long as the body stays the
// same: a person who changes a property shall not wait for it each time.
#pragma once

#include <memory>
#include <string>

#include "PalpateSolvingModule.h"

namespace palpate
{
struct Scene;
struct SolveCost;
}

class PALPATESOLVING_EXPORT vtkPalpateSolveCost
{
public:
  vtkPalpateSolveCost();
  ~vtkPalpateSolveCost();
  vtkPalpateSolveCost(const vtkPalpateSolveCost&) = delete;
  vtkPalpateSolveCost& operator=(const vtkPalpateSolveCost&) = delete;

  /// @throws palpate::InputError, palpate::BackendError as palpate::measure_solve_cost.
  const palpate::SolveCost& Of(const palpate::Scene& scene, int threads);

private:
  std::unique_ptr<const palpate::SolveCost> Cost;
  std::string Hash; ///< of the scene that it is of
  int Threads = 0;  ///< with which it was measured
};
