// SPDX-License-Identifier: BSD-3-Clause
// An organ may be divided into regions, each with a mesh of its own that is fine where it is
// touched there. A rigid tool is in the region whose centre is nearest to it, and passes smoothly
// from one to the next. An active node may have such a mesh, too.
#pragma once

#include <tuple>

#include "base/types.h"

namespace palpate {

struct MeshRegion {
  /// m; the place of an active node.
  Vec3 centre = Vec3::Zero();
  /// The width of the layer in which this region passes into a neighbour, m; 0 for an active node.
  double band = 0;
  /// The largest distance of a place of the surface from the centre of its region, as it was asked
  /// for, m; 0 for an active node.
  double size = 0;
  /// The largest error of a force that the mesh was to cause, as a share of it.
  double tolerance = 0;
};

/// Calls visit for each number of a region, in the order in which files and ranks have them.
template <class Region, class Visit>
void for_each_number_of_mesh_region(Region& region, Visit&& visit) {
  visit(region.centre);
  visit(region.band);
  visit(region.size);
  visit(region.tolerance);
}

[[nodiscard]] inline bool operator==(const MeshRegion& a, const MeshRegion& b) {
  return a.centre == b.centre &&
         std::tie(a.band, a.size, a.tolerance) == std::tie(b.band, b.size, b.tolerance);
}

}  // namespace palpate
