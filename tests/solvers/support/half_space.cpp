// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/half_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "solvers/support/bodies.h"

namespace palpate::test {
namespace {

/// Away from the tool an edge is longer than the one before by this, which costs 0.04 % of the
/// force.
constexpr double kGrowth = M_SQRT2;
/// The springs that hold points in the planes of symmetry are stiffer than the body by this.
constexpr double kStiffer = 1e5;

/// Shares from 0 to 1: `even` edges of one length, then edges that grow.
std::vector<double> planes(int even, double edge) {
  std::vector<double> at{0};
  for (int i = 1; i <= even; ++i) at.push_back(i * edge);
  double next = kGrowth * edge;
  for (; at.back() + 1.5 * next < 1; next *= kGrowth) at.push_back(at.back() + next);
  at.push_back(1);
  return at;
}

/// Sectors of a cylinder around z, as high as it is wide, under the plane z = 0.
TetMesh make_sectors(const std::vector<double>& radii, const std::vector<double>& depths,
                     int sectors, double angle, double size) {
  std::vector<double> angles;
  for (int i = 0; i <= sectors; ++i) angles.push_back(static_cast<double>(i) / sectors);
  const TetMesh box =
      make_graded_box(ElementOrder::linear, {radii, angles, depths}, {size, angle, size});
  TetMesh body;
  std::vector<Index> point_of;
  for (const Vec3& p : box.points) {
    if (p.x() == 0 && p.y() > 0) {
      // This side of the box closes to the axis.
      point_of.push_back(point_of[point_of.size() - radii.size()]);
    } else {
      point_of.push_back(body.num_points());
      body.points.push_back(Vec3(p.x() * std::cos(p.y()), p.x() * std::sin(p.y()), -p.z()));
    }
  }
  for (Index c = 0; c < box.num_cells(); ++c) {
    std::array<Index, 4> corners{};
    std::transform(box.cell(c), box.cell(c) + 4, corners.begin(),
                   [&](Index p) { return point_of[static_cast<std::size_t>(p)]; });
    std::array<Index, 4> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) continue;
    body.cells.insert(body.cells.end(), corners.begin(), corners.end());
  }
  check_and_orient(body);
  return with_midside_nodes(body);
}

double angle_of(const HalfSpaceOptions& options) {
  return 2 * M_PI * options.own_sectors / options.sectors;
}

}  // namespace

DiscStiffness disc_stiffness(double poissons_ratio) {
  const double nu = poissons_ratio;
  const double shear = kYoungsModulus / (2 * (1 + nu));
  return {4 * shear * kContactRadius / (1 - nu),
          4 * shear * kContactRadius * std::log(3 - 4 * nu) / (1 - 2 * nu),
          8 * shear * kContactRadius / (2 - nu)};
}

Scene make_half_space(const HalfSpaceOptions& options, double poissons_ratio) {
  Scene scene;
  const double size = options.extent * kContactRadius;
  const double edge = 1 / (options.edges * options.extent);
  scene.body.mesh =
      make_sectors(planes(options.edges + (options.edges + 1) / 2, edge),
                   planes(options.edges, edge), options.own_sectors, angle_of(options), size);
  scene.organ.materials = {make_isotropic(Law::linear, kYoungsModulus, poissons_ratio)};
  // Edges of the side cut the circle's corners.
  const double side = 0.999 * size * std::cos(M_PI / options.sectors);
  for (const Vec3& x : scene.body.mesh.points) {
    scene.body.fixed.push_back(x.z() < -0.999 * size || x.head<2>().norm() > side ? 1 : 0);
    scene.body.touchable.push_back(1 - scene.body.fixed.back());
  }
  return scene;
}

SymmetryPlanes::SymmetryPlanes(const TetMesh& mesh, const HalfSpaceOptions& options) {
  std::vector<double> edges(mesh.points.size(), std::numeric_limits<double>::infinity());
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    const double edge = (mesh.points[cell[1]] - mesh.points[cell[0]]).norm();
    for (int a = 0; a < 10; ++a) edges[cell[a]] = std::min(edges[cell[a]], edge);
  }
  const double angle = angle_of(options);
  for (const Vec3& normal : {Vec3(0, 1, 0), Vec3(-std::sin(angle), std::cos(angle), 0)}) {
    for (Index p = 0; p < mesh.num_points(); ++p) {
      const Vec3& x = mesh.points[p];
      if (std::abs(normal.dot(x)) > 1e-9 * x.norm()) continue;
      held_.push_back({p, normal, kStiffer * kYoungsModulus * edges[p]});
    }
  }
}

std::unique_ptr<Interaction> SymmetryPlanes::clone() const {
  return std::make_unique<SymmetryPlanes>(*this);
}

std::string SymmetryPlanes::describe(const Eigen::VectorXd& /*q*/) const {
  return "planes of symmetry";
}

double SymmetryPlanes::potential(const Eigen::VectorXd& /*q*/, const NodalVector& state,
                                 NodalVector& force, Eigen::VectorXd& /*of_q*/) const {
  double sum = 0;
  for (const Held& held : held_) {
    const Eigen::Index first = 3 * Eigen::Index{held.point};
    const double across = held.normal.dot(state.segment<3>(first));
    sum += held.stiffness / 2 * across * across;
    force.segment<3>(first) += held.stiffness * across * held.normal;
  }
  return sum;
}

void SymmetryPlanes::add_hessian(const Eigen::VectorXd& /*q*/, const NodalVector& /*state*/,
                                 PotentialHessian& hessian) const {
  for (const Held& held : held_) {
    hessian.of_points.push_back(
        {held.point, held.point, held.stiffness * held.normal * held.normal.transpose()});
  }
}

}  // namespace palpate::test
