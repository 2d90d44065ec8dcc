// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/motion_kind.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"
#include "interaction/kind_list.h"
#include "interaction/trocar_pose.h"
#include "interaction/turned_pose.h"

namespace palpate {
namespace {

constexpr double kNotTurned = 1e-12;

class TranslatedKind final : public MotionKind {
 public:
  TranslatedKind() = default;
  [[nodiscard]] ToolMotion number() const override { return ToolMotion::translated; }
  [[nodiscard]] std::string description(const std::vector<double>& /*numbers*/) const override {
    return "translated";
  }
  [[nodiscard]] PoseMapPtr make(const std::vector<double>& numbers) const override {
    if (numbers.empty()) return translated_pose();
    throw InputError("A tool that is translated has " + std::to_string(numbers.size()) +
                     " numbers for its motion, which has none. The file was damaged.");
  }
};

class TrocarKind final : public MotionKind {
 public:
  TrocarKind() = default;
  [[nodiscard]] ToolMotion number() const override { return ToolMotion::trocar; }
  [[nodiscard]] PoseMapPtr make(const std::vector<double>& numbers) const override {
    return trocar_pose(Trocar::from(numbers));
  }
  [[nodiscard]] std::string description(const std::vector<double>& numbers) const override {
    return palpate::description(Trocar::from(numbers));
  }
  // The tool is moved about the way from the body to the trocar.
  void complete(const Scene& scene, std::vector<double>& numbers) const override {
    if (numbers.size() != Trocar::kCount) return;
    Eigen::Map<Vec3> towards(numbers.data() + Trocar::kTowards);
    if (!towards.isZero(0)) return;
    Vec3 middle = Vec3::Zero();
    double count = 0;
    for (std::size_t p = 0; p < scene.body.touchable.size(); ++p) {
      if (scene.body.touchable[p] == 0) continue;
      middle += scene.body.mesh.points[p];
      ++count;
    }
    const Vec3 way = Eigen::Map<const Vec3>(numbers.data()) - middle / std::max(count, 1.0);
    towards = way.isZero() ? Vec3(Vec3::UnitZ()) : Vec3(way.normalized());
  }
  [[nodiscard]] std::optional<Vec3> torque(const std::vector<double>& numbers,
                                           const Eigen::VectorXd& q,
                                           const Eigen::VectorXd& h) const override {
    return Vec3((Vec3(q) - Trocar::from(numbers).place).cross(Vec3(h)));
  }
};

class TurnedKind final : public MotionKind {
 public:
  TurnedKind() = default;
  [[nodiscard]] ToolMotion number() const override { return ToolMotion::turned; }
  [[nodiscard]] PoseMapPtr make(const std::vector<double>& numbers) const override {
    return turned_pose(Turning::from(numbers));
  }
  [[nodiscard]] std::string description(const std::vector<double>& numbers) const override {
    return palpate::description(Turning::from(numbers));
  }
  void turn(const Eigen::Quaterniond& orientation, std::vector<double>& numbers) const override {
    Turning turning = Turning::from(numbers);
    const Vec3 angles = turning.angles_of(orientation);
    turning.angles.setZero();
    turned_pose(turning)->check(turning.coordinates(Vec3::Zero(), angles));
    turning.angles = angles;
    numbers = turning.numbers();
  }
  [[nodiscard]] std::optional<Vec3> torque(const std::vector<double>& numbers,
                                           const Eigen::VectorXd& q,
                                           const Eigen::VectorXd& h) const override {
    const Turning turning = Turning::from(numbers);
    Vec3 by_angle = Vec3::Zero();
    by_angle.head(turning.num_angles()) = turning.lever * h.tail(turning.num_angles());
    return turning.torque(turning.angles_at(q), by_angle);
  }
};

KindList<MotionKind>& kinds_of_motions() {
  static KindList<MotionKind> all("a motion of a tool", "A rigid tool has the unknown motion",
                                  std::make_unique<const TranslatedKind>(),
                                  std::make_unique<const TrocarKind>(),
                                  std::make_unique<const TurnedKind>());
  return all;
}

}  // namespace

void MotionKind::turn(const Eigen::Quaterniond& orientation,
                      std::vector<double>& /*numbers*/) const {
  if (orientation.vec().norm() <= kNotTurned * orientation.norm()) return;
  throw InputError(
      "ToolOrientation turns the tool, but its Motion leaves it no freedom to turn. Choose the "
      "Motion Turned, or give the ToolOrientation 1 0 0 0.");
}

const MotionKind& motion_kind(ToolMotion number) { return kinds_of_motions().get(number); }

void add_motion_kind(std::unique_ptr<const MotionKind> kind) {
  kinds_of_motions().add(std::move(kind));
}

}  // namespace palpate
