// SPDX-License-Identifier: BSD-3-Clause
// An elastic half-space z < 0 that is touched in a circle of radius a around the z axis. It is a
// cylinder that is fixed far away, at its bottom and its side, or a part of one between two planes
// through the axis that are planes of symmetry. Its material is linear, and the mesh of Tet10.
//
// A rigid flat disc of radius a displaces it, with G = E/(2(1 + ν)) and E* = E/(1 − ν²), with the
// stiffness
//
//   2 E* a                               into it, without friction
//   4 G a ln(3 − 4ν)/(1 − 2ν)            into it, bonded (Spence 1968)
//   8 G a/(2 − ν)                        along it, bonded (Mindlin 1949)
//
// and a sphere that touches it in the same circle has the first of these against further pressing.
// The last neglects that a surface that is sheared wants to rise on one side and to sink on the
// other, from which the disc keeps it: it is exact at ν = 1/2 (Johnson, Contact Mechanics, 1985,
// §7.2). The others are exact.
#pragma once

#include <vector>

#include "assembly/scene.h"
#include "interaction/interaction.h"

namespace palpate::test {

inline constexpr double kYoungsModulus = 5000;
/// a, m.
inline constexpr double kContactRadius = 0.01;

struct DiscStiffness {
  /// Of the half-space, N/m, as above.
  double frictionless = 0;
  double bonded = 0;
  double along = 0;
};
[[nodiscard]] DiscStiffness disc_stiffness(double poissons_ratio);

struct HalfSpaceOptions {
  /// The number of edges of the mesh along a. They are even to 1.5 a aside and to a below; what is
  /// further is coarser.
  int edges = 3;
  /// Height and radius of the body over a.
  double extent = 256;
  /// The number of sectors around the axis, and how many of them the body has, which are no more
  /// than half of them; the others are mirror images.
  int sectors = 16;
  int own_sectors = 1;
};

/// All of the surface that is not fixed is touchable; its point on the axis is (0, 0, 0).
[[nodiscard]] Scene make_half_space(const HalfSpaceOptions& options, double poissons_ratio);

/// Holds the points of the two planes of symmetry in these planes, Φ = ½ Σ c (n·u)².
class SymmetryPlanes final : public Interaction {
 public:
  SymmetryPlanes(const TetMesh& mesh, const HalfSpaceOptions& options);

  [[nodiscard]] std::unique_ptr<Interaction> clone() const override;
  [[nodiscard]] Index num_coordinates() const override { return 0; }
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& /*q*/) const override { return 0; }
  [[nodiscard]] std::string describe(const Eigen::VectorXd& q) const override;
  [[nodiscard]] bool has_potential() const override { return true; }
  [[nodiscard]] double potential(const Eigen::VectorXd& q, const NodalVector& state,
                                 NodalVector& force, Eigen::VectorXd& of_q) const override;
  void add_hessian(const Eigen::VectorXd& q, const NodalVector& state,
                   PotentialHessian& hessian) const override;

 private:
  struct Held {
    Index point;
    Vec3 normal;
    double stiffness;
  };
  std::vector<Held> held_;
};

}  // namespace palpate::test
