// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/explanation.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <vector>

namespace palpate {
namespace {

/// Held points whose spread across their line is below this share of that along it lie on a line.
constexpr double kLine = 1e-6;

std::string describe(const Vec3& p) {
  std::ostringstream text;
  text << '(' << p.x() << ", " << p.y() << ", " << p.z() << ") m";
  return text.str();
}

Vec3 centre(const TetMesh& mesh, Index cell) {
  Vec3 sum = Vec3::Zero();
  for (int a = 0; a < 4; ++a) sum += mesh.points[mesh.cell(cell)[a]];
  return sum / 4;
}

/// The connected piece of each point, by its lowest point; points without a cell are alone.
std::vector<Index> find_pieces(const TetMesh& mesh) {
  std::vector<Index> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 1; a < nodes_per_cell(mesh.order); ++a) {
      const Index one = root(mesh.cell(c)[0]);
      const Index other = root(mesh.cell(c)[a]);
      parent[std::max(one, other)] = std::min(one, other);
    }
  }
  for (Index p = 0; p < mesh.num_points(); ++p) parent[p] = root(p);
  return parent;
}

/// Dimension of what the points span: −1 none, 0 a point, 1 a line, 2 more.
int dimension(const std::vector<Vec3>& points) {
  if (points.empty()) return -1;
  Eigen::MatrixXd offsets(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) offsets.col(i) = points[i] - points[0];
  const Eigen::Vector3d spread =
      Eigen::JacobiSVD<Eigen::MatrixXd>(offsets * offsets.transpose()).singularValues().cwiseSqrt();
  if (spread[0] == 0) return 0;
  return spread[1] <= kLine * spread[0] ? 1 : 2;
}

}  // namespace

std::string describe_cell(const TetMesh& mesh, Index cell) {
  return "cell " + std::to_string(cell) + " at " + describe(centre(mesh, cell));
}

std::string explain_singular(const CondensedSystem& system) {
  const TetMesh& mesh = system.mesh();
  const std::vector<Index> piece_of = find_pieces(mesh);
  std::vector<char> held = system.fixed();
  for (const PrescribedPoint& p : system.prescribed_points()) held[p.point] = 1;
  const std::vector<char> used = points_in_use(mesh);
  for (Index piece = 0; piece < mesh.num_points(); ++piece) {
    if (piece_of[piece] != piece || used[piece] == 0) continue;
    std::vector<Vec3> of_piece;
    for (Index p = 0; p < mesh.num_points(); ++p) {
      if (piece_of[p] == piece && held[p] != 0) of_piece.push_back(mesh.points[p]);
    }
    const int spanned = dimension(of_piece);
    if (spanned == 2) continue;
    std::ostringstream text;
    text << "The tangent of the body at rest is singular: the piece with point " << piece << " at "
         << describe(mesh.points[piece]) << " is not held";
    if (spanned == 0) text << " but at one point, about which it turns";
    if (spanned == 1) text << " but along one line, about which it turns";
    text << ". Fix three points of every connected piece that are not on a line.";
    return text.str();
  }
  if (system.is_iterative()) {
    return "Conjugate gradients do not solve for the tangent of the body at rest: it is much "
           "thinner "
           "than long, its cells are very flat, or its stiffnesses differ by very much. Choose the "
           "linear solver MUMPS, or refine the mesh.";
  }
  return "The tangent of the body at rest is singular, though every piece of it is held: the body "
         "is incompressible and its mesh too coarse near points that are held, or its stiffnesses "
         "differ by more than can be computed with. Refine the mesh or use a law with a bulk "
         "modulus.";
}

std::string explain(const CondensedSystem& system, const Equilibrium& state,
                    const Eigen::VectorXd& target, double way) {
  const auto worst_cell = [&] { return describe_cell(system.mesh(), state.minimum_det_f_cell); };
  std::ostringstream text;
  if (state.outcome != Outcome::converged) {
    text << "Stopped at " << std::lround(100 * way) << " % of the way to "
         << system.interaction().describe(target) << " (" << to_string(state.outcome) << ", "
         << state.iterations << " iterations in " << state.steps << " steps). ";
  }
  if (state.outcome == Outcome::tool_inside) {
    text << "Beyond that the tool goes through the surface of the body, whose cells are too large "
            "for it or are pressed too far. Make the edges of the mesh under the tool at most as "
            "long as its radius, take a larger tool, or press less deep, and not where the surface "
            "is fixed: it is not felt there. ";
    return text.str().substr(0, text.str().size() - 1);
  }
  for (const Fold& fold : state.folds) {
    text << "The path folds at " << 100 * fold.way << " % of the way: from a force of "
         << fold.reaction.norm() << " N and an energy of " << fold.energy << " J ";
    if (fold.lands) {
      text << "the body jumps to " << fold.landing_reaction.norm() << " N and "
           << fold.landing_energy << " J. ";
    } else {
      text << "it turns back. ";
    }
  }
  if ((state.flags & flags::inverted) != 0) {
    text << state.num_inverted_cells
         << (state.num_inverted_cells == 1 ? " cell is inverted: "
                                           : " cells are inverted, the worst is ")
         << worst_cell() << " with det F = " << state.minimum_det_f
         << ". Displace less, give the tool a radius or refine the mesh there. ";
  } else if (state.outcome != Outcome::converged && state.outcome != Outcome::aborted && way > 0) {
    text << "The least det F is " << state.minimum_det_f << " in " << worst_cell()
         << ". Displace less, give the tool a radius or refine the mesh there. ";
  }
  if ((state.flags & flags::unstable) != 0) {
    text << "The equilibrium is not stable (" << state.negative_pivots << " negative pivots). ";
  }
  if ((state.flags & flags::inertia_not_computed) != 0 && !std::isnan(state.lowest_eigenvalue)) {
    text << "Whether the equilibrium is stable was not found out without a factor. ";
  }
  if ((state.flags & flags::inaccurate) != 0) {
    text << "Rounding leaves the displacement with an error of " << state.displacement_error
         << " of its size. ";
  }
  std::string message = text.str();
  if (!message.empty()) message.pop_back();
  return message;
}

}  // namespace palpate
