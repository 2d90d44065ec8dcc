// SPDX-License-Identifier: BSD-3-Clause
// A tool that is moved and turned: its coordinates are the place of its centre, m, and three angles
// about the axes of the scene, rad, R = R_z(q₅) R_y(q₄) R_x(q₃).
#pragma once

#include <Eigen/Geometry>

#include "interaction/pose_map.h"

namespace palpate::test {

class TurnedPose final : public PoseMap {
 public:
  [[nodiscard]] int num_coordinates() const noexcept override { return 6; }
  [[nodiscard]] PoseJet evaluate(const Eigen::VectorXd& q, int /*order*/) const override {
    PoseJet pose(6);
    pose.turns = true;
    pose.place = q.head<3>();
    for (int i = 0; i < 3; ++i) pose.place_by[i] = Vec3::Unit(i);
    pose.rotation = product(q, {0, 0, 0});
    for (int i = 0; i < 3; ++i) {
      std::array<int, 3> by{};
      ++by[i];
      pose.rotation_by[3 + i] = product(q, by);
      for (int j = 0; j < 3; ++j) {
        std::array<int, 3> by_two = by;
        ++by_two[j];
        pose.rotation_by_two[3 + i][3 + j] = product(q, by_two);
      }
    }
    return pose;
  }

 private:
  /// R, differentiated so many times by each angle.
  static Mat3 product(const Eigen::VectorXd& q, const std::array<int, 3>& by) {
    Mat3 result = Mat3::Identity();
    for (int axis = 2; axis >= 0; --axis) {
      const Vec3 about = Vec3::Unit(axis);
      Mat3 turn = Eigen::AngleAxisd(q[3 + axis], about).toRotationMatrix();
      Mat3 cross;
      cross << 0, -about[2], about[1], about[2], 0, -about[0], -about[1], about[0], 0;
      for (int n = 0; n < by[axis]; ++n) turn = cross * turn;
      result = result * turn;
    }
    return result;
  }
};

}  // namespace palpate::test
