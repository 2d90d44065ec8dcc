// SPDX-License-Identifier: BSD-3-Clause
// Places of the touchable surface of a body at rest, at random and beside each other: where a rigid
// tool is tested.
#pragma once

#include <array>
#include <vector>

#include "accuracy/test_random.h"
#include "assembly/scene.h"
#include "mesh/surface_tree.h"

namespace palpate {

/// Holds all it needs: the scene may go.
class SurfacePlaces {
 public:
  /// @throws InputError no face of the surface is touchable.
  explicit SurfacePlaces(const Scene& scene);

  struct Place {
    /// Of the surface, m.
    Vec3 point = Vec3::Zero();
    /// There, outward, of unit length.
    Vec3 normal = Vec3::UnitZ();
  };

  /// One of the places of the touchable faces, all alike by area.
  [[nodiscard]] Place any(TestRandom& random) const;

  /// The place of the surface, touchable or not, that is nearest to where a way along the tangent
  /// plane of another one leads.
  /// @param way m; what it has along the normal is left out.
  [[nodiscard]] Place beside(const Place& from, const Vec3& way) const;

 private:
  std::vector<std::array<Vec3, 3>> touchable_;
  /// Twice the area of these faces up to each of them, itself included, m².
  std::vector<double> areas_;
  SurfaceTree tree_;
};

}  // namespace palpate
