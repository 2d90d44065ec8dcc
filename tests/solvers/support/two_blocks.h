// SPDX-License-Identifier: BSD-3-Clause
// Two soft blocks, one on the other, with meshes that do not match, which touch each other.
#pragma once

#include <array>
#include <vector>

#include "assembly/scene.h"
#include "materials/material.h"

namespace palpate::test {

struct TwoBlocksOptions {
  ElementOrder order = ElementOrder::quadratic;
  std::array<int, 3> lower_cells{3, 3, 1};
  std::array<int, 3> upper_cells{2, 2, 1};
  Vec3 lower_size = Vec3(0.03, 0.03, 0.01);
  Vec3 upper_size = Vec3(0.018, 0.02, 0.01);
  /// Where the lower corner of the upper block is above the lower one, m.
  Vec3 upper_at = Vec3(0.007, 0.004, 0.0);
  double thickness = 0.002;
  /// κ in Young's moduli of the lower block.
  double stiffness = 2;
  double youngs_modulus = 5000;
  double upper_youngs_modulus = 5000;
  double poissons_ratio = 0.4;
  Law law = Law::neo_hookean;
};

/// The lower block, part 0, is fixed at its bottom; the upper one, part 1, at its top. Both begin
/// at x = y = 0 and z = 0 but for upper_at; the upper one is above the lower one.
[[nodiscard]] Scene make_two_blocks(const TwoBlocksOptions& options = {});

/// Bends the surface of the upper part that faces the lower one to a paraboloid of this radius, m.
void bend_to_dome(Scene& scene, const TwoBlocksOptions& options, double radius);

/// Frees the top of the upper part, for a tool to hold.
/// @returns Its points.
[[nodiscard]] std::vector<Index> free_top(Scene& scene);

/// 1 for each point of part 1 [num_points].
[[nodiscard]] std::vector<char> points_of_upper(const Scene& scene);

}  // namespace palpate::test
