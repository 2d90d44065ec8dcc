// SPDX-License-Identifier: BSD-3-Clause
// The body at a stage of a cut: the cells are the same at all stages, and the points of the faces
// that have opened are there once for each side.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh/opened_faces.h"
#include "mesh/tet_mesh.h"

namespace palpate {

struct OpenedMesh {
  /// Its first points are those of the closed mesh, with their numbers.
  TetMesh mesh;
  /// The point of the closed mesh that each further point is another copy of.
  std::vector<Index> originals;
};

/// Opens the faces up to a stage. Around each point, the cells that hang together by faces that are
/// not open share one copy of it.
/// @param faces Those of each cell [num_cells].
[[nodiscard]] OpenedMesh open_mesh(const TetMesh& mesh, const std::vector<OpenedFaces>& faces,
                                   int stage);

struct MeshFault {
  std::string text;
  /// The edge of the closed mesh that a point in its middle would mend.
  std::optional<std::pair<Index, Index>> edge;
};

/// What makes an opened mesh no sound body: a face that is open on one side alone or that has no
/// corner that opens, an edge of the boundary that does not belong to two faces, or a boundary
/// whose Euler characteristic is not that of the closed mesh with the two sides of the open faces.
/// Empty: nothing.
[[nodiscard]] std::optional<MeshFault> find_fault(const TetMesh& mesh,
                                                  const std::vector<OpenedFaces>& faces, int stage);

/// The Euler characteristic V − E + F of the boundary of a mesh.
[[nodiscard]] Index euler_characteristic(const TetMesh& mesh);

}  // namespace palpate
