// SPDX-License-Identifier: BSD-3-Clause
// The points of the surface of a body at which the contact of its parts is integrated, and what
// contact needs to know of them in a deformed state.
//
// A point has its place x = Σ N_a x_a, and the normal n = a/|a| of the face there, with a = t₁ × t₂
// and the tangents t = Σ x_a ∂N_a. Its weight is its area at rest.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "assembly/body.h"
#include "soft_contact/kernels.h"

namespace palpate {

class ContactPoints {
 public:
  /// Takes the faces of the boundary.
  /// @param spacings The mean distance of the points on each face, roughly, m [boundary_faces()].
  /// @param reaches ρ of each face, m.
  ContactPoints(const Body& body, const std::vector<double>& spacings, std::vector<double> reaches);

  [[nodiscard]] int nodes_per_face() const { return nodes_per_face_; }
  [[nodiscard]] Index num_faces() const { return static_cast<Index>(part_.size()); }
  /// The number of packets; each has kPacketSize points, of which those without an area only fill
  /// it up.
  [[nodiscard]] Index num_packets() const { return first_packet_.back(); }
  [[nodiscard]] Index num_points() const { return num_packets() * kPacketSize; }
  /// The points of the mesh: corners, then midside nodes [nodes_per_face()].
  [[nodiscard]] const Index* nodes(Index face) const {
    return &nodes_[static_cast<std::size_t>(face * nodes_per_face_)];
  }
  /// The packets of a face are from the first to before that of the next face.
  [[nodiscard]] Index first_packet(Index face) const { return first_packet_[face]; }
  [[nodiscard]] Index first_point(Index face) const { return first_packet_[face] * kPacketSize; }
  [[nodiscard]] Index face_of(Index point) const { return face_of_[point / kPacketSize]; }
  /// Of the first packet of a face; those of the others follow.
  [[nodiscard]] const ShapePacket* shapes(Index face) const { return &shapes_[first_shape_[face]]; }
  /// The part of the body that a face belongs to.
  [[nodiscard]] Index part(Index face) const { return part_[face]; }
  /// ρ of each face, m [num_faces()].
  [[nodiscard]] const std::vector<double>& reaches() const { return reaches_; }
  [[nodiscard]] double reach(Index face) const { return reaches_[face]; }
  /// ρ of the points of two faces: the larger one, so that the finer face finds the points of the
  /// coarser one.
  [[nodiscard]] double reach(Index face, Index other) const {
    return std::max(reaches_[face], reaches_[other]);
  }
  /// Whether a face is on one of the sides of a cut.
  [[nodiscard]] bool is_lip(Index face) const { return is_lip_[face] != 0; }
  [[nodiscard]] bool has_lips() const {
    return std::find(is_lip_.begin(), is_lip_.end(), 1) != is_lip_.end();
  }
  /// Whether no node of a face can move.
  [[nodiscard]] bool is_fixed(Index face) const { return is_fixed_[face] != 0; }
  /// The area at rest of a point, m²; 0: it fills up a packet.
  [[nodiscard]] double area(Index point) const { return areas_[point]; }
  /// Places of the points of the mesh at rest, m.
  [[nodiscard]] const std::vector<Vec3>& rest() const { return rest_; }

  /// The points of some faces in a state, packet by packet, one face after the other.
  /// @param state The displacement of the points of the mesh, m.
  void take_features(const std::vector<Index>& faces, const NodalVector& state,
                     std::vector<PointPacket>& points) const;
  /// Adds the derivative of an energy by place and normal of the points of some faces to that by
  /// the points of the mesh.
  /// @param gradient [packets × 6 × kPacketSize]
  void add_to_nodes(const std::vector<Index>& faces, const std::vector<PointPacket>& points,
                    const std::vector<double>& gradient, NodalVector& of_nodes) const;

  /// The outward normal at a corner of a face in a state.
  [[nodiscard]] Vec3 corner_normal(Index face, int corner, const NodalVector& state) const;

  /// The place of a node of a face in a state, m.
  [[nodiscard]] Vec3 node_place(Index node, const NodalVector& state) const {
    return rest_[node] + state.segment<3>(3 * Eigen::Index{node});
  }

 private:
  struct FaceList;
  /// Some faces as the kernels take them.
  [[nodiscard]] FaceList list(const std::vector<Index>& faces) const;

  int nodes_per_face_;
  std::vector<Vec3> rest_;
  std::vector<Index> nodes_;
  std::vector<Index> part_;
  std::vector<char> is_lip_;
  std::vector<char> is_fixed_;
  std::vector<double> reaches_;
  std::vector<Index> first_packet_{0};
  /// By packets.
  std::vector<Index> face_of_;
  std::vector<double> areas_;
  /// Those of each number of divisions, one after the other, and where those of a face begin.
  std::vector<ShapePacket> shapes_;
  std::vector<Index> first_shape_;
};

}  // namespace palpate
