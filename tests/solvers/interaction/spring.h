// SPDX-License-Identifier: BSD-3-Clause
// A tool that pulls at points by springs, as an example of one that has a potential and prescribes
// nothing.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "interaction/interaction.h"

namespace palpate::test {

/// Φ = ½ c Σ_p |u_p − q|².
class Spring final : public Interaction {
 public:
  /// @param stiffness c, N/m.
  Spring(std::vector<Index> points, double stiffness)
      : points_(std::move(points)), stiffness_(stiffness) {}

  [[nodiscard]] std::unique_ptr<Interaction> clone() const override {
    return std::make_unique<Spring>(*this);
  }
  [[nodiscard]] Index num_coordinates() const override { return 3; }
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& q) const override {
    return q.norm();
  }
  [[nodiscard]] std::string describe(const Eigen::VectorXd& q) const override {
    return "springs at " + std::to_string(q.norm()) + " m";
  }
  [[nodiscard]] bool has_potential() const override { return true; }
  [[nodiscard]] double potential(const Eigen::VectorXd& q, const NodalVector& state,
                                 NodalVector& force, Eigen::VectorXd& of_q) const override {
    double sum = 0;
    for (const Index p : points_) {
      const Vec3 stretch = state.segment<3>(3 * Eigen::Index{p}) - q;
      sum += stiffness_ / 2 * stretch.squaredNorm();
      force.segment<3>(3 * Eigen::Index{p}) += stiffness_ * stretch;
      of_q -= stiffness_ * stretch;
    }
    return sum;
  }
  void add_hessian(const Eigen::VectorXd& /*q*/, const NodalVector& /*state*/,
                   PotentialHessian& hessian) const override {
    const Mat3 each = stiffness_ * Mat3::Identity();
    for (const Index p : points_) {
      hessian.of_points.push_back({p, p, each});
      hessian.mixed.push_back({p, 0, -each});
      hessian.of_coordinates += each;
    }
  }

 private:
  std::vector<Index> points_;
  double stiffness_;
};

}  // namespace palpate::test
