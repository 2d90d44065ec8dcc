// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/energy_hermite.h"

#include "interpolation/hermite_data.h"

namespace palpate {

EnergyHermite::EnergyHermite(const TouchToolSpace& tool_space, const InterpolationOptions& options)
    : Interpolator(tool_space), per_spacing_(1 / grid().spacing()), kernel_(best_hermite_kernel()) {
  data_options_.third_derivatives = options.third_derivatives;
  nodes_ = hermite_data(grid(), tool_space.configurations, data_options_);
}

EnergyHermite::EnergyHermite(const EnergyHermite& before, const TouchToolSpace& tool_space,
                             const std::vector<CheckPoint>& changed, CellTree::Growth&& growth)
    : Interpolator(before, tool_space, changed, growth),
      data_options_(before.data_options_),
      per_spacing_(1 / grid().spacing()),
      kernel_(before.kernel_) {
  const HermiteBefore data_before{growth, before.nodes_, before.memory_};
  nodes_ = hermite_data(grid(), tool_space.configurations, data_options_, &data_before, &memory_);
}

std::unique_ptr<Interpolator> EnergyHermite::grown(const TouchToolSpace& tool_space,
                                                   const std::vector<CheckPoint>& changed) const {
  return std::unique_ptr<Interpolator>(new EnergyHermite(*this, tool_space, changed, {}));
}

void EnergyHermite::do_evaluate(const Location& at, TouchResult& result) const noexcept {
  const CellTree::Leaf& leaf = grid().leaf(at.leaf);
  const double per_side = per_spacing_ / leaf.cell.side;
  const double per_side2 = per_side * per_side;
  HermiteJet d;
  kernel_(nodes_.data(), leaf, at.s, d);
  result.energy = d[0];
  for (int i = 0; i < 3; ++i) {
    result.force[i] = per_side * d[1 + i];
    result.stiffness(i, i) = per_side2 * d[4 + i];
  }
  result.stiffness(0, 1) = result.stiffness(1, 0) = per_side2 * d[7];
  result.stiffness(0, 2) = result.stiffness(2, 0) = per_side2 * d[8];
  result.stiffness(1, 2) = result.stiffness(2, 1) = per_side2 * d[9];
}

}  // namespace palpate
