// SPDX-License-Identifier: BSD-3-Clause
// How the coordinates q ∈ ℝᵈ of a rigid tool place and turn it: the point y of the tool, about its
// centre and in its own axes, is at
//
//   x = p(q) + R(q) y,   so that  y = Rᵀ (x − p)  and a direction n is  m = Rᵀ n  in its axes.
//
// The shape of a tool (rigid_shape.h) depends on y and m alone, and the law of contact on the
// distance at y. The force along each coordinate follows from the derivatives of y and m by q.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <memory>

#include "base/types.h"

namespace palpate {

/// The largest number of coordinates of a tool: six describe any rigid motion.
inline constexpr int kMaxPoseCoordinates = 6;
/// A vector for each coordinate [3 × d].
using PoseColumns = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxPoseCoordinates>;

/// Where a tool is, and how it is turned.
struct Pose {
  /// p, m, and R.
  Vec3 place = Vec3::Zero();
  Mat3 rotation = Mat3::Identity();

  /// The place y of a point at x, in the tool's axes, and the other way.
  [[nodiscard]] Vec3 in_tool(const Vec3& x) const { return rotation.transpose() * (x - place); }
  [[nodiscard]] Vec3 in_scene(const Vec3& y) const { return place + rotation * y; }
};

/// A pose and its derivatives.
struct PoseJet {
  /// The number of coordinates d.
  int num_coordinates = 0;
  /// p, m.
  Vec3 place = Vec3::Zero();
  /// R, a rotation.
  Mat3 rotation = Mat3::Identity();
  /// Whether R, or ∂p/∂q, depends on q. If not, all derivatives but ∂p/∂q are zero.
  bool turns = false;
  /// ∂p/∂q_i [d], m per unit of q_i, and ∂R/∂q_i [d].
  std::array<Vec3, kMaxPoseCoordinates> place_by{};
  std::array<Mat3, kMaxPoseCoordinates> rotation_by{};
  /// ∂²p/∂q_i∂q_j and ∂²R/∂q_i∂q_j, in both orders [d × d].
  std::array<std::array<Vec3, kMaxPoseCoordinates>, kMaxPoseCoordinates> place_by_two{};
  std::array<std::array<Mat3, kMaxPoseCoordinates>, kMaxPoseCoordinates> rotation_by_two{};

  /// Everything is zero except R, which is the identity.
  explicit PoseJet(int coordinates);

  /// The place y of a point at x, in the tool's axes.
  [[nodiscard]] Vec3 point(const Vec3& x) const { return rotation.transpose() * (x - place); }
  /// The direction m of a direction n, in the tool's axes.
  [[nodiscard]] Vec3 direction(const Vec3& n) const { return rotation.transpose() * n; }
  /// ∂y/∂q of a point at rest in the scene [3 × d].
  /// @param y The place of the point in the tool's axes.
  [[nodiscard]] PoseColumns point_by(const Vec3& y) const;
  /// ∂m/∂q of a direction n [3 × d].
  [[nodiscard]] PoseColumns direction_by(const Vec3& n) const;
  /// ∂²y/∂q_i∂q_j of a point at rest in the scene [3].
  /// @param y The place of the point in the tool's axes.
  [[nodiscard]] Vec3 point_by_two(const Vec3& y, int i, int j) const;
  /// ∂²m/∂q_i∂q_j of a direction n [3].
  [[nodiscard]] Vec3 direction_by_two(const Vec3& n, int i, int j) const {
    return rotation_by_two[i][j].transpose() * n;
  }
};

/// A map does not change once it is made, and may be evaluated by several threads at once.
class PoseMap {
 public:
  virtual ~PoseMap() = default;

  /// d, 1 … kMaxPoseCoordinates.
  [[nodiscard]] virtual int num_coordinates() const noexcept = 0;
  /// @param q [d].
  /// @param order The order of the highest derivative that is wanted, 0 … 2. Higher derivatives are
  ///   zero.
  [[nodiscard]] virtual PoseJet evaluate(const Eigen::VectorXd& q, int order = 2) const = 0;
  /// The pose alone.
  [[nodiscard]] virtual Pose at(const Eigen::VectorXd& q) const {
    const PoseJet jet = evaluate(q, 0);
    return {jet.place, jet.rotation};
  }
  /// The coordinates of the tool at a place, as it is turned there when nobody says how, m.
  [[nodiscard]] virtual Eigen::VectorXd coordinates(const Vec3& place) const { return place; }
  /// Whether the tool may be at q. Where it may be is convex. Elsewhere a pose need not be right.
  [[nodiscard]] virtual bool allows(const Eigen::VectorXd& /*q*/) const { return true; }
  /// @throws InputError the tool may not be at q. The message says what to do.
  virtual void check(const Eigen::VectorXd& /*q*/) const {}

  /// How far the points of a tool move as its coordinates do.
  struct Stretch {
    /// The way of any point of the tool is at most so many times that of q, m/m,
    double most = 1;
    /// as long as q moves no farther than this, m.
    double within = std::numeric_limits<double>::infinity();
  };
  /// @param bounds The box around the tool, in its own axes, m.
  /// @throws InputError this is not known: the tool turns, or its coordinates are not the place of
  ///   its centre, and the map has no bound of its own.
  [[nodiscard]] virtual Stretch stretch(const Eigen::VectorXd& q,
                                        const Eigen::AlignedBox3d& bounds) const;

 protected:
  PoseMap() = default;
  PoseMap(const PoseMap&) = default;
  PoseMap& operator=(const PoseMap&) = default;
};

/// Several tools, and the threads that solve for them, may share one.
using PoseMapPtr = std::shared_ptr<const PoseMap>;

/// The tool does not turn, and its coordinates are the place of its centre, m.
[[nodiscard]] PoseMapPtr translated_pose();

}  // namespace palpate
