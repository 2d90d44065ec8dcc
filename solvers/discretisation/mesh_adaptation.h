// SPDX-License-Identifier: BSD-3-Clause
// A mesh that is fine where touches need it: the touches are solved for, the cells with most of the
// error of the mesh are divided, and this is repeated until the force of each touch is as exact as
// is asked for (Dörfler, A convergent adaptive algorithm for Poisson's equation, SIAM J. Numer.
// Anal. 33, 1996, chooses the cells in the same way).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "mesh/refinement.h"

namespace palpate {

/// What one touch says of a mesh.
struct TouchOnMesh {
  /// The force of the tool and by how much it is too large, estimated [d], N; empty where the touch
  /// has no equilibrium.
  Eigen::VectorXd force;
  Eigen::VectorXd error;
  /// Whether there is an equilibrium and its error is small, so that it tells when the mesh is fine
  /// enough.
  bool is_known = true;
  /// Whether the estimate may be trusted, see MeshErrorEstimate.
  bool is_reliable = true;
  /// See MeshErrorEstimate [num_cells], J. Values that are not finite or not positive are not read.
  std::vector<double> energy_of_cells;
  /// The cells under the tool that are so large that energy_of_cells does not see all of their
  /// error: they are divided in any case.
  std::vector<Index> coarse_cells;
};

struct AdaptationOptions {
  /// The largest error of the force of a touch, as a share of it, above 0.
  double tolerance = 0.05;
  /// Whether the force will be corrected by its estimated error, so that the tolerance is for what
  /// is left.
  bool is_corrected = false;
  /// Whether touches are solved for again, on each finer mesh, that need no finer one. Otherwise
  /// they keep what was found for them, which is no better than it is on a finer mesh.
  bool touches_again = true;
  /// The mesh gets no more cells than this, at least 1.
  Index max_cells = 20000;
};

struct AdaptationRound {
  Index num_cells = 0;
  /// The force of each touch and the same less its estimated error [d], N; empty where the touch
  /// has no equilibrium.
  std::vector<Eigen::VectorXd> forces;
  std::vector<Eigen::VectorXd> corrected_forces;
  /// The estimated error of each touch as a share of its force; NaN where it has no equilibrium.
  std::vector<double> errors;
  /// By how much the force less its error differs from that on the mesh before, as a share; NaN for
  /// the first mesh, and where one of both is not known.
  std::vector<double> changes;
  /// TouchOnMesh::is_known and is_reliable of each touch.
  std::vector<char> is_known;
  std::vector<char> is_reliable;
  /// Whether a touch has cells that are divided in any case.
  std::vector<char> is_coarse;
  /// Whether a touch is given up, since its error was not known on several meshes, one after the
  /// other: where it was known on a coarser one, on two.
  std::vector<char> is_given_up;
};

/// The largest error of the force of a touch that its estimate allows, as a share of the force: see
/// kMostOfEstimate and the like. NaN where it has no equilibrium.
/// @param is_corrected See AdaptationOptions.
[[nodiscard]] double largest_error(const AdaptationRound& round, std::size_t touch,
                                   bool is_corrected);

enum class AdaptationEnd : int {
  /// The error of all touches is within the tolerance.
  reached = 0,
  /// A finer mesh would have too many cells.
  too_many_cells = 1,
  /// The caller wished to stop.
  stopped = 2,
  /// The mesh is as fine as the other touches need it, but the error of some touch is not known, or
  /// no touch that needs a finer mesh says where.
  not_known = 3,
};

struct AdaptedMesh {
  Scene scene;
  /// The cells that were chosen on each mesh, see refine().
  std::vector<std::vector<char>> chosen;
  /// From the mesh of the scene at the start to that of the scene above, one after the other.
  std::vector<Refinement> refinements;
  /// The last one tells of the mesh of the scene above.
  std::vector<AdaptationRound> rounds;
  /// Finer meshes that were left, since on them the error of some touch is not known that is known
  /// on the mesh above.
  std::vector<AdaptationRound> left;
  AdaptationEnd end = AdaptationEnd::reached;
};

/// What a function that solves for touches may use besides the scene.
struct MeshHints {
  /// Which of the touches are needed [number of touches]; empty: all. The others may be left as
  /// they are constructed.
  std::vector<char> needed;
  /// How the mesh has come from the one before, on which equilibria are known; null: it is the
  /// first.
  const Refinement* refinement = nullptr;
};

/// Solves for touches on the mesh of a scene.
/// @returns One entry for each touch; nothing to stop.
using TouchMesh = std::function<std::vector<TouchOnMesh>(const Scene&, const MeshHints&)>;

/// Refines until the largest error that an estimate allows is within the tolerance, and no cell
/// under the tool is too large for the estimate. The change from the mesh before must be, too: it
/// shows what the estimate does not see, such as the outline of a bonded patch.
/// @param scene A scene that was checked.
/// @throws InputError an option is not valid.
[[nodiscard]] AdaptedMesh adapt_mesh(const Scene& scene, const AdaptationOptions& options,
                                     const TouchMesh& touch);

}  // namespace palpate
