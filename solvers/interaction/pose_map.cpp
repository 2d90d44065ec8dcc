// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/pose_map.h"

#include "base/error.h"

namespace palpate {
namespace {

class TranslatedPose final : public PoseMap {
 public:
  [[nodiscard]] int num_coordinates() const noexcept override { return 3; }
  [[nodiscard]] PoseJet evaluate(const Eigen::VectorXd& q, int order) const override {
    PoseJet pose(3);
    pose.place = q;
    if (order > 0) {
      for (int i = 0; i < 3; ++i) pose.place_by[i] = Vec3::Unit(i);
    }
    return pose;
  }
  [[nodiscard]] Pose at(const Eigen::VectorXd& q) const override { return {q, Mat3::Identity()}; }
  [[nodiscard]] Stretch stretch(const Eigen::VectorXd& /*q*/,
                                const Eigen::AlignedBox3d& /*bounds*/) const override {
    return {};
  }
};

}  // namespace

PoseJet::PoseJet(int coordinates) : num_coordinates(coordinates) {
  place_by.fill(Vec3::Zero());
  rotation_by.fill(Mat3::Zero());
  for (auto& row : place_by_two) row.fill(Vec3::Zero());
  for (auto& row : rotation_by_two) row.fill(Mat3::Zero());
}

PoseColumns PoseJet::point_by(const Vec3& y) const {
  PoseColumns columns(3, num_coordinates);
  for (int i = 0; i < num_coordinates; ++i) {
    columns.col(i) = -(rotation.transpose() * place_by[i]);
    if (turns) columns.col(i) += rotation_by[i].transpose() * (rotation * y);
  }
  return columns;
}

PoseColumns PoseJet::direction_by(const Vec3& n) const {
  PoseColumns columns(3, num_coordinates);
  for (int i = 0; i < num_coordinates; ++i) columns.col(i) = rotation_by[i].transpose() * n;
  return columns;
}

Vec3 PoseJet::point_by_two(const Vec3& y, int i, int j) const {
  return rotation_by_two[i][j].transpose() * (rotation * y) -
         rotation_by[i].transpose() * place_by[j] - rotation_by[j].transpose() * place_by[i] -
         rotation.transpose() * place_by_two[i][j];
}

PoseMap::Stretch PoseMap::stretch(const Eigen::VectorXd& q,
                                  const Eigen::AlignedBox3d& /*bounds*/) const {
  if (num_coordinates() == 3) {
    const PoseJet at = evaluate(q, 1);
    const bool is_place = at.place == Vec3(q) && at.place_by[0] == Vec3::UnitX() &&
                          at.place_by[1] == Vec3::UnitY() && at.place_by[2] == Vec3::UnitZ();
    if (is_place && !at.turns) return {};
  }
  throw InputError(
      "The tool turns as it moves, or its coordinates are not the place of its centre. The way on "
      "which such a tool comes to a body is not found. Choose another motion of the tool.");
}

PoseMapPtr translated_pose() {
  static const PoseMapPtr pose = std::make_shared<const TranslatedPose>();
  return pose;
}

}  // namespace palpate
