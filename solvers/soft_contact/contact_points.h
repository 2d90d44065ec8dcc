// SPDX-License-Identifier: BSD-3-Clause
// The points of the surface of a body at which the contact of its parts is integrated, and what
// contact needs to know of them in a deformed state.
//
// A point has its place x = Σ N_a x_a, and the normal n = a/|a| of the face there, with a = t₁ × t₂
// and the tangents t = Σ x_a ∂N_a. Its weight is its area at rest.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "assembly/body.h"

namespace palpate {

/// A point in a state: its place, the tangents of its face, the outward normal, and 1/|a|.
struct PointFeatures {
  Vec3 place;
  Vec3 tangent_1;
  Vec3 tangent_2;
  Vec3 normal;
  double inverse_area;
};

/// The place and the normal of a point, or a derivative by them.
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

class ContactPoints {
 public:
  /// The largest number of nodes of a face.
  static constexpr int kMostNodes = 6;
  /// The derivative of place and normal of a point by the nodes of its face.
  using Slopes = Eigen::Matrix<double, 6, 3 * kMostNodes>;
  /// A second derivative by the nodes of a face.
  using FaceBlock = Eigen::Matrix<double, 3 * kMostNodes, 3 * kMostNodes>;

  /// Takes the faces of the boundary.
  /// @param spacing The mean distance of the points on a face, roughly, m.
  ContactPoints(const Body& body, double spacing);

  [[nodiscard]] int nodes_per_face() const { return nodes_per_face_; }
  [[nodiscard]] Index num_faces() const { return static_cast<Index>(part_.size()); }
  [[nodiscard]] Index num_points() const { return static_cast<Index>(areas_.size()); }
  /// The points of the mesh: corners, then midside nodes [nodes_per_face()].
  [[nodiscard]] const Index* nodes(Index face) const {
    return &nodes_[static_cast<std::size_t>(face * nodes_per_face_)];
  }
  /// The points of a face are from the first to before that of the next face.
  [[nodiscard]] Index first_point(Index face) const { return first_point_[face]; }
  [[nodiscard]] Index face_of(Index point) const { return face_of_[point]; }
  /// The part of the body that a face belongs to.
  [[nodiscard]] Index part(Index face) const { return part_[face]; }
  /// Whether no node of a face can move.
  [[nodiscard]] bool is_fixed(Index face) const { return is_fixed_[face] != 0; }
  /// The area at rest of a point, m².
  [[nodiscard]] double area(Index point) const { return areas_[point]; }
  /// Places of the points of the mesh at rest, m.
  [[nodiscard]] const std::vector<Vec3>& rest() const { return rest_; }

  /// @param state The displacement of the points of the mesh, m.
  [[nodiscard]] PointFeatures features(Index point, const NodalVector& state) const;
  /// The place of a point, m.
  [[nodiscard]] Vec3 place(Index point, const NodalVector& state) const;
  [[nodiscard]] Slopes slopes(Index point, const PointFeatures& at) const;
  /// Adds the derivative of an energy by place and normal of a point to that by the nodes.
  void add_to_nodes(Index point, const PointFeatures& at, const Vec6& gradient,
                    NodalVector& of_nodes) const;
  /// Adds the second derivative of by_normal · n.
  void add_curvature(Index point, const PointFeatures& at, const Vec3& by_normal,
                     FaceBlock& block) const;

  /// The outward normal at a corner of a face in a state.
  [[nodiscard]] Vec3 corner_normal(Index face, int corner, const NodalVector& state) const;

  /// The place of a node of a face in a state, m.
  [[nodiscard]] Vec3 node_place(Index node, const NodalVector& state) const {
    return rest_[node] + state.segment<3>(3 * Eigen::Index{node});
  }

 private:
  /// Shape functions and their slopes at a point of a face.
  struct Shape {
    std::array<double, kMostNodes> values;
    std::array<double, kMostNodes> slopes_1;
    std::array<double, kMostNodes> slopes_2;
  };

  [[nodiscard]] const Shape& shape(Index point) const {
    return shapes_[shape_of_face_[face_of_[point]] + point - first_point_[face_of_[point]]];
  }

  int nodes_per_face_;
  std::vector<Vec3> rest_;
  std::vector<Index> nodes_;
  std::vector<Index> part_;
  std::vector<char> is_fixed_;
  std::vector<Index> first_point_;
  std::vector<Index> face_of_;
  std::vector<double> areas_;
  /// The shapes of each number of divisions, one after the other, and where those of a face begin.
  std::vector<Shape> shapes_;
  std::vector<Index> shape_of_face_;
};

}  // namespace palpate
