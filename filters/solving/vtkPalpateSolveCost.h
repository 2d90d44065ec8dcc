// SPDX-License-Identifier: BSD-3-Clause
// The cost of the solves of a body (equilibrium/solve_cost.h). It is kept as long as the body stays
// the same, so that a user who changes a property need not wait for a measurement each time.
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
