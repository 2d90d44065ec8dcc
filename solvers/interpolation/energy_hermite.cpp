// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/energy_hermite.h"

#include "interpolation/hermite_data.h"

namespace palpate {

EnergyHermite::EnergyHermite(const TouchToolSpace& tool_space, const InterpolationOptions& options)
    : Interpolator(tool_space),
      correct_mesh_error_(options.correct_mesh_error),
      per_spacing_(1 / grid().spacing()),
      kernel_(best_hermite_kernel()) {
  data_options_.third_derivatives = options.third_derivatives;
  nodes_ = hermite_data(grid(), tool_space.configurations, data_options_);
  take_mesh_error(tool_space, nullptr, nullptr);
}

EnergyHermite::EnergyHermite(const EnergyHermite& before, const TouchToolSpace& tool_space,
                             const std::vector<CheckPoint>& changed, CellTree::Growth&& growth)
    : Interpolator(before, tool_space, changed, growth),
      data_options_(before.data_options_),
      correct_mesh_error_(before.correct_mesh_error_),
      per_spacing_(1 / grid().spacing()),
      kernel_(before.kernel_) {
  const HermiteBefore data_before{growth, before.nodes_, before.memory_};
  nodes_ = hermite_data(grid(), tool_space.configurations, data_options_, &data_before, &memory_);
  take_mesh_error(tool_space, &before, &growth);
}

void EnergyHermite::take_mesh_error(const TouchToolSpace& tool_space, const EnergyHermite* before,
                                    const CellTree::Growth* growth) {
  if (!MeshErrorField::is_known(grid(), tool_space.configurations)) return;
  mesh_error_ = std::make_unique<MeshErrorField>(
      grid(), tool_space.configurations, before != nullptr ? before->mesh_error_.get() : nullptr,
      growth);
  set_tells_mesh_error(correct_mesh_error_ && mesh_error_->corrects());
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
  if (mesh_error_ != nullptr) {
    HermiteJet e;
    kernel_(mesh_error_->nodes().data(), leaf, at.s, e);
    const bool is_corrected = correct_mesh_error_ && mesh_error_->corrects();
    result.mesh_error.take(-per_side * Vec3(e[1], e[2], e[3]), is_corrected);
    result.mesh_error.trust =
        mesh_error_->is_reliable(at.leaf) ? MeshErrorTrust::reliable : MeshErrorTrust::unreliable;
    if (is_corrected) {
      for (std::size_t k = 0; k < d.size(); ++k) d[k] += e[k];
    }
  }
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
