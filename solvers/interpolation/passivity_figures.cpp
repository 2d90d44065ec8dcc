// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/passivity_figures.h"

#include <algorithm>
#include <cmath>

#include "interpolation/branch_test.h"
#include "interpolation/clearance.h"
#include "interpolation/interpolator.h"

namespace palpate {
namespace {

constexpr int kSamples = 9;

double attraction(const TouchToolSpace& tool_space, const CheckPointGrid& grid) {
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  double largest = 0;
  for (std::size_t l = 0; l < grid.tree().leaves().size(); ++l) {
    if (grid.is_zero(static_cast<std::int32_t>(l))) continue;
    const CellTree::Leaf& leaf = grid.tree().leaves()[l];
    const double side = leaf.cell.side * grid.spacing();
    const Vec3 first = grid.place(leaf.corners[0]);
    ClearanceProbe probe(tool_space.clearance, first + Vec3::Constant(0.5 * side));
    if (probe.value() <= -0.5 * std::sqrt(3.0) * side) continue;
    for (int x = 0; x < kSamples; ++x) {
      for (int y = 0; y < kSamples; ++y) {
        for (int z = 0; z < kSamples; ++z) {
          const Vec3 q = first + side / (kSamples - 1) * Vec3(x, y, z);
          const double force = interpolator->evaluate(q).force.norm();
          if (force > largest && probe.is_free(q)) largest = force;
        }
      }
    }
  }
  return largest;
}

}  // namespace

PassivityFigures passivity_figures(const TouchToolSpace& tool_space) {
  const CheckPointGrid grid(tool_space);
  PassivityFigures figures;
  figures.largest_force = largest_force(tool_space.configurations);
  if (tool_space.clearance) figures.attraction = attraction(tool_space, grid);
  figures.energy_jump = BranchTest(grid, tool_space.configurations).largest_jump();
  return figures;
}

}  // namespace palpate
