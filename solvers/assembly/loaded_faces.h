// SPDX-License-Identifier: BSD-3-Clause
// Faces of the surface with a load or support, such as a pressure or springs, and the integrals
// over them:
//
//   ∫ f dA = Σ_q w_q f(ξ_q) |∂x/∂ξ × ∂x/∂η|   over the triangle 0 ≤ ξ, η, ξ + η ≤ 1
#pragma once

#include <functional>
#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate {

/// The shape functions of a face at a quadrature point.
struct FacePoint {
  /// The weights of a rule add up to 1/2.
  double weight = 0;
  /// Shape functions of the nodes, in the order of boundary_faces() [nodes_per_face(order)].
  Eigen::VectorXd values;
  /// Their derivatives by ξ and η [nodes_per_face(order) × 2].
  Eigen::Matrix<double, Eigen::Dynamic, 2> slopes;
  /// Weights of the corners, for values that are linear between them.
  Vec3 of_corners;
};

/// A rule of degree 5 (Radon 1948): exact for a linear function times two shape functions of a
/// Tet10 with straight edges.
[[nodiscard]] std::vector<FacePoint> face_quadrature(ElementOrder order);

/// A rule for what has a scale of its own, such as contact: the face is divided into divisions²
/// triangles, each with the six points that are exact for degree 4 (Dunavant, Int. J. Numer.
/// Methods Eng. 21, 1985).
[[nodiscard]] std::vector<FacePoint> divided_quadrature(ElementOrder order, int divisions);

/// The faces of the boundary for whose three corners the predicate holds, in the format of
/// boundary_faces().
[[nodiscard]] std::vector<Index> faces_where(
    const TetMesh& mesh, const std::function<bool(const Index* corners)>& holds);

/// Whether the corners of a face all have the same pressure, or all have a traction.
[[nodiscard]] bool is_under_pressure(const std::vector<double>& pressure, const Index* corners);
[[nodiscard]] bool has_traction(const std::vector<Vec3>& traction, const Index* corners);

/// The faces whose corners all have a stiffness, all have a traction, or all have the same
/// pressure; none if the array is empty.
[[nodiscard]] std::vector<Index> faces_with(const TetMesh& mesh, const std::vector<double>& array);
[[nodiscard]] std::vector<Index> faces_with(const TetMesh& mesh, const std::vector<Vec3>& array);
[[nodiscard]] std::vector<Index> faces_under_pressure(const TetMesh& mesh,
                                                      const std::vector<double>& pressure);

/// The places of the nodes of a face at rest [3 × nodes_per_face], m.
/// @param nodes As faces_where() gives them.
[[nodiscard]] Eigen::Matrix3Xd places_of_face(const TetMesh& mesh, const Index* nodes);

/// The share of a face's area that a quadrature point stands for, m².
/// @param places Places of the nodes of the face.
[[nodiscard]] double area_at(const FacePoint& point, const Eigen::Matrix3Xd& places);

/// The area of faces, m².
[[nodiscard]] double area_of(const TetMesh& mesh, const std::vector<Index>& faces);

/// For each node of these faces, the sum of the outward normals of its faces [num_points]; the
/// length of each is twice the area of the triangle of the face's corners, m². It is 0 at other
/// points.
[[nodiscard]] std::vector<Vec3> normals_at(const TetMesh& mesh, const std::vector<Index>& faces);

/// 1 for each point on a connected part of the surface that encloses a cavity instead of the body
/// [num_points].
[[nodiscard]] std::vector<char> points_of_cavities(const TetMesh& mesh);

}  // namespace palpate
