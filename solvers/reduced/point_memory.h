// SPDX-License-Identifier: BSD-3-Clause
// The viscosity of a reduced body (materials/rheology.h) at its points, in a time step. The
// potential of the strain at the end of the step, and its recursion, are those of the whole body
// (dynamics/viscosity.h).
#pragma once

#include <array>
#include <vector>

#include "base/memory_ranges.h"
#include "base/types.h"
#include "reduced/reduced_model.h"

namespace palpate {

class PointMemory {
 public:
  /// The body begins at rest.
  /// @param model It must outlive this object.
  explicit PointMemory(const ReducedModel& model);

  [[nodiscard]] bool is_viscous() const { return is_viscous_; }

  /// Sets the state at rest, for a body that is stressed there, and puts the body to rest.
  /// @param law_stress, strain S_∞ and E [48 a packet].
  void set_rest(const std::vector<double>& law_stress, const std::vector<double>& strain);
  /// Puts the body to rest, as if it had been there for long.
  void forget() noexcept;
  /// Prepares a step of length h at whose end the strain changes at the rate w₀ E + w₁ E_n + w₂
  /// E_{n−1}.
  /// @param rate w₀, w₁, w₂, 1/s.
  void begin_step(double h, const Vec3& rate) noexcept;
  /// Ends the step that was prepared.
  /// @param law_stress, strain S_∞ and E at its end [48 a packet].
  void end_step(const double* law_stress, const double* strain) noexcept;

  /// The memory of the step: 1 + Σ a_j [8 a packet], H [48], and τ w₀ C₀ as λ and μ [16]; see
  /// ReducedPointsView.
  [[nodiscard]] const std::vector<double>& factors() const { return factors_; }
  [[nodiscard]] const std::vector<double>& stress() const { return stress_; }
  [[nodiscard]] const std::vector<double>& moduli() const { return moduli_; }

  /// Energies since the beginning, J: the work that was done on the viscosity, and the part of it
  /// that the springs of the Prony series give back.
  [[nodiscard]] double work() const { return work_; }
  [[nodiscard]] double stored() const { return stored_; }

  /// Adds the memory of this object.
  void add_memory(MemoryRanges& ranges) const;

 private:
  struct OfMaterial {
    /// λ and μ of C₀, Pa.
    double lambda = 0;
    double mu = 0;
    /// exp(−h/τ_j) and a_j of the step; 0 for terms that the series lacks.
    std::array<double, max_prony_terms> decay{};
    std::array<double, max_prony_terms> share{};
  };
  /// Calls f(point, index of the first of its six components, number of its material) for each
  /// viscous point; components are eight apart.
  template <class F>
  void for_each_point(F&& f) const noexcept;

  const ReducedModel& model_;
  bool is_viscous_ = false;
  int num_terms_ = 0;
  std::vector<OfMaterial> materials_;
  Vec3 rate_ = Vec3::Zero();
  std::vector<double> factors_;
  std::vector<double> stress_;
  std::vector<double> moduli_;
  /// S_j of each term, S_∞ and E at t_n, E at t_{n−1}, and the viscous stress at t_n.
  std::vector<std::vector<double>> term_stress_;
  std::vector<double> law_stress_;
  std::vector<double> strain_;
  std::vector<double> strain_before_;
  std::vector<double> viscous_;
  /// S_∞ and E at rest.
  std::vector<double> rest_law_stress_;
  std::vector<double> rest_strain_;
  double work_ = 0;
  double stored_ = 0;
};

}  // namespace palpate
