// SPDX-License-Identifier: BSD-3-Clause
// Faces of the surface that carry something, such as a pressure or springs, and what integrals over
// them need:
//
//   ∫ f dA = Σ_q w_q f(ξ_q) |∂x/∂ξ × ∂x/∂η|   over the triangle 0 ≤ ξ, η, ξ + η ≤ 1
#pragma once

#include <functional>
#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate {

/// The shape functions of a face at a quadrature point.
struct FacePoint {
  /// Weights sum up to 1/2.
  double weight = 0;
  /// Of the nodes, in the order of boundary_faces() [nodes_per_face(order)].
  Eigen::VectorXd values;
  /// By ξ and η [nodes_per_face(order) × 2].
  Eigen::Matrix<double, Eigen::Dynamic, 2> slopes;
  /// Weights of the corners between which something is linear.
  Vec3 of_corners;
};

/// A rule of degree 5 (Radon 1948): exact for what is linear times two shape functions of a Tet10
/// with straight edges.
[[nodiscard]] std::vector<FacePoint> face_quadrature(ElementOrder order);

/// The faces of the boundary for whose three corners the predicate holds, as boundary_faces() gives
/// them.
[[nodiscard]] std::vector<Index> faces_where(
    const TetMesh& mesh, const std::function<bool(const Index* corners)>& holds);

/// Whether the corners of a face have a pressure which is the same, or all a traction.
[[nodiscard]] bool is_under_pressure(const std::vector<double>& pressure, const Index* corners);
[[nodiscard]] bool has_traction(const std::vector<Vec3>& traction, const Index* corners);

/// Those whose corners all have a stiffness, a pressure which is the same, a traction; none where
/// the array is empty.
[[nodiscard]] std::vector<Index> faces_with(const TetMesh& mesh, const std::vector<double>& array);
[[nodiscard]] std::vector<Index> faces_with(const TetMesh& mesh, const std::vector<Vec3>& array);
[[nodiscard]] std::vector<Index> faces_under_pressure(const TetMesh& mesh,
                                                      const std::vector<double>& pressure);

/// The places of the nodes of a face at rest [3 × nodes_per_face], m.
/// @param nodes As faces_where() has them.
[[nodiscard]] Eigen::Matrix3Xd places_of_face(const TetMesh& mesh, const Index* nodes);

/// What of the area of a face a quadrature point stands for, m².
/// @param places Of the nodes of the face.
[[nodiscard]] double area_at(const FacePoint& point, const Eigen::Matrix3Xd& places);

/// The area of faces, m².
[[nodiscard]] double area_of(const TetMesh& mesh, const std::vector<Index>& faces);

/// The outward normals of faces at their nodes, those of the corners of each with twice its area,
/// m², as their length, summed up; 0 at other points [num_points].
[[nodiscard]] std::vector<Vec3> normals_at(const TetMesh& mesh, const std::vector<Index>& faces);

/// 1 for each point on a connected part of the surface that closes in a cavity and no body
/// [num_points].
[[nodiscard]] std::vector<char> points_of_cavities(const TetMesh& mesh);

}  // namespace palpate
