// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/device/body.h"

#include <array>

#include "solvers/interpolation/analytic_space.h"

namespace palpate::test {
namespace {

constexpr double kSide = 0.04;
constexpr double kHeight = 0.03;

/// Not symmetric in any way that could hide a mistake.
Mat3 stiffness_of(int node) {
  Mat3 k;
  k << 220, 15, -20, 15, 250, 10, -20, 10, 300;
  return (1 + 0.1 * node) * k;
}

Energy energy_of(const Mat3& k) {
  return [k](const Vec3& t) {
    const double square = t.squaredNorm();
    Sample sample;
    sample.energy = 0.5 * t.dot(k * t) + 0.25 * kStiffening * square * square;
    sample.force = k * t + kStiffening * square * t;
    sample.stiffness = k + kStiffening * (square * Mat3::Identity() + 2 * t * t.transpose());
    return sample;
  };
}

Surface block() {
  Surface surface;
  for (double z : {0.0, -kHeight}) {
    for (const auto& [x, y] :
         std::array<std::array<double, 2>, 4>{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}}) {
      surface.points.push_back({x * kSide / 2, y * kSide / 2, z});
      surface.mesh_points.push_back(surface.num_points() - 1);
    }
  }
  surface.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  for (Index i = 0; i < 4; ++i) {
    const Index next = (i + 1) % 4;
    surface.triangles.push_back({i, i + 4, next + 4});
    surface.triangles.push_back({i, next + 4, next});
  }
  return surface;
}

}  // namespace

TouchSpace make_body(Log& log) {
  TouchSpace space;
  space.scene_hash = "block";
  space.surface = block();
  for (int node = 0; node < 4; ++node) {
    const Mat3 k = stiffness_of(node);
    TouchToolSpace tool_space = analytic_space(energy_of(k));
    tool_space.setup.interaction.active_node = node;
    tool_space.setup.interaction.material_point = space.surface.points[node];
    log.add("node %g %g %g %g %g %g %g %g %g", tool_space.setup.interaction.material_point[0],
            tool_space.setup.interaction.material_point[1],
            tool_space.setup.interaction.material_point[2], k(0, 0), k(0, 1), k(0, 2), k(1, 1),
            k(1, 2), k(2, 2));
    space.tool_spaces.push_back(std::move(tool_space));
  }
  log.add("stiffening %g", kStiffening);
  for (int i = 0; i < 2; ++i) {
    const auto& [a, b, c] = space.surface.triangles[i];
    log.add("triangle %d %d %d", a, b, c);
  }
  return space;
}

}  // namespace palpate::test
