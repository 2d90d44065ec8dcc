// SPDX-License-Identifier: BSD-3-Clause
// Divides an organ into regions, and makes a mesh for each that is fine where it is touched there:
// the right mesh for each touch. The meshes are nested in the one that is given. So they have one
// surface at rest, its points keep their numbers, and supports, loads and tissues go over.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "discretisation/mesh_adaptation.h"
#include "exploration/exploration_session.h"
#include "exploration/precompute_options.h"
#include "schedule/communicator.h"

namespace palpate {

struct RegionOptions {
  /// The largest error of a force that the mesh may cause, as a share of it. The force of a rigid
  /// tool is corrected by its estimated error if that is estimated; then it is what is left.
  double tolerance = 0.02;
  /// Of a rigid tool: the largest distance of a place of the surface from the centre of its region,
  /// m; 0: 2.5 half-widths of the tool.
  double size = 0;
  /// Each mesh gets no more cells than this.
  Index max_cells = 20000;
};

struct RegionMesh {
  MeshRegion region;
  Index num_cells = 0;
  Index num_touches = 0;
  /// The largest error that the estimates allow at a touch of which it is known, as a share of the
  /// force; NaN: the mesh was in the file.
  double error = 0;
  /// Whether it is known at all touches.
  bool is_known = true;
  AdaptationEnd end = AdaptationEnd::reached;
  bool was_in_file = false;
};

struct DividedOrgan {
  /// The body whose surface is shown, then one for each region of the rigid tool and for each
  /// active node.
  std::vector<BodyOfRun> bodies;
  /// Of the bodies after the first.
  std::vector<RegionMesh> meshes;
};

/// Is told how many of the meshes are made; returns false to end the work.
using DivisionProgress = std::function<bool(std::size_t num_made, std::size_t num_meshes)>;

/// @param options The tool, the active nodes, the depth and the file of the space. Meshes that the
///   file has are taken from there.
/// @param progress Called on each rank.
/// @throws InputError there is nothing to press or no depth is given; an option is not valid; the
///   work was ended; as the solver.
/// @note Collective
[[nodiscard]] DividedOrgan divide_organ(const std::shared_ptr<const Scene>& scene,
                                        const PrecomputeOptions& options,
                                        const RegionOptions& regions, Communicator& communicator,
                                        const DivisionProgress& progress);

}  // namespace palpate
