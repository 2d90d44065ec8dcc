// SPDX-License-Identifier: BSD-3-Clause
// The law of contact between parts where the user gives none.
#pragma once

#include <vector>

#include "assembly/scene.h"

namespace palpate {

/// The mean edge of the triangles of the surface's corners, m.
[[nodiscard]] double mean_surface_edge(const TetMesh& mesh);

/// The edge of the triangles around each face of the surface, m [boundary_faces()]: the mean at its
/// points, smaller where the surface is much finer nearby.
/// @param most No edge is taken to be longer than this, m.
[[nodiscard]] std::vector<double> local_surface_edges(const TetMesh& mesh, double most);

/// A fifth of the mean edge of the surface, m: the mesh does not resolve a thinner layer. For the
/// sides of a cut alone, a twentieth of the mean edge of the faces that open: they fit each other,
/// and a closed cut is to be as stiff as the body without it.
[[nodiscard]] double usual_contact_thickness(const Scene& scene);
/// Twice the least Young's modulus under the surface, or beside the faces that open, Pa.
[[nodiscard]] double usual_contact_stiffness(const Scene& scene);

/// Gives the contact of the parts, if they have one, the usual thickness and stiffness where these
/// are 0.
[[nodiscard]] Scene with_contact_defaults(Scene scene);

}  // namespace palpate
