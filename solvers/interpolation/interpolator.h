// SPDX-License-Identifier: BSD-3-Clause
// The force at a displacement t of the active node, from the configurations around it.
//
// The servo loop calls this: it takes no lock, allocates no memory, throws no exception and never
// gives a NaN, and the force does not jump within the box or at its border.
//
// Holes. A node without a usable configuration is extrapolated: it has the data of the Taylor
// expansion at the nearest usable node (extrapolated_node.h). A leaf with such a corner is
// evaluated as any other, with the support `extrapolated`. Where cells of different size meet, the
// hanging nodes of the smaller ones take the values of the larger one. The force of a node that is
// extrapolated from far away can be very large, so that in a box with such nodes it is limited:
//
//   |h| ≤ max(force limit, twice the largest |h| of a usable configuration).
//
// Outside the box, Taylor's expansion at the nearest point t₀ of the box continues the force:
//
//   Π(t) = Π₀ + h₀·Δ + ½ Δ·k₀Δ,   h(t) = h₀ + k₀Δ,   Δ = t − t₀
//
// with a k₀ that is continuous along the border. If the tool space has a force limit, |h| ≤
// max(force limit, |h₀|). The force is not the exact gradient of Π there, since k₀ varies along the
// border. If Π or h overflows so far out, the support is `none`.
//
// In a sparse grid the tool touches nothing outside the box, or wherever its clearance proves it:
// force, stiffness and energy are exactly zero, and the support is `inside`. A place in no cell
// that is not proved free, either deeper than the space or not explored yet, is treated as one
// outside a box, starting from the nearest cell.
//
// The error of the mesh is not continued beyond the box: it is that of the nearest point of the
// box, and not reliable.
//
// Where the force is limited, the stiffness is that of a force of constant size whose direction
// follows t: (limit/|h|)(I − ĥĥᵀ)k. Π is not limited.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "interaction/mesh_error.h"
#include "interpolation/check_point_grid.h"

namespace palpate {

/// The numbers are used in the interface: do not change them.
enum class Method : int {
  trilinear = 0,
  tricubic = 1,
  rbf_linear = 2,
  rbf_cubic = 3,
  energy_hermite = 4,
  /// The force is the stiffness at rest times t.
  linear = 5,
};

/// All methods, in the order of their numbers.
[[nodiscard]] std::vector<Method> all_methods();

/// 'Trilinear', 'Tricubic', 'RBF linear', 'RBF cubic', 'Energy Hermite', 'Linear'.
[[nodiscard]] std::string to_string(Method method);

/// Whether a method serves a sparse grid, since it does not need a box full of check-points.
[[nodiscard]] constexpr bool serves_sparse_grids(Method method) {
  return method == Method::energy_hermite || method == Method::trilinear;
}

struct InterpolationOptions {
  /// RBF: whether a linear polynomial is added to the radial functions.
  bool linear_polynomial = true;
  /// RBF: whether intermediate states are centres too.
  bool intermediate_states = true;
  /// Energy Hermite and extrapolated nodes: whether third derivatives are used where they are
  /// known.
  bool third_derivatives = true;
  /// Energy Hermite: whether Π + ΔΠ is interpolated where the estimates of the error of the mesh
  /// allow it (mesh_error_field.h), so that the force is closer to that of a finer mesh.
  bool correct_mesh_error = true;
  /// A rigid tool: how far from a configuration its expansion is used where there is no cell, m;
  /// 0: the nearest cell is continued (near_states.h).
  double reach_of_states = 0;
};

/// What is known of the error that the mesh makes in a force. The numbers are stored in data arrays
/// and recordings: do not change them.
enum class MeshErrorTrust : int {
  /// The configurations around have no estimate, or the method does not use it.
  none = 0,
  /// There is an estimate that may be wrong by any factor.
  unreliable = 1,
  reliable = 2,
};

/// What the mesh does to a force.
struct TouchMeshError {
  /// By how much the force of the mesh is too large, as estimated [3], N.
  Vec3 force = Vec3::Zero();
  /// How wrong the mesh makes the force that is given, N, if the estimate is reliable: between 0.67
  /// and 1.5 times the true error.
  double bound = 0;
  MeshErrorTrust trust = MeshErrorTrust::none;
  /// Whether the force that is given is smaller by the estimate already.
  bool is_corrected = false;

  /// Takes an estimate of a force and the bound that follows.
  void take(const Vec3& estimate, bool corrected) noexcept {
    force = estimate;
    is_corrected = corrected;
    bound = (corrected ? kMostOfCorrected : kMostOfEstimate) * estimate.norm();
  }
  /// Adds the error of a force that has this weight.
  void add(double weight, const TouchMeshError& other) noexcept {
    force += weight * other.force;
    bound += weight * other.bound;
    trust = std::min(trust, other.trust);
    is_corrected = is_corrected && other.is_corrected;
  }
};

struct TouchResult {
  /// The force that holds the node at t [3], N; a device feels its opposite.
  Vec3 force = Vec3::Zero();
  /// ∂force/∂t [3×3], N/m.
  Mat3 stiffness = Mat3::Zero();
  /// Potential energy Π, J.
  double energy = 0;
  Support support = Support::none;
  TouchMeshError mesh_error;

  /// The beginning of a sum, to which add() adds.
  [[nodiscard]] static TouchResult empty_sum() noexcept {
    TouchResult sum;
    sum.support = Support::inside;
    sum.mesh_error.trust = MeshErrorTrust::reliable;
    sum.mesh_error.is_corrected = true;
    return sum;
  }
  /// Adds a result that has this weight. The sum is as certain as the least certain of its parts.
  void add(double weight, const TouchResult& other) noexcept {
    force += weight * other.force;
    stiffness += weight * other.stiffness;
    energy += weight * other.energy;
    support = less_certain(support, other.support);
    mesh_error.add(weight, other.mesh_error);
  }
};

/// Immutable. It copies all that it needs, so that the tool space need not outlive it.
class Interpolator {
 public:
  virtual ~Interpolator() = default;
  Interpolator(const Interpolator&) = delete;
  Interpolator& operator=(const Interpolator&) = delete;

  /// @note Realtime-safe.
  [[nodiscard]] TouchResult evaluate(const Vec3& t) const noexcept;

  using Location = CheckPointGrid::Location;

  /// The location of a displacement in the space.
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

  /// Makes the interpolator of the same tool space, with the same options, after configurations
  /// were added to the space. Its answers are the same, to the bit, as if it were made anew.
  /// @param changed The check-points of these configurations.
  /// @returns null if growing takes this method no less time than making the interpolator anew.
  [[nodiscard]] virtual std::unique_ptr<Interpolator> grown(
      const TouchToolSpace& /*tool_space*/, const std::vector<CheckPoint>& /*changed*/) const {
    return nullptr;
  }

  /// Adds the memory that evaluate() needs.
  void add_memory(MemoryRanges& ranges) const {
    grid_.add_memory(ranges);
    do_add_memory(ranges);
  }
  [[nodiscard]] std::size_t bytes() const {
    MemoryRanges ranges;
    add_memory(ranges);
    return total_bytes(ranges);
  }

  /// The number of configurations and intermediate states that it interpolates between.
  [[nodiscard]] std::size_t num_samples() const { return num_samples_; }

 protected:
  explicit Interpolator(const TouchToolSpace& tool_space);
  /// @param before The interpolator before configurations were added to the tool space.
  Interpolator(const Interpolator& before, const TouchToolSpace& tool_space,
               const std::vector<CheckPoint>& changed, CellTree::Growth& growth);
  void set_num_samples(std::size_t num) { num_samples_ = num; }
  /// Call this in a method that uses no extrapolated nodes: the force is h + kΔ from rest, and is
  /// not limited because of missing nodes.
  void set_linear_from_rest(const TouchResult& rest);
  /// Call this if do_evaluate() tells the error of the mesh.
  /// @param is_corrected Whether the force is smaller by that.
  void set_tells_mesh_error(bool is_corrected) {
    mesh_error_of_free_.trust = MeshErrorTrust::reliable;
    mesh_error_of_free_.is_corrected = is_corrected;
  }

 private:
  /// Computes energy, force and stiffness at a place in the box.
  virtual void do_evaluate(const Location& at, TouchResult& result) const noexcept = 0;
  /// Replaces the stiffness by one that is continuous across cells, if that of do_evaluate() is
  /// not.
  virtual void do_smooth_stiffness(const Location& at, Mat3& stiffness) const noexcept;
  /// Adds the memory of the derived object, the object itself included.
  virtual void do_add_memory(MemoryRanges& ranges) const = 0;

  void take_samples(const std::vector<ConfigurationSummary>& configurations);

  CheckPointGrid grid_;
  double force_limit_;
  /// Bound of |force| within the box, N; infinite if no node is extrapolated.
  double largest_force_;
  /// The result at rest, if rest is the only check-point.
  TouchResult rest_;
  /// What is told where the tool touches nothing.
  TouchMeshError mesh_error_of_free_;
  std::size_t num_samples_ = 0;
};

/// @throws InputError the tool space has no grid, see CheckPointGrid; its grid is sparse and the
///   method is neither energy_hermite nor trilinear; its grid is not uniform and the method needs
///   one (tricubic); it has no usable configuration at rest (linear); there is no such method.
[[nodiscard]] std::unique_ptr<Interpolator> make_interpolator(
    Method method, const TouchToolSpace& tool_space, const InterpolationOptions& options = {});

/// Makes the interpolator of a tool space to which configurations were added.
/// @param before The interpolator before they were added, with the same method and options; null:
///   there is none.
/// @param changed The check-points of these configurations.
[[nodiscard]] std::unique_ptr<Interpolator> make_interpolator(
    Method method, const TouchToolSpace& tool_space, const InterpolationOptions& options,
    const Interpolator* before, const std::vector<CheckPoint>& changed);

}  // namespace palpate
