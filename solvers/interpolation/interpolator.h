// SPDX-License-Identifier: BSD-3-Clause
// The force that answers a displacement t of the active node, from the configurations around it.
//
// This is the call of the servo loop: no lock, no allocation, no exception, never a NaN, and within
// the box and at its border no jump of the force.
//
// Where there is a hole. A node without a usable configuration is extrapolated: it has the data of
// the Taylor expansion at the nearest usable node (extrapolated_node.h). A leaf with such a corner
// is evaluated as any other, and its support is `extrapolated`. Where cells of different size meet,
// the smaller ones take at their hanging nodes what the larger one gives there. A node that is
// extrapolated from far away can be wild: in a box with such nodes
//
//   |h| ≤ max(force limit, twice the largest |h| of a usable configuration).
//
// Outside the box. Beyond the border the answer goes on by Taylor's expansion from the nearest
// point t₀ of the box:
//
//   Π(t) = Π₀ + h₀·Δ + ½ Δ·k₀Δ,   h(t) = h₀ + k₀Δ,   Δ = t − t₀
//
// with a k₀ that is continuous along the border, and where the tool space has a force limit, up to
// |h| ≤ max(force limit, |h₀|). It is there no longer the exact gradient of Π: k₀ varies along the
// box. So far out that Π or h overflows there is nothing to go by: nothing is found.
//
// In a sparse grid the tool touches nothing outside the box, and wherever its clearance proves it:
// force, stiffness and energy are exactly zero, and the support is `inside`. A place in no cell
// that is not proved free, deeper than the space or not explored yet, is answered as one outside a
// box, from the nearest cell.
//
// Where the force is limited the stiffness is that of a force of this size, the direction of which
// follows t: (limit/|h|)(I − ĥĥᵀ)k; Π is not.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "interpolation/check_point_grid.h"

namespace palpate {

/// The numbers are those of the interface: keep them.
enum class Method : int {
  trilinear = 0,
  tricubic = 1,
  rbf_linear = 2,
  rbf_cubic = 3,
  energy_hermite = 4,
  /// The stiffness at rest times t.
  linear = 5,
};

/// The methods are in the order of their numbers.
[[nodiscard]] std::vector<Method> all_methods();

/// 'Trilinear', 'Tricubic', 'RBF linear', 'RBF cubic', 'Energy Hermite', 'Linear'.
[[nodiscard]] std::string to_string(Method method);

/// Whether a method needs no box that is full of check-points, and so serves a sparse grid.
[[nodiscard]] constexpr bool serves_sparse_grids(Method method) {
  return method == Method::energy_hermite || method == Method::trilinear;
}

struct InterpolationOptions {
  /// RBF: with a linear polynomial besides the radial functions.
  bool linear_polynomial = true;
  /// RBF: intermediate states are centres too.
  bool intermediate_states = true;
  /// Energy Hermite and extrapolated nodes: third derivatives are used where they are known.
  bool third_derivatives = true;
};

struct TouchResult {
  /// That holds the node at t [3], N; a device feels its opposite.
  Vec3 force = Vec3::Zero();
  /// ∂force/∂t [3×3], N/m.
  Mat3 stiffness = Mat3::Zero();
  /// Potential energy Π, J.
  double energy = 0;
  Support support = Support::none;
};

/// Immutable, and holds all it needs: the tool space may go.
class Interpolator {
 public:
  virtual ~Interpolator() = default;
  Interpolator(const Interpolator&) = delete;
  Interpolator& operator=(const Interpolator&) = delete;

  /// @note Realtime-safe.
  [[nodiscard]] TouchResult evaluate(const Vec3& t) const noexcept;

  using Location = CheckPointGrid::Location;

  /// Where that is in the space.
  /// @note Realtime-safe.
  [[nodiscard]] Location locate(const Vec3& t) const noexcept { return grid_.locate(t); }
  /// The check-points of the tool space.
  [[nodiscard]] const CheckPointGrid& grid() const { return grid_; }
  /// Distance of neighbouring check-points, m.
  [[nodiscard]] double spacing() const noexcept { return grid_.spacing(); }
  /// The side of the cell that a place is in or beside, m.
  [[nodiscard]] double cell_side(const Location& at) const noexcept {
    return grid_.leaf(at.leaf).cell.side * grid_.spacing();
  }

  /// Memory that is held for evaluating.
  void add_memory(MemoryRanges& ranges) const {
    grid_.add_memory(ranges);
    do_add_memory(ranges);
  }
  [[nodiscard]] std::size_t bytes() const {
    MemoryRanges ranges;
    add_memory(ranges);
    return total_bytes(ranges);
  }

  /// Configurations and intermediate states that it interpolates between.
  [[nodiscard]] std::size_t num_samples() const { return num_samples_; }

 protected:
  explicit Interpolator(const TouchToolSpace& tool_space);
  void set_num_samples(std::size_t num) { num_samples_ = num; }
  /// Where nothing comes from extrapolated nodes: the force is h + kΔ from rest whatever is
  /// missing.
  void set_linear_from_rest(const TouchResult& rest);

 private:
  /// Energy, force and stiffness at the place in the box that is given.
  virtual void do_evaluate(const Location& at, TouchResult& result) const noexcept = 0;
  /// Puts in a stiffness that is continuous across cells, if that of do_evaluate() is not.
  virtual void do_smooth_stiffness(const Location& at, Mat3& stiffness) const noexcept;
  /// The object itself too.
  virtual void do_add_memory(MemoryRanges& ranges) const = 0;

  CheckPointGrid grid_;
  double force_limit_;
  /// Largest |force| within the box, N.
  double largest_force_;
  /// The result at rest, where rest is the only check-point.
  TouchResult rest_;
  std::size_t num_samples_ = 0;
};

/// @throws InputError the tool space has no grid, see CheckPointGrid; its grid is sparse and the
///   method is none of energy_hermite and trilinear; its grid is not uniform and the method needs
///   one (tricubic); it has no usable configuration at rest (linear); there is no such method.
[[nodiscard]] std::unique_ptr<Interpolator> make_interpolator(
    Method method, const TouchToolSpace& tool_space, const InterpolationOptions& options = {});

}  // namespace palpate
