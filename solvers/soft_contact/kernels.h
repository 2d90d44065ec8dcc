// SPDX-License-Identifier: BSD-3-Clause
// The innermost loops of contact (soft_contact.h), for eight points at a time.
//
// One source (kernels.cpp) is compiled for each instruction set, and best_contact_kernels() chooses
// by the processor at run time. The interface has plain pointers and no Eigen types, so that no
// template of a library is instantiated with instructions that the machine may lack. Nothing here
// allocates memory.
//
// The points of contact go packet by packet: a packet has the points of one triangle of a divided
// face, and is filled up with points that have no area. Arrays over points are [packets × 8]; of an
// array with more values a point, the eight points of a packet are innermost.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/simd.h"

namespace palpate {

/// The largest number of nodes of a face.
inline constexpr int kMostFaceNodes = 6;
/// −n_i · n_j from which on two points face each other fully.
inline constexpr double kFullyFacing = 0.5;

/// Shape functions and their two slopes at the points of a packet.
struct ShapePacket {
  /// Of each node, at the points.
  double of_nodes[kMostFaceNodes][3][kPacketSize];
  /// The same of each point, at the nodes; 0 for nodes that the face does not have.
  double at_points[kPacketSize][3][kPacketSize];
};

/// Points in a state.
struct PointPacket {
  double place[3][kPacketSize];
  double normal[3][kPacketSize];
  /// Areas at rest, m².
  double area[kPacketSize];
  /// 1/ρ² of the face, m⁻².
  double inverse_reach_squared;
  /// The corners of the box around the places.
  double low[3];
  double high[3];
  double tangent_1[3][kPacketSize];
  double tangent_2[3][kPacketSize];
  /// 1/|t₁ × t₂|.
  double inverse_norm[kPacketSize];
};

/// Faces, and their packets one after the other.
struct ContactFacesView {
  std::int32_t num_faces;
  std::int32_t nodes_per_face;
  /// [faces × nodes per face]
  const std::int32_t* nodes;
  /// [faces + 1]
  const std::int32_t* first_packet;
  /// Of the first packet of each face [faces]; the others follow.
  const ShapePacket* const* shapes;
  const double* const* areas;
  /// ρ of each face, m [faces].
  const double* reaches;
};

/// All points of two packets may touch each other.
inline constexpr std::uint64_t kAllAllowed = ~std::uint64_t{0};

/// Which packets are near each other.
struct NearPacketsView {
  std::int32_t num_packets;
  /// Where the others of each packet begin [packets + 1], and those with a greater number.
  const std::size_t* first;
  const std::size_t* first_greater;
  /// Ascending.
  const std::int32_t* others;
  /// Bit 8 i + j: the point i of the packet and j of the other one may touch each other.
  const std::uint64_t* allowed;
};

/// The derivatives of the energy of each point by its sums.
struct JetView {
  const double* by_s;
  const double* by_p;
  const double* by_ss;
  const double* by_ps;
  const double* by_pp;
};

/// The second derivative by place x and normal n of a point: xx, yy, zz, xy, xz, yz of ∂²/∂x²; the
/// rows of ∂²/∂x∂n; the same of ∂²/∂n² as of ∂²/∂x².
struct CurvaturePacket {
  static constexpr int kMixed = 6;
  static constexpr int kNormal = 15;
  double values[21][kPacketSize];
};

/// A packet, and what it sees.
struct ContactGroupView {
  std::int32_t packet;
  std::int32_t nodes_per_face;
  const ShapePacket* shapes;
  std::int32_t num_seen;
  /// Packets, and their shapes [seen]; those of a face follow each other.
  const std::int32_t* seen;
  const ShapePacket* const* shapes_seen;
  const std::uint64_t* allowed;
  /// The number of the face of each, from 1 [seen].
  const std::int32_t* face_seen;
  /// The place in the clique of each node of the face of the packet, then of those that are seen
  /// [(1 + faces seen) × nodes per face].
  const std::uint16_t* places;
  /// The number of nodes of the clique.
  std::int32_t num_nodes;
};

/// The number of rows and of columns of the matrix of a clique.
constexpr std::size_t clique_rows(std::size_t num_nodes) {
  return (3 * num_nodes + kPacketSize - 1) / kPacketSize * kPacketSize;
}
/// The number of values of work space that a group needs.
constexpr std::size_t group_room(std::size_t num_nodes) {
  return 4 * kPacketSize * clique_rows(num_nodes);
}

struct ContactKernels {
  /// @param places Those of all points of the mesh, m.
  void (*features)(const ContactFacesView& faces, const double* places, PointPacket* points);
  /// S and P of each point; those of points without an area have no meaning.
  /// @param around 1: points see each other up to ρ; more: up to so many times ρ.
  /// @param rows A bit for each point of a packet that has one of the other packet in reach, the
  ///   lowest for the first point [as others]; those of others with a lesser number are left.
  void (*sums)(const PointPacket* points, const NearPacketsView& near, double around, double* s,
               double* p, unsigned char* rows);
  /// The derivative of the energy by place and normal of each point [packets × 6 × 8].
  void (*gradient)(const PointPacket* points, const NearPacketsView& near,
                   const unsigned char* rows, const JetView& jet, double* gradient);
  /// Adds it to the derivative by the points of the mesh.
  void (*to_nodes)(const ContactFacesView& faces, const PointPacket* points, const double* gradient,
                   double* of_nodes);
  /// Which of the others of each packet one of its points sees that acts [as others].
  /// @param around As of sums().
  /// @param acts Whether each point does [packets × 8].
  void (*find_seen)(const PointPacket* points, const NearPacketsView& near, double around,
                    const char* acts, char* seen);
  /// The second derivative of the energy of the points of a packet by the nodes of its clique: the
  /// lower part of a matrix that is stored by columns [clique_rows × clique_rows], without the
  /// second derivatives by one and the same point, which are added to `curvature`.
  /// @param room Work space [group_room].
  void (*couple)(const ContactGroupView& group, const PointPacket* points, const JetView& jet,
                 CurvaturePacket* curvature, double* room, double* matrix);
  /// The second derivative by the nodes of a face of what its packets have by place and normal of
  /// each point [18 × 18], with the gradient by the normal times the second derivative of that.
  /// @param curvature, gradient Of the first packet of the face.
  void (*of_face)(std::int32_t num_packets, const ShapePacket* shapes, const PointPacket* points,
                  const CurvaturePacket* curvature, const double* gradient, double* matrix);
};

/// The kernels for this processor.
[[nodiscard]] const ContactKernels& best_contact_kernels();

}  // namespace palpate
