// SPDX-License-Identifier: BSD-3-Clause
// A body is one discretisation of an organ. It has a mesh, and says for this mesh where each
// material lies, where the organ is held and may be touched, and which loads push and pull at its
// surface.
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"
#include "mesh/opened_faces.h"
#include "mesh/tet_mesh.h"

namespace palpate {

/// The directions along which a point is held, as by a plane of symmetry. There are none, one or
/// two; they are orthonormal, and the columns without a direction are zero.
using HeldDirections = Eigen::Matrix<double, 3, 2>;

/// The cut of a body, which opens stage by stage.
struct Cut {
  /// Which faces of each cell open [num_cells]; empty: there is no cut.
  std::vector<OpenedFaces> faces;
  /// The stage at which the mesh is.
  std::int32_t stage = 0;
  /// The area of the sheet that is open at each stage, from 0 on, m².
  std::vector<double> areas;

  [[nodiscard]] double area() const { return areas.empty() ? 0 : areas[stage]; }
};

struct Body {
  TetMesh mesh;
  /// Index into Organ::materials [num_cells]; empty: the whole body has the first material.
  std::vector<Index> material_of_cell;
  /// The part to which each cell belongs, such as one of several organs [num_cells]; empty: there
  /// is one part.
  std::vector<Index> part_of_cell;
  /// 1 for each point whose displacement is 0 [num_points].
  std::vector<char> fixed;
  /// 1 for each point that may be touched [num_points].
  std::vector<char> touchable;
  // The following arrays are empty if the body has nothing of their kind. A spring or load acts on
  // a face of the surface if all corners of the face have it; its values are linear in between.

  /// Directions along which the displacement is 0 [num_points].
  std::vector<HeldDirections> held_directions;
  /// κ, N/m³, of springs that hold the surface at its place at rest [num_points].
  std::vector<double> support_stiffness;
  /// p, Pa, which pushes on the deformed surface [num_points]. It acts only on faces that have the
  /// same p at all corners.
  std::vector<double> applied_pressure;
  /// t, Pa: a force in the direction of t on the area at rest [num_points].
  std::vector<Vec3> applied_traction;

  Cut cut;

  /// The place of a cell's material in Organ::materials.
  [[nodiscard]] Index material_of(Index cell) const {
    return material_of_cell.empty() ? 0 : material_of_cell[cell];
  }
  [[nodiscard]] Index part_of(Index cell) const {
    return part_of_cell.empty() ? 0 : part_of_cell[cell];
  }
  /// Whether the body is held by more than fixed points.
  [[nodiscard]] bool has_supports() const {
    return !held_directions.empty() || !support_stiffness.empty();
  }
  /// Whether something pushes or pulls at the surface.
  [[nodiscard]] bool has_surface_loads() const {
    return !applied_pressure.empty() || !applied_traction.empty();
  }
  /// Whether the surface has more than fixed points.
  [[nodiscard]] bool has_supports_or_surface_loads() const {
    return has_supports() || has_surface_loads();
  }
};

/// A body at rest under its loads, which follows from the scene: see EquilibriumSolver::settled().
/// It is empty if the scene has no load, or if it was not computed yet.
struct SettledBody {
  /// Displacement of every point [3 × num_points], m, and pressures of mixed cells [num_pressures],
  /// Pa.
  NodalVector u;
  NodalVector p;
};

/// The places of the points at rest: those of the mesh, displaced by the loads [num_points], m.
[[nodiscard]] std::vector<Vec3> points_at_rest(const TetMesh& mesh, const SettledBody& at_rest);
[[nodiscard]] Vec3 place_at_rest(const TetMesh& mesh, const SettledBody& at_rest, Index point);

}  // namespace palpate
