// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_patch.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// Relative tolerance of the radius, so that a point at exactly that distance is included whatever
/// the rounding. A body in mm and the same body in m then have the same patches.
constexpr double kSlack = 1e-12;

}  // namespace

SurfacePatches::SurfacePatches(const TetMesh& mesh)
    : points_(mesh.points),
      nodes_per_face_(nodes_per_face(mesh.order)),
      faces_(boundary_faces(mesh)),
      face_of_point_(faces_.size()),
      first_face_(mesh.points.size() + 1, 0) {
  for (const Index p : faces_) ++first_face_[p + 1];
  for (std::size_t p = 0; p < points_.size(); ++p) first_face_[p + 1] += first_face_[p];
  std::vector<Index> next(first_face_.begin(), first_face_.end() - 1);
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    face_of_point_[next[faces_[i]]++] = static_cast<Index>(i) / nodes_per_face_;
  }
}

bool SurfacePatches::on_surface(Index point) const {
  return point >= 0 && point < static_cast<Index>(points_.size()) &&
         first_face_[point] < first_face_[point + 1];
}

std::vector<Index> SurfacePatches::around(Index node, double radius) const {
  if (!(std::isfinite(radius) && radius >= 0)) {
    throw InputError("The tip radius is " + quantity(radius) +
                     "; it must be a length in m, or 0 for a single point.");
  }
  if (!on_surface(node)) {
    throw InputError("Point " + std::to_string(node) +
                     " is not on the surface of the body. Choose a point that is.");
  }
  if (radius == 0) return {node};
  const double reach = (1 + kSlack) * radius;
  std::set<Index> patch{node};
  for (std::vector<Index> open{node}; !open.empty();) {
    const Index from = open.back();
    open.pop_back();
    for (Index i = first_face_[from]; i < first_face_[from + 1]; ++i) {
      const Index* face = faces_.data() + face_of_point_[i] * nodes_per_face_;
      for (const Index* p = face; p != face + nodes_per_face_; ++p) {
        if ((points_[*p] - points_[node]).norm() <= reach && patch.insert(*p).second) {
          open.push_back(*p);
        }
      }
    }
  }
  return {patch.begin(), patch.end()};
}

}  // namespace palpate
