// SPDX-License-Identifier: BSD-3-Clause
// Places on the touchable surface of a body at rest, chosen at random or next to each other, at
// which a rigid tool is tested.
#pragma once

#include <array>
#include <vector>

#include "accuracy/test_random.h"
#include "assembly/body.h"
#include "mesh/surface_tree.h"

namespace palpate {

/// It copies all that it needs, so that the body need not outlive it.
class SurfacePlaces {
 public:
  /// @throws InputError no face of the surface is touchable.
  SurfacePlaces(const Body& body, const SettledBody& at_rest);

  struct Place {
    /// A point of the surface, m.
    Vec3 point = Vec3::Zero();
    /// The outward unit normal there.
    Vec3 normal = Vec3::UnitZ();
  };

  /// A random place on the touchable faces, uniform by area.
  [[nodiscard]] Place any(TestRandom& random) const;

  /// The place of the surface, touchable or not, that is nearest to a point in the tangent plane of
  /// another place.
  /// @param way Vector to that point, m; its component along the normal is ignored.
  [[nodiscard]] Place beside(const Place& from, const Vec3& way) const;

 private:
  std::vector<std::array<Vec3, 3>> touchable_;
  /// Twice the area of these faces up to each of them, itself included, m².
  std::vector<double> areas_;
  SurfaceTree tree_;
};

}  // namespace palpate
