// SPDX-License-Identifier: BSD-3-Clause
// Triquintic Hermite interpolation of the energy; the force is its exact gradient, the stiffness
// its exact Hessian. On a cell of side H, with local coordinates s ∈ [0,1]³,
//
//   Π   = Σ D^{abc} B_a(s_x) B_b(s_y) B_c(s_z),   a, b, c ∈ {0, 1, 2}, over the eight corners,
//   h_x = (1/H) Σ D^{abc} B'_a B_b B_c,  …        k_xy = (1/H²) Σ D^{abc} B'_a B'_b B_c,  …
//
// with D^{abc} = H^{a+b+c} ∂^{abc}Π (hermite_data.h) and the basis of hermite_cell.h.
//
// Where the tool space has estimates of the error of the mesh, that is interpolated in the same way
// (mesh_error_field.h), told beside the force, and added to Π if that is asked for.
//
// All cells around a corner share its derivatives, and a hanging node has the derivatives of the
// larger cell there. So energy, force and stiffness are continuous, and the work around a closed
// loop is zero.
#pragma once

#include <memory>
#include <vector>

#include "interpolation/hermite_cell.h"
#include "interpolation/hermite_data.h"
#include "interpolation/interpolator.h"
#include "interpolation/mesh_error_field.h"

namespace palpate {

class EnergyHermite final : public Interpolator {
 public:
  EnergyHermite(const TouchToolSpace& tool_space, const InterpolationOptions& options);

  [[nodiscard]] std::unique_ptr<Interpolator> grown(
      const TouchToolSpace& tool_space, const std::vector<CheckPoint>& changed) const override;

 private:
  /// @param growth It is filled in while the base class is constructed.
  EnergyHermite(const EnergyHermite& before, const TouchToolSpace& tool_space,
                const std::vector<CheckPoint>& changed, CellTree::Growth&& growth);

  void do_evaluate(const Location& at, TouchResult& result) const noexcept override;
  void do_add_memory(MemoryRanges& ranges) const override {
    ranges.push_back({this, sizeof *this});
    palpate::add_memory(nodes_, ranges);
    if (mesh_error_) mesh_error_->add_memory(ranges);
  }
  /// Makes the error of the mesh where the tool space has estimates of it.
  /// @param before The interpolator before the grid has grown; null: there is none.
  void take_mesh_error(const TouchToolSpace& tool_space, const EnergyHermite* before,
                       const CellTree::Growth* growth);

  HermiteDataOptions data_options_;
  std::vector<HermiteNode> nodes_;
  /// The data that an interpolator needs which grows from this one; empty unless this one has grown
  /// from another.
  HermiteMemory memory_;
  bool correct_mesh_error_;
  /// Null: there is no estimate.
  std::unique_ptr<MeshErrorField> mesh_error_;
  double per_spacing_;
  HermiteKernel kernel_;
};

}  // namespace palpate
