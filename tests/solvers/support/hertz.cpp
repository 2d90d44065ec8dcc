// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/hertz.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction_list.h"
#include "interaction/rigid_capsule.h"
#include "interaction/rigid_contact.h"
#include "solvers/support/bodies.h"

namespace palpate::test {
namespace {

constexpr double kYoungsModulus = 5000;
constexpr double kPoissonsRatio = 0.4;
constexpr double kReducedModulus = kYoungsModulus / (1 - kPoissonsRatio * kPoissonsRatio);
constexpr double kRadius = 1;
/// So small that what Hertz neglects, the motion of the surface along itself, is 0.1 % of the
/// force.
constexpr double kDepth = 1e-4;
/// What the filters take where the user gives none.
constexpr double kContactStiffness = 2 * kYoungsModulus;
/// How deep the tool is pushed in one solve, thicknesses of the layer.
constexpr double kPush = 3;
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

/// A sector of a cylinder around z, as high as it is wide, under the plane z = 0.
TetMesh make_sector(const std::vector<double>& radii, const std::vector<double>& depths,
                    double angle, double size) {
  const TetMesh box =
      make_graded_box(ElementOrder::linear, {radii, {0, 1}, depths}, {size, angle, size});
  TetMesh sector;
  std::vector<Index> point_of;
  for (const Vec3& p : box.points) {
    if (p.x() == 0 && p.y() > 0) {
      // This side of the box closes to the axis.
      point_of.push_back(point_of[point_of.size() - radii.size()]);
    } else {
      point_of.push_back(sector.num_points());
      sector.points.push_back(Vec3(p.x() * std::cos(p.y()), p.x() * std::sin(p.y()), -p.z()));
    }
  }
  for (Index c = 0; c < box.num_cells(); ++c) {
    std::array<Index, 4> corners{};
    std::transform(box.cell(c), box.cell(c) + 4, corners.begin(),
                   [&](Index p) { return point_of[static_cast<std::size_t>(p)]; });
    std::array<Index, 4> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) continue;
    sector.cells.insert(sector.cells.end(), corners.begin(), corners.end());
  }
  check_and_orient(sector);
  return with_midside_nodes(sector);
}

/// Holds the points of planes through the z axis in these planes, Φ = ½ Σ c (n·u)².
class SymmetryPlanes final : public Interaction {
 public:
  /// @param angle From the plane y = 0 to the other one.
  SymmetryPlanes(const TetMesh& mesh, double angle) {
    std::vector<double> edges(mesh.points.size(), std::numeric_limits<double>::infinity());
    for (Index c = 0; c < mesh.num_cells(); ++c) {
      const Index* cell = mesh.cell(c);
      const double edge = (mesh.points[cell[1]] - mesh.points[cell[0]]).norm();
      for (int a = 0; a < 10; ++a) edges[cell[a]] = std::min(edges[cell[a]], edge);
    }
    for (const Vec3& normal : {Vec3(0, 1, 0), Vec3(-std::sin(angle), std::cos(angle), 0)}) {
      for (Index p = 0; p < mesh.num_points(); ++p) {
        const Vec3& x = mesh.points[p];
        if (std::abs(normal.dot(x)) > 1e-9 * x.norm()) continue;
        held_.push_back({p, normal, kStiffer * kYoungsModulus * edges[p]});
      }
    }
  }

  [[nodiscard]] std::unique_ptr<Interaction> clone() const override {
    return std::make_unique<SymmetryPlanes>(*this);
  }
  [[nodiscard]] Index num_coordinates() const override { return 0; }
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& /*q*/) const override { return 0; }
  [[nodiscard]] std::string describe(const Eigen::VectorXd& /*q*/) const override {
    return "planes of symmetry";
  }
  [[nodiscard]] bool has_potential() const override { return true; }
  [[nodiscard]] double potential(const Eigen::VectorXd& /*q*/, const NodalVector& state,
                                 NodalVector& force, Eigen::VectorXd& /*of_q*/) const override {
    double sum = 0;
    for (const Held& held : held_) {
      const Eigen::Index first = 3 * Eigen::Index{held.point};
      const double across = held.normal.dot(state.segment<3>(first));
      sum += held.stiffness / 2 * across * across;
      force.segment<3>(first) += held.stiffness * across * held.normal;
    }
    return sum;
  }
  void add_hessian(const Eigen::VectorXd& /*q*/, const NodalVector& /*state*/,
                   PotentialHessian& hessian) const override {
    for (const Held& held : held_) {
      hessian.of_points.push_back(
          {held.point, held.point, held.stiffness * held.normal * held.normal.transpose()});
    }
  }

 private:
  struct Held {
    Index point;
    Vec3 normal;
    double stiffness;
  };
  std::vector<Held> held_;
};

Scene make_body(const HertzOptions& options, double a) {
  Scene scene;
  const double size = options.extent * a;
  const double edge = 1 / (options.edges * options.extent);
  // Contact ends at r = a.
  scene.mesh = make_sector(planes(options.edges + (options.edges + 1) / 2, edge),
                           planes(options.edges, edge), 2 * M_PI / options.sectors, size);
  scene.materials = {make_isotropic(Law::linear, kYoungsModulus, kPoissonsRatio)};
  // Edges of the side cut the circle's corners.
  const double side = 0.999 * size * std::cos(M_PI / options.sectors);
  for (const Vec3& x : scene.mesh.points) {
    scene.fixed.push_back(x.z() < -0.999 * size || x.head<2>().norm() > side ? 1 : 0);
    scene.touchable.push_back(1 - scene.fixed.back());
  }
  return scene;
}

/// The equilibrium with the tool's centre at this height, where it comes to from above.
Equilibrium push(EquilibriumSolver& solver, double height, double thickness) {
  double now = kRadius + 1.01 * thickness;
  Equilibrium state = solver.rest(Vec3(0, 0, now));
  while (now > height) {
    now = std::max(now - kPush * thickness, height);
    state = solver.solve(Vec3(0, 0, now), state);
    if (state.outcome != Outcome::converged) {
      throw InputError("The sphere at " + std::to_string(now) + " m: " + state.message);
    }
  }
  return state;
}

}  // namespace

HertzResult press_half_space(const HertzOptions& options) {
  const double a = std::sqrt(kRadius * kDepth);
  const double force = 4.0 / 3 * kReducedModulus * a * kDepth;
  const double largest_pressure = 2 * kReducedModulus * a / (M_PI * kRadius);
  const double thickness = options.thickness * kDepth;
  const double larger = thickness * (1 - 0.75 * std::cbrt(largest_pressure / kContactStiffness));

  const Scene scene = make_body(options, a);
  const RigidContact contact(
      std::make_shared<const ContactSurface>(ContactSurface::divided(scene, options.divisions)),
      make_sphere(kRadius), {thickness, kContactStiffness});
  InteractionList tools;
  tools.add(contact);
  tools.add(SymmetryPlanes(scene.mesh, 2 * M_PI / options.sectors));
  EquilibriumOptions solver_options;
  // Rounding in the stiff springs allows no less.
  solver_options.tolerance = 1e-8;
  EquilibriumSolver solver(scene, solver_options);
  solver.set_interaction(tools);
  const Equilibrium state = push(solver, kRadius + larger - kDepth, thickness);

  HertzResult result;
  result.num_unknowns = solver.assembly().pattern().size;
  result.force = -options.sectors * state.reaction[2] / force;
  result.force_from_middle =
      result.force * std::pow(kDepth / (kDepth - larger + thickness / 2), 1.5);
  result.stiffness = options.sectors * state.stiffness(2, 2) / (2 * kReducedModulus * a);

  NodalVector forces = NodalVector::Zero(state.u.size());
  Eigen::VectorXd of_tool = Vec3::Zero();
  (void)contact.potential(state.t, state.u, forces, of_tool);
  double moment = 0;
  double squares = 0;
  int number = 0;
  for (Index p = 0; p < scene.mesh.num_points(); ++p) {
    const Vec3& x = scene.mesh.points[p];
    const Vec3 of_point = forces.segment<3>(3 * Eigen::Index{p});
    if (x.z() < 0) {
      result.force_below += of_point.norm();
      continue;
    }
    // The shape functions have r² without error.
    moment += of_point.z() * x.squaredNorm();
    if (x.norm() > 0.8 * a) continue;
    const Vec3 offset = x + state.u.segment<3>(3 * Eigen::Index{p}) - Vec3(state.t);
    const double share = std::max(1 - contact.shape().evaluate(offset, 0).value / thickness, 0.0);
    const double pressure = kContactStiffness * share * share * share;
    squares += std::pow(pressure / largest_pressure - std::sqrt(1 - x.squaredNorm() / (a * a)), 2);
    ++number;
  }
  result.radius = std::sqrt(2.5 * moment / -of_tool[2]) / a;
  result.pressure_error = std::sqrt(squares / number);
  return result;
}

}  // namespace palpate::test
