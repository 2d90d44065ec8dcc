// SPDX-License-Identifier: BSD-3-Clause
// Several tools that act on one body. Their coordinates follow each other.
#pragma once

#include <memory>
#include <vector>

#include "interaction/interaction.h"

namespace palpate {

class InteractionList final : public Interaction {
 public:
  InteractionList() = default;
  InteractionList(const InteractionList& other);
  InteractionList& operator=(const InteractionList& other);
  InteractionList(InteractionList&&) noexcept = default;
  InteractionList& operator=(InteractionList&&) noexcept = default;
  ~InteractionList() override = default;

  void add(const Interaction& tool);
  [[nodiscard]] Index num_tools() const { return static_cast<Index>(tools_.size()); }
  [[nodiscard]] const Interaction& tool(Index number) const { return *tools_[number]; }
  /// Lets a tool go: from now on it acts on nothing. It keeps its coordinates, which have no
  /// effect.
  /// @param q Its coordinates now, which give the scale of the body's displacement from then on.
  void let_go(Index number, const Eigen::VectorXd& q);

  [[nodiscard]] std::unique_ptr<Interaction> clone() const override;
  [[nodiscard]] Index num_coordinates() const override;
  [[nodiscard]] std::vector<PrescribedPoint> prescribed_points() const override;
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& q) const override;
  [[nodiscard]] double longest_step() const override;
  [[nodiscard]] std::string describe(const Eigen::VectorXd& q) const override;
  [[nodiscard]] std::vector<Vec3> inner_places(const Eigen::VectorXd& q) const override;
  [[nodiscard]] bool has_potential() const override;
  [[nodiscard]] double potential(const Eigen::VectorXd& q, const NodalVector& state,
                                 NodalVector& force, Eigen::VectorXd& of_q) const override;
  [[nodiscard]] std::vector<PointPair> couplings() const override;
  void add_hessian(const Eigen::VectorXd& q, const NodalVector& state,
                   PotentialHessian& hessian) const override;

 private:
  std::vector<std::unique_ptr<Interaction>> tools_;
};

}  // namespace palpate
