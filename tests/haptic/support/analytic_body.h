// SPDX-License-Identifier: BSD-3-Clause
// A box to touch whose active nodes answer by a formula.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "haptic/touching/touchable.h"
#include "solvers/interpolation/analytic_space.h"

namespace palpate::test {

/// Sides of the box, m. It lies between the origin and these; its top, z = kBox[2], is touched.
inline const Vec3 kBox(0.08, 0.08, 0.04);
/// Π = ½ k (t·Dt + |t|⁴/(2 l²)), D = diag(0.7, 0.8, 1), l = kHalfWidth: stiffens, and is no
/// isotropic spring.
inline Energy stiffening_spring(double k) {
  return [k](const Vec3& t) {
    const Mat3 d = Vec3(0.7, 0.8, 1).asDiagonal();
    const double q = t.squaredNorm() / (kHalfWidth * kHalfWidth);
    Sample s;
    s.energy = 0.5 * k * (t.dot(d * t) + 0.5 * q * t.squaredNorm());
    s.force = k * (d * t + q * t);
    s.stiffness =
        k * (d + q * Mat3::Identity() + 2 * t * t.transpose() / (kHalfWidth * kHalfWidth));
    return s;
  };
}

/// The box's surface, two triangles a square, its points welded.
/// @param squares Along a side of each face.
inline Surface box_surface(int squares = 4) {
  Surface surface;
  std::map<std::array<int, 3>, Index> numbers;
  const auto number = [&](const std::array<int, 3>& p) {
    const auto [place, is_new] = numbers.try_emplace(p, static_cast<Index>(numbers.size()));
    if (is_new) {
      surface.points.push_back(Vec3(p[0], p[1], p[2]).cwiseProduct(kBox) /
                               static_cast<double>(squares));
      surface.mesh_points.push_back(place->second);
    }
    return place->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (int side : {0, squares}) {
      for (int i = 0; i < squares; ++i) {
        for (int j = 0; j < squares; ++j) {
          const auto corner = [&](int a, int b) {
            std::array<int, 3> p{};
            p[axis] = side;
            p[u] = i + a;
            p[v] = j + b;
            return number(p);
          };
          const Index square[4] = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          for (const auto& [a, b, c] : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
            if (side > 0)
              surface.triangles.push_back({square[a], square[b], square[c]});
            else
              surface.triangles.push_back({square[a], square[c], square[b]});
          }
        }
      }
    }
  }
  return surface;
}

/// @param only_active Points of the surface that are active; empty: all of the top's inner ones.
/// @param energy_of Of each active node, by its number among them.
inline TouchSpace box_space(const std::function<Energy(int)>& energy_of,
                            std::vector<Index> only_active = {}, int squares = 4) {
  TouchSpace space;
  space.scene_hash = "box";
  space.surface = box_surface(squares);
  if (only_active.empty()) {
    for (Index p = 0; p < space.surface.num_points(); ++p) {
      const Vec3& x = space.surface.points[p];
      const bool inner = x[0] > 0 && x[0] < kBox[0] && x[1] > 0 && x[1] < kBox[1];
      if (inner && x[2] == kBox[2]) only_active.push_back(p);
    }
  }
  for (std::size_t n = 0; n < only_active.size(); ++n) {
    TouchToolSpace tool_space = analytic_space(energy_of(static_cast<int>(n)));
    tool_space.setup.interaction.active_node = only_active[n];
    tool_space.setup.interaction.material_point = space.surface.points[only_active[n]];
    space.tool_spaces.push_back(std::move(tool_space));
  }
  return space;
}

/// All active nodes alike.
inline std::shared_ptr<const Touchable> box_body(double stiffness = 200) {
  return std::make_shared<const Touchable>(
      box_space([&](int) { return stiffening_spring(stiffness); }));
}

}  // namespace palpate::test
