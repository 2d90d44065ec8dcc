// SPDX-License-Identifier: BSD-3-Clause
// Bodies for tests of what a solver bears: two materials, slivers, pieces, a roof.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "assembly/scene.h"
#include "interaction/bonded_patch.h"
#include "solvers/support/box_mesh.h"

namespace palpate::test {

/// Of the points in use, the one nearest to a place.
[[nodiscard]] Index nearest_point(const TetMesh& mesh, const Vec3& place);

/// Points in use for which the predicate holds.
[[nodiscard]] std::vector<Index> points_where(const TetMesh& mesh,
                                              const std::function<bool(const Vec3&)>& holds);

/// The points move as one.
[[nodiscard]] InteractionList bond_as_one(const std::vector<Index>& points);

/// The scene's material in the first place, another in the cells whose middle lies where `inside`
/// holds.
void put_inside(Scene& scene, const Material& other,
                const std::function<bool(const Vec3&)>& inside);

/// A box of `size` whose planes across each axis are at these shares of it (ascending from 0 to 1).
[[nodiscard]] TetMesh make_graded_box(ElementOrder order,
                                      const std::array<std::vector<double>, 3>& planes,
                                      const Vec3& size);

/// A cube of 2 × 2 × 2 bricks whose middle point lies so near to a face of its neighbourhood that
/// the least dihedral angle of the mesh is `degrees`. Straight edges.
[[nodiscard]] TetMesh make_sliver_box(ElementOrder order, double degrees, double size);

/// Least angle between two faces of a cell, by the corners, degrees.
[[nodiscard]] double least_dihedral_angle(const TetMesh& mesh);

/// Largest ratio of the longest edge to the least height, by the corners.
[[nodiscard]] double largest_aspect_ratio(const TetMesh& mesh);

/// Adds another mesh of the same order, moved by `shift`, that shares no point with the first.
void append(TetMesh& mesh, const TetMesh& other, const Vec3& shift);

/// Adds a copy of the mesh, moved by `shift`, that shares no point with it.
void add_copy(TetMesh& mesh, const Vec3& shift);

/// A shallow cylindrical roof as a solid of Tet10: axis along y, crown up, hinged along its
/// straight edges (the line in the middle of their thickness is fixed) and free along the curved
/// ones. The mesh is its own mirror image in both planes x = 0 and y = 0, and its faces are curved.
struct Roof {
  TetMesh mesh;
  /// 1 where the hinge is [num_points].
  std::vector<char> fixed;
  /// The line through the thickness at the crown's middle, which moves as one.
  InteractionList centre;
};

struct RoofOptions {
  double radius = 2.540;
  /// From the crown to an edge, rad.
  double half_angle = 0.1;
  double length = 0.508;
  double thickness = 0.00635;
  /// Bricks along half of the arc, and along half of the length.
  int cells_arc = 4;
  int cells_length = 4;
};

[[nodiscard]] Roof make_roof(const RoofOptions& options);

}  // namespace palpate::test
