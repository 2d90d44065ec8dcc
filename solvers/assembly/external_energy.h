// SPDX-License-Identifier: BSD-3-Clause
// The energy of what acts on a body from outside: its weight, tractions, pressures, and springs.
//
//   −Σ_a u_a · (∫ ρ g N_a dV + ∫ t N_a dA) + p (V(u) − V(0)) + ½ ∫ κ |u|² dA
//
// with areas and volumes at rest but for V, what the pressed surface encloses together with any
// surface that does not move. Its change is what the surface sweeps over on the way from rest,
//
//   V(u) − V(0) = ∫₀¹ ∫ u · n dA ds   on the surface x + s u, with its outward normal n,
//
// which a rule of two points in s and one of degree 5 on a face give exactly. The force p ∫ N_a n
// dA on the deformed surface is its derivative, whatever the way, only where the rim of the pressed
// surface does not move, or slides in a plane (supports.h): there alone the tangent is symmetric.
// Source: Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2008, 8.5.2.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/energy_term.h"
#include "assembly/loaded_faces.h"
#include "assembly/point_matrix.h"

namespace palpate {

/// K_s of the springs that support the surface; none where there are none.
/// @param scene It was checked, see check().
[[nodiscard]] std::optional<PointMatrix> springs_of(const Scene& scene, const Assembly& assembly);

class ExternalEnergy final : public EnergyTerm {
 public:
  /// @param scene It was checked, see check().
  ExternalEnergy(const Scene& scene, const Assembly& assembly);

  /// How much of the loads acts, all in the same share; springs hold in any case.
  void set_share(double share) { share_ = share; }

  /// Lets the energy count from there: the body has none there, with that of its materials.
  /// @param of_materials Their energy there, J.
  void count_from(const NodalVector& rest, double of_materials);

  double add(const NodalVector& state, NodalVector& force,
             std::vector<double>* values) const override;

  /// That of the springs, J.
  [[nodiscard]] double of_springs(const NodalVector& state) const;

 private:
  struct PressedFace {
    std::array<Index, 6> nodes;
    double pressure;
  };
  /// Where the block of two nodes of a face is in a tangent.
  struct Target {
    int a, b;
    bool is_diagonal;
    std::array<Index, 3> positions;
  };

  void add_traction(const Scene& scene);
  void add_pressure(const Scene& scene, const Assembly& assembly);
  /// Of pressures and springs, J.
  [[nodiscard]] double of_surface(const NodalVector& state) const;
  /// The work of the pressures on the way from rest, J.
  [[nodiscard]] double of_pressures(const NodalVector& state) const;
  void add_force_of_pressure(const NodalVector& state, NodalVector& force) const;
  void add_tangent_of_pressure(const NodalVector& state, std::vector<double>& values) const;
  /// The nodes of a face when the body is displaced by a share of the state, m.
  [[nodiscard]] Eigen::Matrix3Xd nodes_of(const PressedFace& face, double share,
                                          const NodalVector& state) const;

  double share_ = 1;
  /// Loads that are the same however the body deforms, N [state_size].
  NodalVector dead_;
  std::optional<PointMatrix> springs_;
  std::vector<FacePoint> rule_;
  int nodes_per_face_;
  std::vector<Vec3> points_;
  std::vector<PressedFace> pressed_;
  /// Those of each pressed face, face by face, and where they begin.
  std::vector<Target> targets_;
  std::vector<std::size_t> first_target_;
  /// Empty: energies count from the undeformed body.
  NodalVector rest_;
  double surface_at_rest_ = 0;
  double materials_at_rest_ = 0;
};

}  // namespace palpate
