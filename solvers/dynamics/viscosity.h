// SPDX-License-Identifier: BSD-3-Clause
// The viscosity of a body (materials/rheology.h) in a time step, as a potential of the strain E at
// the end of the step. Let h be the length of the step from t_n, S_j the stress of each term of the
// Prony series, and x = h/τ_j. With S_∞ changing linearly [Taylor],
//
//   S_j(t_n + h) = exp(−x) S_j(t_n) + a_j (S_∞(E) − S_∞(E_n)),   a_j = g_j (1 − exp(−x)) / x
//
// so that, with Ė ≈ w₀ E + w₁ E_n + w₂ E_{n−1}, the whole stress is the derivative of
//
//   (1 + Σ a_j) W(E) + H : E + ½ E : (τ w₀ C₀) : E
//   H = Σ [exp(−x) S_j(t_n) − a_j S_∞(E_n)] + τ C₀ : (w₁ E_n + w₂ E_{n−1})
//
// and the tangent is symmetric. Mixed materials (Formulation) change their volume elastically: W
// and S_∞ are those of W_rest there (materials/material.h), and C₀ has its deviatoric part alone,
// since the rest would lock.
//
// [Taylor] Taylor, Pister & Goudreau, Thermomechanical analysis of viscoelastic solids, Int. J.
// Numer. Meth. Engng. 2, 1970.
#pragma once

#include <vector>

#include "assembly/assembly.h"
#include "assembly/scene.h"
#include "materials/rheology.h"

namespace palpate {

class Viscosity {
 public:
  /// Begins with a body that is at rest, or was strained for so long that S_j = 0.
  /// @param scene, assembly They must outlive this object.
  /// @param rheologies One for each material of the scene.
  /// @param state The state of the body.
  Viscosity(const Scene& scene, const std::vector<Rheology>& rheologies, Assembly& assembly,
            const NodalVector& state);

  /// Prepares a step that is evaluated at the time t_n + h.
  /// @param rate w₀, w₁, w₂, 1/s.
  /// @returns Whether the stiffness of the potential differs from that of the step before.
  bool begin_step(double h, const Vec3& rate);
  /// H and τ w₀ C₀ of the step.
  [[nodiscard]] const Memory& memory() const { return memory_; }
  /// The factors that Assembly::scale_energy() was given: 1 + Σ a_j of each material.
  [[nodiscard]] const std::vector<double>& factors() const { return factors_; }

  /// Ends a step of length h, with the state after it.
  /// @param rate The weights w₀, w₁, w₂ of the strain rate at its end, 1/s.
  void end_step(double h, const Vec3& rate, const NodalVector& state);

  /// The viscous stress at t_n, as a potential.
  [[nodiscard]] const Memory& stress_now() const { return viscous_; }

  /// Energies since the beginning, J: the work that was done on the viscosity, and the part of it
  /// that the springs of the Prony series give back, ½ Σ S_j : C₀⁻¹ : S_j / g_j. (For a law that is
  /// not quadratic in E, C₀ is an approximation in this.)
  [[nodiscard]] double work() const { return work_; }
  [[nodiscard]] double stored() const { return stored_; }

 private:
  struct OfMaterial {
    Rheology rheology;
    /// λ and μ of C₀, Pa.
    double lambda = 0;
    double mu = 0;
  };
  /// Calls f(group, index of the first of six components, material of the cell, weight) for each
  /// quadrature point of a viscous material; components are kPacketSize apart.
  template <class F>
  void for_each_point(F&& f) const;
  /// Computes S_∞ at a state.
  void law_stress(const NodalVector& state, PointTensors& stress);

  const Scene& scene_;
  Assembly& assembly_;
  std::vector<OfMaterial> materials_;
  std::vector<std::vector<Index>> cells_;
  int num_terms_ = 0;
  std::vector<double> factors_;
  Memory memory_;
  double last_rate_ = 0;
  /// S_j, S_∞ and E at t_n, E at t_{n−1}, and the viscous stress at t_n.
  std::vector<PointTensors> term_stress_;
  PointTensors stress_;
  PointTensors strain_;
  PointTensors strain_before_;
  Memory viscous_;
  double work_ = 0;
  double stored_ = 0;
};

}  // namespace palpate
