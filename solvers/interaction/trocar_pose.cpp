// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/trocar_pose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "assembly/cross_matrix.h"
#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

constexpr double kUnit = 1e-9;
/// Where the tip moves by half of its way to the trocar, the tool turns by this at the most, rad.
constexpr double kTurn = M_PI / 6;
/// Farther from b a bound on how the tool turns is of no use, rad.
constexpr double kFarthest = 0.75 * M_PI;

std::string in_degrees(double radians) { return quantity(radians * 180 / M_PI, "degrees"); }

/// The least rotation from b to a.
class LeastRotation {
 public:
  LeastRotation(const Vec3& from, const Vec3& to)
      : from_(from), v_(from.cross(to)), k_(1 / (1 + from.dot(to))) {}

  [[nodiscard]] Mat3 value() const {
    return (1 / k_ - 1) * Mat3::Identity() + cross_matrix(v_) + k_ * v_ * v_.transpose();
  }
  /// The derivative where a changes by `way`.
  [[nodiscard]] Mat3 along(const Vec3& way) const {
    const Vec3 dv = from_.cross(way);
    const double dc = from_.dot(way);
    return dc * Mat3::Identity() + cross_matrix(dv) + k_ * twice(dv, v_) -
           k_ * k_ * dc * v_ * v_.transpose();
  }
  /// The second derivative in two directions of a.
  [[nodiscard]] Mat3 along_two(const Vec3& first, const Vec3& second) const {
    const Vec3 dv = from_.cross(first), dw = from_.cross(second);
    const double dc = from_.dot(first), dd = from_.dot(second);
    return k_ * twice(dv, dw) - k_ * k_ * (dd * twice(dv, v_) + dc * twice(dw, v_)) +
           2 * k_ * k_ * k_ * dc * dd * v_ * v_.transpose();
  }

 private:
  static Mat3 twice(const Vec3& x, const Vec3& y) { return x * y.transpose() + y * x.transpose(); }
  Vec3 from_;
  Vec3 v_;
  double k_;
};

class TrocarPose final : public PoseMap {
 public:
  explicit TrocarPose(const Trocar& trocar)
      : trocar_(trocar),
        from_axis_(
            Eigen::Quaterniond::FromTwoVectors(trocar.axis, trocar.towards).toRotationMatrix()) {}

  [[nodiscard]] int num_coordinates() const noexcept override { return 3; }

  [[nodiscard]] Pose at(const Eigen::VectorXd& q) const override {
    const Vec3 tip = q;
    const Vec3 along = (trocar_.place - tip).normalized();
    Pose pose;
    pose.rotation = LeastRotation(trocar_.towards, along).value() * from_axis_;
    pose.place = tip - pose.rotation * trocar_.tip;
    return pose;
  }

  [[nodiscard]] PoseJet evaluate(const Eigen::VectorXd& q, int order) const override {
    PoseJet pose(3);
    pose.turns = true;
    const Vec3 tip = q;
    const Vec3 way = trocar_.place - tip;
    const double length = way.norm();
    const Vec3 a = way / length;
    const LeastRotation turn(trocar_.towards, a);
    const auto complete = [&](const Mat3& rotation, Mat3& full, Vec3& place) {
      full = rotation * from_axis_;
      place -= full * trocar_.tip;
    };
    pose.place = tip;
    complete(turn.value(), pose.rotation, pose.place);
    if (order < 1) return pose;
    // ∂a/∂q = −(I − a aᵀ)/|o − q|.
    const Mat3 across = (Mat3::Identity() - a * a.transpose()) / length;
    for (int i = 0; i < 3; ++i) {
      pose.place_by[i] = Vec3::Unit(i);
      complete(turn.along(-across.col(i)), pose.rotation_by[i], pose.place_by[i]);
    }
    if (order < 2) return pose;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const Vec3 bend =
            -(across.col(j) * a[i] + a * across(i, j) + across.col(i) * a[j]) / length;
        complete(turn.along_two(-across.col(i), -across.col(j)) + turn.along(bend),
                 pose.rotation_by_two[i][j], pose.place_by_two[i][j]);
      }
    }
    return pose;
  }

  [[nodiscard]] bool allows(const Eigen::VectorXd& q) const override {
    const Vec3 way = trocar_.place - Vec3(q);
    return tilt(way) <= trocar_.tilt && !is_too_deep(way);
  }

  void check(const Eigen::VectorXd& q) const override {
    const Vec3 way = trocar_.place - Vec3(q);
    const std::string where = "The tip at " + quantity(Vec3(q), "m") + " is ";
    const std::string trocar = "the trocar at " + quantity(trocar_.place, "m");
    if (!(tilt(way) <= M_PI / 2)) {
      throw InputError(where + "at the trocar or beyond it: see " + trocar +
                       ". Move the trocar (TrocarPoint) to the other side of the tip.");
    }
    if (!(tilt(way) <= trocar_.tilt)) {
      throw InputError(where + in_degrees(tilt(way)) + " aside of the way from the body to " +
                       trocar + ", and MaximumTilt is " + in_degrees(trocar_.tilt) +
                       ". Move the trocar (TrocarPoint), or allow more.");
    }
    if (is_too_deep(way)) {
      throw InputError(where + quantity(way.norm(), "m") + " from " + trocar +
                       ", and MaximumDepth is " + quantity(trocar_.depth, "m") +
                       ". Move the trocar (TrocarPoint), or allow more.");
    }
  }

  // A point at s along the axis from the tip, and e beside it, moves by |1 − s/r| across the axis
  // and by e times the change of the rotation, which is (1 + tan ½θ)/r at the angle θ to b.
  [[nodiscard]] Stretch stretch(const Eigen::VectorXd& q,
                                const Eigen::AlignedBox3d& bounds) const override {
    const Vec3 way = trocar_.place - Vec3(q);
    const double length = way.norm();
    const double within = 0.5 * length;
    double along = 1, aside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 x =
          bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - trocar_.tip;
      const double s = trocar_.axis.dot(x);
      along = std::max(along, std::abs(1 - s / within));
      aside = std::max(aside, (x - s * trocar_.axis).norm());
    }
    const double half = std::tan(0.5 * (std::min(tilt(way), kFarthest) + kTurn));
    return {along + aside * (1 + half) / within, within};
  }

 private:
  /// The angle to b, rad; no number at the trocar itself.
  [[nodiscard]] double tilt(const Vec3& way) const {
    return std::acos(std::clamp(trocar_.towards.dot(way) / way.norm(), -1.0, 1.0));
  }
  [[nodiscard]] bool is_too_deep(const Vec3& way) const {
    return trocar_.depth > 0 && way.norm() > trocar_.depth;
  }

  Trocar trocar_;
  /// R₀.
  Mat3 from_axis_;
};

}  // namespace

std::vector<double> Trocar::numbers() const {
  std::vector<double> all;
  for (const Vec3* member : {&place, &axis, &tip, &towards}) {
    all.insert(all.end(), member->begin(), member->end());
  }
  all.insert(all.end(), {tilt, depth});
  return all;
}

Trocar Trocar::from(const std::vector<double>& numbers) {
  Trocar trocar;
  if (numbers.size() == kCount) {
    const double* next = numbers.data();
    for (Vec3* member : {&trocar.place, &trocar.axis, &trocar.tip, &trocar.towards}) {
      *member = Eigen::Map<const Vec3>(next);
      next += 3;
    }
    trocar.tilt = next[0];
    trocar.depth = next[1];
  }
  const bool are_finite = std::all_of(numbers.begin(), numbers.end(),
                                      [](double number) { return std::isfinite(number); });
  if (numbers.size() != kCount || !are_finite || std::abs(trocar.axis.norm() - 1) > kUnit ||
      std::abs(trocar.towards.norm() - 1) > kUnit || !(trocar.tilt > 0) ||
      trocar.tilt > M_PI / 2 + kUnit || trocar.depth < 0) {
    throw InputError("The motion of a tool through a trocar has " + std::to_string(numbers.size()) +
                     " numbers, which are not those of one: " + std::to_string(kCount) +
                     " finite ones, with directions of unit length and a tilt of at most a right "
                     "angle. The file was damaged.");
  }
  return trocar;
}

std::string description(const Trocar& trocar) {
  return "through the trocar at " + quantity(trocar.place, "m") + ", tilted by at most " +
         in_degrees(trocar.tilt) +
         (trocar.depth > 0 ? ", at most " + quantity(trocar.depth, "m") + " deep" : "");
}

PoseMapPtr trocar_pose(const Trocar& trocar) { return std::make_shared<const TrocarPose>(trocar); }

}  // namespace palpate
