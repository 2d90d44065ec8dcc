// SPDX-License-Identifier: BSD-3-Clause
// The surface of a space that is shown and touched: that of the first body at rest. Another body
// carries it: each of its points moves with the place of that body's surface to which it is nearest
// at rest.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <vector>

#include "state_space/space_body.h"
#include "state_space/surface.h"

namespace palpate {

class ShownSurface {
 public:
  /// @param bodies In the order of their numbers, one at least. They must outlive this object.
  explicit ShownSurface(const std::vector<SpaceBody>& bodies) : bodies_(bodies) {}
  explicit ShownSurface(std::vector<SpaceBody>&&) = delete;

  [[nodiscard]] const std::vector<SpaceBody>& bodies() const { return bodies_; }
  [[nodiscard]] const Surface& surface() const { return surface_of(kFirstBody); }
  /// The surface of a body at rest. It is made when it is first asked for.
  [[nodiscard]] const Surface& surface_of(BodyId body) const;

  /// Displacements of the points of a body's surface as displacements of the points that are shown,
  /// or other values at them.
  /// @param of_body [components × points of the body's surface, any number of fields]. There may be
  ///   more rows below, which are left out.
  [[nodiscard]] Eigen::MatrixXf carry(BodyId body, const Eigen::MatrixXf& of_body,
                                      Eigen::Index components = 3) const;

 private:
  /// The points of a body's surface that carry a point, and their weights, which add up to 1.
  struct Carrier {
    std::array<Index, 3> points{};
    Vec3 weights = Vec3::Zero();
  };

  /// The carriers of all points that are shown, which are made when they are first needed.
  [[nodiscard]] const std::vector<Carrier>& carriers_of(BodyId body) const;

  const std::vector<SpaceBody>& bodies_;
  mutable std::map<BodyId, Surface> surfaces_;
  mutable std::map<BodyId, std::vector<Carrier>> carriers_;
};

}  // namespace palpate
