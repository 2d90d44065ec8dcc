// SPDX-License-Identifier: BSD-3-Clause
// The energy of a reduced body, its force and its tangent at y = (q, d), see reduced_model.h.
#pragma once

#include <vector>

#include "base/memory_ranges.h"
#include "base/types.h"
#include "reduced/kernels.h"
#include "reduced/reduced_model.h"

namespace palpate {

class ReducedEnergy {
 public:
  /// The constructor allocates all memory.
  /// @param points, materials They must outlive this object.
  ReducedEnergy(const ReducedPoints& points, const std::vector<Material>& materials);
  /// The energy of a model, with the springs that support it.
  /// @param model It must outlive this object.
  explicit ReducedEnergy(const ReducedModel& model);

  /// A further potential of the strain, see ReducedPointsView; null: there is none.
  struct Memory {
    const double* factors = nullptr;
    const double* stress = nullptr;
    const double* moduli = nullptr;
  };
  void set_memory(const Memory& memory) noexcept { memory_ = memory; }

  /// Evaluates the energy at y, and ∂Π/∂y in force(). `potential` is Π with memory, up to a
  /// constant. `elastic` is without memory, and with gravity is 0 at y = 0.
  /// @param y [coordinates]
  /// @note Realtime-safe.
  ReducedSums evaluate(const double* y) noexcept { return evaluate(y, nullptr); }
  /// Evaluates, and computes tangent() too.
  ReducedSums linearise(const double* y) noexcept;

  /// Results of the last evaluation: ∂Π/∂y [coordinates], and the lower triangle of ∂²Π/∂y² in
  /// single precision.
  [[nodiscard]] const Eigen::VectorXd& force() const { return force_; }
  [[nodiscard]] const Eigen::MatrixXd& tangent() const { return tangent_; }
  /// Results of the last evaluation at each point: w P minus that of the weight [72 a packet], N m,
  /// S of the law [48], Pa, and E [48].
  [[nodiscard]] const std::vector<double>& stress() const { return stress_; }
  [[nodiscard]] const std::vector<double>& law_stress() const { return law_stress_; }
  [[nodiscard]] const std::vector<double>& strain() const { return strain_; }

  /// Adds the memory of this object.
  void add_memory(MemoryRanges& ranges) const;

 private:
  ReducedSums evaluate(const double* y, float* tangent_of_points) noexcept;
  /// Adds the energy and the force of the springs.
  void add_springs(const double* y, ReducedSums& sums) noexcept;
  /// Subtracts the weight from an evaluation.
  void take_weight(ReducedSums& sums) noexcept;

  const ReducedPoints& points_;
  /// Null: there are no springs.
  const Eigen::MatrixXd* support_stiffness_ = nullptr;
  /// The force of the springs.
  Eigen::VectorXd of_springs_;
  const ReducedKernels& kernels_;
  Memory memory_;
  /// The constants of the laws, for each group.
  std::vector<std::vector<double>> constants_;
  std::vector<double> gradients_;
  std::vector<double> stress_;
  std::vector<double> law_stress_;
  std::vector<double> strain_;
  /// w P at rest under gravity, N m, and the energy there, J; empty: there is no gravity.
  Eigen::VectorXd rest_stress_;
  double rest_elastic_ = 0;
  /// G in single precision, and work space of the tangent.
  Eigen::MatrixXf single_gradients_;
  std::vector<float> tangent_of_points_;
  std::vector<float> room_;
  Eigen::VectorXd force_;
  Eigen::MatrixXd tangent_;
};

}  // namespace palpate
