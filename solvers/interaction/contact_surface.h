// SPDX-License-Identifier: BSD-3-Clause
// The surface of a body that a tool may press, with the points at which contact is integrated. A
// face is divided into triangles with a rule each (divided_quadrature()), since the scale of
// contact does not depend on the size of the faces. Weights are areas at rest.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <vector>

#include "assembly/body.h"

namespace palpate {

/// The distance of points of integration that is fine enough, in thicknesses of contact.
inline constexpr double kSpacingOfThickness = 0.7;

class ContactSurface {
 public:
  /// Takes those faces of the boundary that have a point which is free to move.
  /// @param spacing The largest distance of neighbouring points of integration, roughly, m.
  /// @throws InputError the spacing is not positive, or so small that a face has more than
  ///   kMostDivisions.
  ContactSurface(const Body& body, double spacing);
  /// The same faces, each divided into divisions² triangles however large it is.
  /// @throws InputError the number of divisions is not within 1 … kMostDivisions.
  [[nodiscard]] static ContactSurface divided(const Body& body, int divisions);

  /// The largest number of parts that an edge is divided into.
  static constexpr int kMostDivisions = 64;

  struct Face {
    /// The points of the mesh: corners, then midside nodes [nodes_per_face()].
    const Index* nodes = nullptr;
    /// The shape functions at the points of integration [points × nodes_per_face()].
    const Eigen::MatrixXd* shape = nullptr;
    /// The area at rest of each point of integration [points], m².
    const double* weights = nullptr;
    /// The mean normal of the face at rest, outward.
    Vec3 normal = Vec3::Zero();
    /// The longest edge between corners, m.
    double longest_edge = 0;
  };

  [[nodiscard]] int nodes_per_face() const { return nodes_per_face_; }
  [[nodiscard]] Index num_faces() const { return static_cast<Index>(divisions_.size()); }
  [[nodiscard]] Face face(Index f) const {
    const auto i = static_cast<std::size_t>(f);
    return {nodes_.data() + i * static_cast<std::size_t>(nodes_per_face_),
            &shapes_.at(divisions_[i]), weights_.data() + first_point_[i], normals_[i],
            longest_edges_[i]};
  }
  /// The places of all points of the mesh at rest, m.
  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
  /// The places at which contact is integrated, m.
  /// @param points The places of all points of the mesh, m.
  [[nodiscard]] std::vector<Vec3> places(const std::vector<Vec3>& points) const;

 private:
  /// @param divisions_for Gives the number of parts of each edge of a face whose longest edge has a
  ///   length, m.
  ContactSurface(const Body& body, const std::function<int(double longest)>& divisions_for);

  int nodes_per_face_;
  std::vector<Vec3> points_;
  std::vector<Index> nodes_;
  std::vector<int> divisions_;
  std::vector<std::size_t> first_point_;
  std::vector<Vec3> normals_;
  std::vector<double> longest_edges_;
  std::vector<double> weights_;
  /// The shape functions of a face, by the number of its divisions.
  std::map<int, Eigen::MatrixXd> shapes_;
};

}  // namespace palpate
