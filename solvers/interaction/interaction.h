// SPDX-License-Identifier: BSD-3-Clause
// How a tool acts on a body. The tool has coordinates q ∈ ℝᵈ, and the body with it the energy
//
//   Π(x; q) = Σ terms(x) + Φ(x; q)   with u = q at the points that the tool prescribes
//
// A tool may prescribe points, or have a potential Φ, or both. Everything that an equilibrium is
// computed for follows from it. With i the unknowns that are left free,
//
//   h = dΠ/dq = ∂Π/∂q                        the force that holds the tool
//   v = dx/dq,  K_ii v_i = −∂²Π/∂x_i∂q       the sensitivity
//   k = d²Π/dq² = ∂²Π/∂q² + (∂²Π/∂q∂x_i) v_i  the stiffness that is felt
//
// where ∂/∂q includes ∂/∂u at the points that the tool prescribes.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "assembly/point_pair.h"
#include "base/types.h"
#include "interaction/pose_map.h"

namespace palpate {

/// A point that moves as the tool does: its displacement is three of the coordinates.
struct PrescribedPoint {
  Index point = 0;
  /// The first of the three.
  Index coordinate = 0;
};

/// The second derivatives of a potential.
struct PotentialHessian {
  /// ∂²Φ/∂u_a∂u_b of two points a and b of one cell or of one of Interaction::couplings(), N/m.
  struct OfPoints {
    Index a = 0;
    Index b = 0;
    Mat3 value = Mat3::Zero();
  };
  /// ∂²Φ/∂u_a∂q of a point a and coordinates of a tool, one after another.
  struct Mixed {
    Index a = 0;
    /// The first of these coordinates.
    Index coordinate = 0;
    /// The derivatives [3 × number of these coordinates], N/m where the coordinates are lengths.
    PoseColumns value;
  };
  /// Each pair of points occurs in one order only. Blocks that occur several times are added up.
  std::vector<OfPoints> of_points;
  std::vector<Mixed> mixed;
  /// ∂²Φ/∂q² [d × d], N/m where the coordinates are lengths.
  Eigen::MatrixXd of_coordinates;
};

/// The part of the body's surface that a tool presses.
struct PressedSurface {
  struct Face {
    /// The corners, points of the mesh.
    std::array<Index, 3> corners{};
    /// The longest edge between them, m.
    double longest_edge = 0;
  };
  /// The faces on which there is pressure.
  std::vector<Face> faces;
  /// The area at rest on which there is pressure, m².
  double area = 0;

  /// The radius of a circle of that area, m.
  [[nodiscard]] double radius() const { return std::sqrt(area / M_PI); }
};

class Interaction {
 public:
  virtual ~Interaction() = default;

  [[nodiscard]] virtual std::unique_ptr<Interaction> clone() const = 0;

  /// d, at least 1.
  [[nodiscard]] virtual Index num_coordinates() const = 0;
  /// The coordinates of a tool that has a place, at that place [3], m: as it is turned there when
  /// nobody says how.
  [[nodiscard]] virtual Eigen::VectorXd coordinates(const Vec3& place) const { return place; }
  /// The points of the body that the tool prescribes, no point twice.
  [[nodiscard]] virtual std::vector<PrescribedPoint> prescribed_points() const { return {}; }
  /// The scale of the body's displacements when the tool is at q, m: errors are judged against it.
  [[nodiscard]] virtual double displacement_scale(const Eigen::VectorXd& q) const = 0;
  /// How far the tool, and a point of the body beside it, may move in one step of a solve, m.
  [[nodiscard]] virtual double longest_step() const {
    return std::numeric_limits<double>::infinity();
  }
  /// Where the tool is, for a message: "a displacement of 0.01 m".
  [[nodiscard]] virtual std::string describe(const Eigen::VectorXd& q) const = 0;

  /// Places in the tool, m, that the body's surface cannot reach while the tool's surface presses
  /// it. If the body is at one of them, the tool has gone through its surface.
  [[nodiscard]] virtual std::vector<Vec3> inner_places(const Eigen::VectorXd& /*q*/) const {
    return {};
  }

  /// What the tool presses; nothing where it has no pressure, as one that is bonded.
  [[nodiscard]] virtual PressedSurface pressed_surface(const Eigen::VectorXd& /*q*/,
                                                       const NodalVector& /*state*/) const {
    return {};
  }

  /// Whether there is a Φ. Without one, the functions below add nothing.
  [[nodiscard]] virtual bool has_potential() const { return false; }
  /// Returns Φ, J, and adds ∂Φ/∂u, N, to the components of `force` and ∂Φ/∂q, N, to `of_q` [d].
  /// @param state The displacement of every point, and maybe more.
  [[nodiscard]] virtual double potential(const Eigen::VectorXd& /*q*/, const NodalVector& /*state*/,
                                         NodalVector& /*force*/, Eigen::VectorXd& /*of_q*/) const {
    return 0;
  }
  /// The pairs of points that ∂²Φ/∂u² may couple besides those of one cell.
  [[nodiscard]] virtual std::vector<PointPair> couplings() const { return {}; }
  /// Adds the second derivatives.
  virtual void add_hessian(const Eigen::VectorXd& /*q*/, const NodalVector& /*state*/,
                           PotentialHessian& /*hessian*/) const {}

 protected:
  Interaction() = default;
  Interaction(const Interaction&) = default;
  Interaction& operator=(const Interaction&) = default;
};

}  // namespace palpate
