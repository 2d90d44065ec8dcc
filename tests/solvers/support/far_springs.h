// SPDX-License-Identifier: BSD-3-Clause
// Springs between points that share no cell: an energy for which the pattern of the materials has
// no room.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "assembly/energy_term.h"
#include "mesh/tet_mesh.h"

namespace palpate::test {

/// Σ ½ k (|x_b − x_a| − l)², and for one pair u_a · M u_b, whose block is not symmetric.
class FarSprings final : public EnergyTerm {
 public:
  struct Spring {
    Index a = 0;
    Index b = 0;
    /// N/m.
    double stiffness = 0;
    /// Length without force, m.
    double length = 0;
  };

  explicit FarSprings(const TetMesh& mesh) : points_(mesh.points) {}

  void add_spring(const Spring& spring) { springs_.push_back(spring); }
  /// Tells pairs that no spring couples, as a term does whose pairs change.
  void set_spare_pairs(std::vector<PointPair> pairs) { spare_ = std::move(pairs); }
  void set_skew(Index a, Index b, const Mat3& m) {
    skewed_ = {a, b};
    skew_ = m;
  }
  void set_longest_step(double step) { longest_step_ = step; }

  [[nodiscard]] double length(const NodalVector& state, Index a, Index b) const {
    return way(state, a, b).norm();
  }

  double add(const NodalVector& state, NodalVector& force,
             std::vector<double>* /*values*/) const override {
    double energy = 0;
    for (const Spring& s : springs_) {
      const Vec3 along = way(state, s.a, s.b);
      const double stretch = along.norm() - s.length;
      energy += 0.5 * s.stiffness * stretch * stretch;
      const Vec3 pull = s.stiffness * stretch * along.normalized();
      force.segment<3>(3 * Eigen::Index{s.b}) += pull;
      force.segment<3>(3 * Eigen::Index{s.a}) -= pull;
    }
    const auto of_a = Eigen::seqN(3 * Eigen::Index{skewed_.a}, 3);
    const auto of_b = Eigen::seqN(3 * Eigen::Index{skewed_.b}, 3);
    energy += state(of_a).dot(skew_ * state(of_b));
    force(of_a) += skew_ * state(of_b);
    force(of_b) += skew_.transpose() * state(of_a);
    return energy;
  }

  void take_blocks(const NodalVector& state, PairBlocks& blocks) const override {
    blocks.pairs = spare_;
    blocks.values.assign(spare_.size(), Mat3::Zero());
    const auto add = [&](Index a, Index b, const Mat3& block) {
      blocks.pairs.push_back({a, b});
      blocks.values.push_back(block);
    };
    add(skewed_.a, skewed_.b, skew_);
    for (const Spring& s : springs_) {
      const Mat3 block = block_of(state, s);
      add(s.a, s.b, -block);
      add(s.a, s.a, block);
      add(s.b, s.b, block);
    }
  }

  [[nodiscard]] double longest_step() const override { return longest_step_; }

  /// The second derivative with respect to either end.
  [[nodiscard]] Mat3 block_of(const NodalVector& state, const Spring& s) const {
    const Vec3 along = way(state, s.a, s.b);
    const Vec3 n = along.normalized();
    const double tension = s.stiffness * (along.norm() - s.length);
    return s.stiffness * n * n.transpose() +
           tension / along.norm() * (Mat3::Identity() - n * n.transpose());
  }
  [[nodiscard]] const std::vector<Spring>& springs() const { return springs_; }

 private:
  [[nodiscard]] Vec3 way(const NodalVector& state, Index a, Index b) const {
    return points_[b] + state.segment<3>(3 * Eigen::Index{b}) - points_[a] -
           state.segment<3>(3 * Eigen::Index{a});
  }

  std::vector<Vec3> points_;
  std::vector<Spring> springs_;
  std::vector<PointPair> spare_;
  PointPair skewed_;
  Mat3 skew_ = Mat3::Zero();
  double longest_step_ = std::numeric_limits<double>::infinity();
};

}  // namespace palpate::test
