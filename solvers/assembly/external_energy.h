// SPDX-License-Identifier: BSD-3-Clause
// The energy of external actions on a body: its weight, tractions, pressures, and springs.
//
//   −Σ_a u_a · (∫ ρ g N_a dV + ∫ t N_a dA) + p (V(u) − V(0)) + ½ ∫ κ |u|² dA
//
// Areas and volumes are those at rest, except V, which is the volume that the pressed surface
// encloses together with any surface that does not move. The change of V is the volume that the
// surface sweeps on the way from rest,
//
//   V(u) − V(0) = ∫₀¹ ∫ u · n dA ds   on the surface x + s u, with its outward normal n,
//
// which two quadrature points in s and a rule of degree 5 on a face give exactly. The force p ∫ N_a
// n dA on the deformed surface is the derivative of this energy, whatever the way, only if the rim
// of the pressed surface does not move or slides in a plane (supports.h); only then is the tangent
// symmetric. Source: Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis,
// 2008, 8.5.2.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/energy_term.h"
#include "assembly/loaded_faces.h"
#include "assembly/point_matrix.h"

namespace palpate {

/// K_s of the springs that support the surface; nothing if there are none.
/// @param body A body that check() accepts.
[[nodiscard]] std::optional<PointMatrix> springs_of(const Body& body, const Assembly& assembly);

class ExternalEnergy final : public EnergyTerm {
 public:
  /// @param scene A scene that check() accepts.
  ExternalEnergy(const Scene& scene, const Assembly& assembly);

  /// Sets the share of all loads that acts; springs always act fully.
  void set_share(double share) { share_ = share; }

  /// Makes the energy count from a state, at which the sum of this energy and that of the materials
  /// is zero.
  /// @param of_materials The energy of the materials in that state, J.
  void count_from(const NodalVector& rest, double of_materials);

  double add(const NodalVector& state, NodalVector& force,
             std::vector<double>* values) const override;

  /// The energy of the springs, J.
  [[nodiscard]] double of_springs(const NodalVector& state) const;

 private:
  struct PressedFace {
    std::array<Index, 6> nodes;
    double pressure;
  };
  /// Positions of the block of two nodes of a face in a tangent.
  struct Target {
    int a, b;
    bool is_diagonal;
    std::array<Index, 3> positions;
  };

  void add_traction(const Body& body);
  void add_pressure(const Body& body, const Assembly& assembly);
  /// The energy of pressures and springs, J.
  [[nodiscard]] double of_surface(const NodalVector& state) const;
  /// The energy of the pressures, which is minus their work on the way from rest, J.
  [[nodiscard]] double of_pressures(const NodalVector& state) const;
  void add_force_of_pressure(const NodalVector& state, NodalVector& force) const;
  void add_tangent_of_pressure(const NodalVector& state, std::vector<double>& values) const;
  /// The nodes of a face when the body is displaced by a share of the state, m.
  [[nodiscard]] Eigen::Matrix3Xd nodes_of(const PressedFace& face, double share,
                                          const NodalVector& state) const;

  double share_ = 1;
  /// Loads that do not depend on the deformation, N [state_size].
  NodalVector dead_;
  std::optional<PointMatrix> springs_;
  std::vector<FacePoint> rule_;
  int nodes_per_face_;
  std::vector<Vec3> points_;
  std::vector<PressedFace> pressed_;
  /// The targets of each pressed face, face by face, and the index of the first one of each face.
  std::vector<Target> targets_;
  std::vector<std::size_t> first_target_;
  /// The state from which energies count; empty: the undeformed body.
  NodalVector rest_;
  double surface_at_rest_ = 0;
  double materials_at_rest_ = 0;
};

}  // namespace palpate
