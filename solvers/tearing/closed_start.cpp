// SPDX-License-Identifier: BSD-3-Clause
#include "tearing/closed_start.h"

#include <array>
#include <map>
#include <numeric>
#include <utility>

#include "tearing/pressed_sides.h"
#include "tearing/side_points.h"

namespace palpate {
namespace {

/// The first of the points in each place where the cut is open [num_points].
std::vector<Index> close_points(const Body& body) {
  const TetMesh& mesh = body.mesh;
  std::vector<Index> closed(mesh.points.size());
  std::iota(closed.begin(), closed.end(), 0);
  // Copies of a point have the same place to the bit.
  std::map<std::array<double, 3>, Index> first;
  std::vector<char> is_on_cut(mesh.points.size(), 0);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int k = 0; k < 4; ++k) {
      if (!is_open(body.cut.faces[c][k], body.cut.stage)) continue;
      for (const Index p : points_of_side(mesh, c, k)) is_on_cut[p] = 1;
    }
  }
  for (Index p = 0; p < mesh.num_points(); ++p) {
    const Vec3& x = mesh.points[p];
    if (is_on_cut[p] != 0) closed[p] = first.try_emplace({x[0], x[1], x[2]}, p).first->second;
  }
  return closed;
}

Scene close(const Scene& scene, const std::vector<Index>& closed_of) {
  Scene closed = scene;
  for (Index& node : closed.body.mesh.cells) node = closed_of[node];
  closed.body.cut = {};
  if (closed.organ.touching == TouchingParts::lips) closed.organ.touching = TouchingParts::none;
  return closed;
}

}  // namespace

bool ClosedStart::helps(const Scene& scene) {
  return scene.body.cut.stage > 0 && scene.organ.touching == TouchingParts::lips &&
         !scene.has_load();
}

ClosedStart::ClosedStart(const Scene& scene, const EquilibriumOptions& options,
                         std::unique_ptr<LinearSolver> linear_solver)
    : scene_(scene),
      closed_of_(close_points(scene.body)),
      closed_(close(scene, closed_of_)),
      solver_(closed_, options, std::move(linear_solver)),
      contact_(make_soft_contact(scene)) {}

void ClosedStart::set_interaction(const Interaction& tool, const Eigen::VectorXd& start) {
  solver_.set_interaction(tool);
  rest_ = solver_.rest(start);
}

std::optional<Equilibrium> ClosedStart::solve(EquilibriumSolver& solver, const Eigen::VectorXd& t) {
  if (rest_->outcome != Outcome::converged) return std::nullopt;
  const Equilibrium closed = solver_.solve(t, *rest_, Tangent::rough);
  if (closed.outcome != Outcome::converged) return std::nullopt;
  Equilibrium near;
  near.t = t;
  near.u.resize(closed.u.size());
  for (Eigen::Index p = 0; p < static_cast<Eigen::Index>(closed_of_.size()); ++p) {
    near.u.segment<3>(3 * p) =
        closed.u.segment<3>(3 * Eigen::Index{closed_of_[static_cast<std::size_t>(p)]});
  }
  near.u = press_sides(scene_, solver.assembly(), *contact_, std::move(near.u));
  Equilibrium found = solver.settle(near);
  if (found.outcome != Outcome::converged || found.negative_pivots > 0) return std::nullopt;
  return found;
}

}  // namespace palpate
