// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/explanation.h"

#include <cmath>
#include <sstream>
#include <vector>

#include "assembly/piece_support.h"
#include "base/quantity.h"
#include "interaction/held_points.h"

namespace palpate {
namespace {

Vec3 centre(const TetMesh& mesh, Index cell) {
  Vec3 sum = Vec3::Zero();
  for (int a = 0; a < 4; ++a) sum += mesh.points[mesh.cell(cell)[a]];
  return sum / 4;
}

}  // namespace

std::string advise_finer_quadrature(const Assembly& assembly) {
  if (!assembly.takes_finer_quadrature()) return "";
  return ", or choose the Quadrature Fine of Assign Material";
}

std::string describe_cell(const TetMesh& mesh, Index cell) {
  return "cell " + std::to_string(cell) + " at " + quantity(centre(mesh, cell), "m");
}

std::string explain_singular(const CondensedSystem& system) {
  const TetMesh& mesh = system.mesh();
  std::vector<char> held = system.holding_points();
  const std::vector<Index> held_by_tools = held_points(system.interaction());
  if (auto piece = PieceSupport(mesh, held).find_mobile_piece(held_by_tools)) return *piece;
  for (const Index point : held_by_tools) held[point] = 1;
  if (auto part = find_mobile_part(mesh, held)) return *part;
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
         << state.summary.iterations << " iterations in " << state.summary.steps << " steps). ";
  }
  if (state.outcome == Outcome::tool_inside) {
    text << "Beyond that the tool goes through the surface of the body, whose cells are too large "
            "for it or are pressed too far. Make the edges of the mesh under the tool at most as "
            "long as its radius, take a larger tool, or press less deep, and not where the surface "
            "is fixed: it is not felt there. ";
    return text.str().substr(0, text.str().size() - 1);
  }
  for (const Fold& fold : state.summary.folds) {
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
         << ". Displace less, give the tool a radius or refine the mesh there"
         << advise_finer_quadrature(system.assembly()) << ". ";
  } else if (state.outcome != Outcome::converged && state.outcome != Outcome::aborted && way > 0) {
    text << "The least det F is " << state.minimum_det_f << " in " << worst_cell()
         << ". Displace less, give the tool a radius or refine the mesh there"
         << advise_finer_quadrature(system.assembly()) << ". ";
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
