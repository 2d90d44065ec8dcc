// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/turned_pose.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "assembly/cross_matrix.h"
#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

constexpr double kOfUnitLength = 1e-9;
/// A share of an angle that is rounding.
constexpr double kRounding = 1e-9;
/// Terms of the power series below: at an angle of π the last one is 1e-17.
constexpr int kTerms = 17;

/// A function of z = |ω|² and its derivatives: Σ (−z)^k / (2k + n)!.
struct Series {
  double value = 0, first = 0, second = 0;

  /// @param n 1: sin|ω|/|ω|, 2: (1 − cos|ω|)/|ω|², 3: (|ω| − sin|ω|)/|ω|³.
  Series(double z, int n) {
    std::array<double, kTerms> terms{};
    double factor = 1;
    for (int i = 2; i <= n; ++i) factor /= i;
    for (int k = 0; k < kTerms; ++k) {
      terms[k] = factor;
      factor /= -double(2 * k + n + 1) * (2 * k + n + 2);
    }
    for (int k = kTerms - 1; k >= 0; --k) {
      value = value * z + terms[k];
      if (k >= 1) first = first * z + k * terms[k];
      if (k >= 2) second = second * z + k * (k - 1) * terms[k];
    }
  }
};

/// exp[ω]× and its derivatives by coordinates θ of which ω is a linear function.
class Exponential {
 public:
  Exponential(const Mat3& axes, const Vec3& angles)
      : angles_(angles),
        w_(cross_matrix(axes * angles)),
        a_(angles.squaredNorm(), 1),
        b_(angles.squaredNorm(), 2) {
    for (int i = 0; i < 3; ++i) by_[i] = cross_matrix(axes.col(i));
  }

  [[nodiscard]] Mat3 value() const { return Mat3::Identity() + a_.value * w_ + b_.value * w_ * w_; }
  [[nodiscard]] Mat3 along(int i) const {
    const double z = 2 * angles_[i];
    return a_.first * z * w_ + a_.value * by_[i] + b_.first * z * w_ * w_ + b_.value * twice(i);
  }
  [[nodiscard]] Mat3 along_two(int i, int j) const {
    const double zi = 2 * angles_[i], zj = 2 * angles_[j], zij = i == j ? 2 : 0;
    return (a_.second * zi * zj + a_.first * zij) * w_ + a_.first * (zi * by_[j] + zj * by_[i]) +
           (b_.second * zi * zj + b_.first * zij) * w_ * w_ +
           b_.first * (zi * twice(j) + zj * twice(i)) +
           b_.value * (by_[i] * by_[j] + by_[j] * by_[i]);
  }

 private:
  [[nodiscard]] Mat3 twice(int i) const { return by_[i] * w_ + w_ * by_[i]; }

  Vec3 angles_;
  Mat3 w_;
  std::array<Mat3, 3> by_;
  Series a_, b_;
};

class TurnedPose final : public PoseMap {
 public:
  explicit TurnedPose(const Turning& turning)
      : turning_(turning), axes_(turning.axes()), from_(turning.orientation.toRotationMatrix()) {}

  [[nodiscard]] int num_coordinates() const noexcept override { return 3 + turning_.num_angles(); }
  [[nodiscard]] Eigen::VectorXd coordinates(const Vec3& place) const override {
    return turning_.coordinates(place, turning_.angles);
  }

  [[nodiscard]] PoseJet evaluate(const Eigen::VectorXd& q, int order) const override {
    const int d = num_coordinates();
    assert(q.size() == d);
    PoseJet pose(d);
    pose.turns = true;
    const Exponential turn(axes_, turning_.angles_at(q));
    const auto complete = [&](const Mat3& rotation, Mat3& full, Vec3& place) {
      full = rotation * from_;
      place -= full * turning_.point;
    };
    pose.place = q.head<3>();
    complete(turn.value(), pose.rotation, pose.place);
    if (order < 1) return pose;
    const double scale = 1 / turning_.lever;
    for (int i = 0; i < 3; ++i) pose.place_by[i] = Vec3::Unit(i);
    for (int i = 3; i < d; ++i) {
      complete(scale * turn.along(i - 3), pose.rotation_by[i], pose.place_by[i]);
    }
    if (order < 2) return pose;
    for (int i = 3; i < d; ++i) {
      for (int j = 3; j < d; ++j) {
        complete(scale * scale * turn.along_two(i - 3, j - 3), pose.rotation_by_two[i][j],
                 pose.place_by_two[i][j]);
      }
    }
    return pose;
  }

  // The corners of a grid of turns may lie beyond the largest angle.
  [[nodiscard]] bool allows(const Eigen::VectorXd& q) const override {
    const double most = std::max(turning_.farthest, turning_.angles.norm());
    return turning_.angles_at(q).norm() <= most * (1 + kRounding);
  }
  void check(const Eigen::VectorXd& q) const override {
    if (allows(q)) return;
    throw InputError("The tool is turned by " +
                     quantity(turning_.angles_at(q).norm() * 180 / M_PI, "degrees") +
                     ", and MaximumTurn is " + quantity(turning_.farthest * 180 / M_PI, "degrees") +
                     ". Turn it less, or allow more.");
  }

  // A point at r from the reference point moves by no more than that does, and by r |θ̇|.
  [[nodiscard]] Stretch stretch(const Eigen::VectorXd& /*q*/,
                                const Eigen::AlignedBox3d& bounds) const override {
    double r = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 x = bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
      r = std::max(r, (x - turning_.point).norm());
    }
    Stretch stretch;
    stretch.most = std::hypot(1, r / turning_.lever);
    return stretch;
  }

 private:
  Turning turning_;
  Mat3 axes_;
  /// R₀.
  Mat3 from_;
};

}  // namespace

Mat3 Turning::axes() const {
  if (num_angles() == 3) return Mat3::Identity();
  const Vec3 along = orientation * axis;
  Mat3 columns = Mat3::Zero();
  columns.col(0) = along.unitOrthogonal();
  columns.col(1) = along.cross(columns.col(0));
  return columns;
}

Vec3 Turning::angles_of(const Eigen::Quaterniond& turned) const noexcept {
  const Eigen::Quaterniond to = turned.normalized();
  const Eigen::AngleAxisd by(
      num_angles() == 3 ? to * orientation.conjugate()
                        : Eigen::Quaterniond::FromTwoVectors(orientation * axis, to * axis));
  return axes().transpose() * (by.angle() * by.axis());
}

Eigen::Quaterniond Turning::orientation_at(const Vec3& theta) const noexcept {
  const Vec3 w = axes() * theta;
  return Eigen::AngleAxisd(w.norm(), w.stableNormalized()) * orientation;
}

Eigen::VectorXd Turning::coordinates(const Vec3& place, const Vec3& theta) const {
  Eigen::VectorXd q(3 + num_angles());
  q << place, lever * theta.head(num_angles());
  return q;
}

Vec3 Turning::angles_at(const Eigen::VectorXd& q) const {
  Vec3 theta = Vec3::Zero();
  theta.head(num_angles()) = q.tail(num_angles()) / lever;
  return theta;
}

Vec3 Turning::torque(const Vec3& theta, const Vec3& by_angle) const noexcept {
  const Mat3 about = axes();
  const Vec3 w = about * theta;
  const double z = w.squaredNorm();
  const Mat3 cross = cross_matrix(w);
  const Mat3 jacobian =
      Mat3::Identity() + Series(z, 2).value * cross + Series(z, 3).value * cross * cross;
  Mat3 power = (jacobian * about).transpose();
  Vec3 of_angles = by_angle;
  // A tool that is round has no torque about its axis.
  if (num_angles() == 2) {
    power.row(2) = orientation_at(theta) * axis;
    of_angles[2] = 0;
  }
  return power.inverse() * of_angles;
}

std::vector<double> Turning::numbers() const {
  std::vector<double> all(axis.begin(), axis.end());
  all.insert(all.end(), point.begin(), point.end());
  all.insert(all.end(), {orientation.w(), orientation.x(), orientation.y(), orientation.z()});
  all.insert(all.end(), {lever, farthest});
  all.insert(all.end(), angles.begin(), angles.end());
  return all;
}

Turning Turning::from(const std::vector<double>& numbers) {
  Turning turning;
  if (numbers.size() == kCount) {
    const double* next = numbers.data();
    turning.axis = Eigen::Map<const Vec3>(next);
    turning.point = Eigen::Map<const Vec3>(next + 3);
    turning.orientation = {next[6], next[7], next[8], next[9]};
    turning.lever = next[10];
    turning.farthest = next[11];
    turning.angles = Eigen::Map<const Vec3>(next + 12);
  }
  const bool are_finite = std::all_of(numbers.begin(), numbers.end(),
                                      [](double number) { return std::isfinite(number); });
  const bool is_round = turning.num_angles() == 2;
  if (numbers.size() != kCount || !are_finite ||
      (is_round && (std::abs(turning.axis.norm() - 1) > kOfUnitLength || turning.angles[2] != 0)) ||
      std::abs(turning.orientation.norm() - 1) > kOfUnitLength || !(turning.lever > 0) ||
      !(turning.farthest > 0 && turning.farthest < M_PI) || turning.angles.norm() >= M_PI) {
    throw InputError("The motion of a tool that is turned has " + std::to_string(numbers.size()) +
                     " numbers, which are not those of one: " + std::to_string(kCount) +
                     " finite ones, with an axis and a quaternion of unit length, a positive lever "
                     "and angles below 180 degrees. The file was damaged.");
  }
  return turning;
}

TurnGrid grid_of_turns(const Turning& turning, double spacing) {
  const int n = turning.num_angles();
  const int reach =
      std::max(1, static_cast<int>(std::ceil(turning.farthest / spacing - kRounding)));
  const double step = turning.farthest / reach;
  TurnGrid grid{{}, step};
  const auto take = [&](const std::array<int, 3>& at) {
    // The nearest place of the cells around.
    Vec3 nearest = Vec3::Zero();
    for (int i = 0; i < n; ++i) nearest[i] = std::max(std::abs(at[i]) - 1, 0) * step;
    if (nearest.norm() > turning.farthest * (1 - kRounding)) return;
    grid.turns.push_back(turning);
    for (int i = 0; i < n; ++i) grid.turns.back().angles[i] = at[i] * step;
  };
  const int last = n == 3 ? reach : 0;
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      for (int k = -last; k <= last; ++k) take({i, j, k});
    }
  }
  return grid;
}

std::string description(const Turning& turning) {
  std::string here;
  for (int i = 0; i < turning.num_angles(); ++i) {
    here += (i == 0 ? ", here by " : " and ") + quantity(turning.angles[i] * 180 / M_PI, "degrees");
  }
  return std::string(turning.num_angles() == 2 ? "turned across its axis" : "turned") +
         ", by at most " + quantity(turning.farthest * 180 / M_PI, "degrees") + here;
}

PoseMapPtr turned_pose(const Turning& turning) {
  return std::make_shared<const TurnedPose>(turning);
}

}  // namespace palpate
