// SPDX-License-Identifier: BSD-3-Clause
// The error of the mesh: how much energy a finer mesh would still release, and how much less force
// would hold the tool then.
//
//   ΔΠ(t) = −c ∫ ½ (H* − H) : A(H) : (H* − H) dV,   h_true ≈ h + dΔΠ/dt
//
// H is the displacement gradient of the cells, H* the recovered one (gradient_recovery.h), and A
// the tangent of the law. The integral is the error of the energy as Zienkiewicz and Zhu estimate
// it, in the norm of the deformed body. ΔΠ is a function of the state alone, so its derivative
// follows from the sensitivity v = du/dt, and no other mesh is needed.
//
// In mixed cells the energy depends on their pressure p too, and so does the norm: with the error
// p* − p of the pressure (pressure_recovery.h) it is that of tangent_norm.h.
//
// The factor c = 1.4 was fitted to a liver of quadratic cells (ν = 0.4) which a ball of 10 mm
// presses by 8 mm, and to its refinement into eight cells each, both against meshes that are twice
// as fine, extrapolated. The ratio of the estimated to the true error of the force was between 0.84
// and 1.31 in these twelve cases, with errors of 7 to 35 % of the force. At random places, with ν
// of 0.4 and 0.45, it was as good (tests/benchmark/README.md). On a box of regular bricks the
// estimate is too small (0.6).
//
// At the rim of a bonded tip the stress is infinite, so that the estimate misses more. There c = 3
// was fitted to the seventeen tips of a liver, ν = 0.4, with at least twenty faces under each: the
// ratio was between 0.74 and 1.20. On another liver, and with ν of 0.45, it was as good; with two
// to six faces under the tip it is not.
//
// Mixed cells (ν = 0.49) keep their volume in the mean alone, which makes them softer, and the more
// so the larger they are. The recovered fields do not show that: at random places the ratio was
// between 0.5 and 3.6.
#pragma once

#include <vector>

#include "assembly/assembly.h"
#include "assembly/scene.h"
#include "discretisation/gradient_recovery.h"
#include "discretisation/pressure_recovery.h"
#include "discretisation/tangent_norm.h"
#include "equilibrium/state.h"
#include "interaction/interaction.h"

namespace palpate {

/// As many faces are held under a bonded tip at least, where c was fitted for it.
inline constexpr int kFewestHeldFaces = 16;

struct MeshErrorEstimate {
  /// ΔΠ, J; not positive, except where the body has lost its stability.
  double energy = 0;
  /// By how much the force h that holds the tool is too large in each coordinate [d], N: −dΔΠ/dt.
  Eigen::VectorXd force;
  /// −ΔΠ of each cell [num_cells], J: a mesh is finest for its work where this is the same in all
  /// cells.
  std::vector<double> energy_of_cells;
  /// Whether it is finite and less than half of the force, or about as large as that under a bonded
  /// tip, and no cell of the state is inverted.
  bool is_small = true;
  /// Whether a tool is bonded to points of the body, and to too few faces.
  bool is_bonded = false;
  bool is_bonded_to_few = false;
  /// Whether the body has mixed cells.
  bool is_mixed = false;
  /// Whether the estimate may be trusted: where it is less than half of the force, but not
  /// - for bodies of linear cells, for which c was not fitted, or with mixed ones;
  /// - where a tool is bonded to few faces; the force that holds a single point is an error as a
  ///   whole;
  /// - where the tangent at H and that at H* give different norms: the recovered gradient is too
  /// far
  ///   away for a law that stiffens so steeply;
  /// - for bodies whose parts touch each other, for which it was never measured.
  bool is_reliable = true;
};

class MeshErrorEstimator {
 public:
  /// @param scene It must outlive this object.
  /// @param assembly That of the scene.
  MeshErrorEstimator(const Scene& scene, const Assembly& assembly);

  /// @param at An equilibrium with its sensitivity.
  /// @param tool What acts on the body.
  [[nodiscard]] MeshErrorEstimate estimate(const LinearisedState& at,
                                           const Interaction& tool) const;

 private:
  /// The quadrature points of all cells of one law and formulation, eight to a packet; the last
  /// packet is filled up with its last point, without weight.
  struct Group {
    const TangentNorm* norm = nullptr;
    std::vector<Index> points;
    std::vector<double> weights;
    /// [packets × constants × 8]
    std::vector<double> constants;
    bool is_mixed = false;
    /// 1/κ̂ of mixed cells, 1/Pa [points].
    std::vector<double> compliances;
  };

  /// What the norms depend on, at all quadrature points; a linear function of the state.
  struct Field {
    /// H, and H* − H.
    Gradients h;
    Gradients d;
    /// p and p* − p, Pa; empty if no cell is mixed.
    NodalVector pressure;
    NodalVector pressure_error;
  };

  /// @param p The pressures of mixed cells, Pa; empty: there are none.
  [[nodiscard]] Field field(const Eigen::Ref<const NodalVector>& u,
                            const Eigen::Ref<const NodalVector>& p) const;
  /// The norm at each point of a group, times its weight, J [points, with the filling].
  [[nodiscard]] std::vector<double> norms(const Group& group, const Field& field) const;
  /// The sum over all groups, J.
  [[nodiscard]] double integral(const Field& field) const;
  [[nodiscard]] bool has_mixed_cells() const;
  /// The number of faces of cells all of whose nodes a tool prescribes.
  [[nodiscard]] int num_held_faces(const Interaction& tool) const;

  GradientRecovery recovery_;
  PressureRecovery pressures_;
  std::vector<Group> groups_;
  const TetMesh& mesh_;
  double mean_edge_;
  bool has_contact_;
};

}  // namespace palpate
