// SPDX-License-Identifier: BSD-3-Clause
// The second derivative of the energy of contact. The energy of a point i depends on the sums P and
// S, so that
//
//   D²Φ_i = Φ_P D²P + Φ_S D²S + [DP DS] [Φ_PP Φ_PS; Φ_PS Φ_SS] [DP DS]ᵀ
//
// Its last part couples all nodes of the faces that i sees. The points of a packet lie together and
// see the same faces, so that they share one matrix.
#include <algorithm>
#include <cstddef>
#include <utility>

#include "soft_contact/cliques.h"
#include "soft_contact/contact_sight.h"
#include "soft_contact/soft_contact.h"

namespace palpate {
namespace {

/// Pairs that are near to being coupled have theirs at these times ρ, or where the law would act if
/// it began this share of the thickness earlier.
constexpr double kAround = 1.1;
constexpr double kSooner = 0.15;

constexpr int kOfFace = 3 * kMostFaceNodes;

}  // namespace

/// Which points act, what these see, and the nodes that are coupled by it.
struct SoftContact::Coupling {
  /// A packet with points that act, what these see, and its clique.
  struct Group {
    std::int32_t packet;
    std::size_t clique;
    std::vector<std::int32_t> seen;
    std::vector<const ShapePacket*> shapes_seen;
    std::vector<std::uint64_t> allowed;
    std::vector<std::int32_t> face_seen;
    std::vector<std::uint16_t> places;
  };
  /// A face with a point that acts or is seen by one, and its clique.
  struct Face {
    std::int32_t face;
    std::size_t clique;
  };

  std::vector<Group> groups;
  std::vector<Face> faces;
  Cliques cliques;
};

SoftContact::Coupling SoftContact::couple(const Sight& sight, double further) const {
  const ContactNeighbours& near = neighbours_.front();
  std::vector<char> acts(sight.num_points());
  for (std::size_t i = 0; i < acts.size(); ++i) {
    acts[i] = this->acts(near.point(i), sight.sums(i), further) ? 1 : 0;
  }
  std::vector<char> seen(near.others.size());
  best_contact_kernels().find_seen(sight.points.data(), near.view(), sight.around, acts.data(),
                                   seen.data());
  Coupling result;
  const auto per_face = static_cast<std::size_t>(points_.nodes_per_face());
  std::vector<char> is_coupled(near.faces.size(), 0);
  for (std::size_t packet = 0; packet < near.num_packets(); ++packet) {
    Coupling::Group group;
    std::vector<std::int32_t> faces{near.face_of[packet]};
    for (std::size_t k = near.first[packet]; k < near.first[packet + 1]; ++k) {
      if (seen[k] == 0) continue;
      const std::int32_t other = near.others[k];
      const std::int32_t face = near.face_of[other];
      if (faces.size() == 1 || faces.back() != face) faces.push_back(face);
      group.seen.push_back(other);
      group.shapes_seen.push_back(points_.shapes(near.faces[face]) + other -
                                  near.first_packet[face]);
      group.allowed.push_back(near.allowed[k]);
      group.face_seen.push_back(static_cast<std::int32_t>(faces.size() - 1));
    }
    if (group.seen.empty()) continue;
    group.packet = static_cast<std::int32_t>(packet);
    std::vector<Index> nodes;
    for (const std::int32_t face : faces) {
      is_coupled[face] = 1;
      const Index* of_face = points_.nodes(near.faces[face]);
      for (std::size_t a = 0; a < per_face; ++a) {
        const auto at = std::find(nodes.begin(), nodes.end(), of_face[a]);
        group.places.push_back(static_cast<std::uint16_t>(at - nodes.begin()));
        if (at == nodes.end()) nodes.push_back(of_face[a]);
      }
    }
    group.clique = result.cliques.add(std::move(nodes));
    result.groups.push_back(std::move(group));
  }
  for (std::size_t f = 0; f < is_coupled.size(); ++f) {
    if (is_coupled[f] == 0) continue;
    const Index* nodes = points_.nodes(near.faces[f]);
    result.faces.push_back(
        {static_cast<std::int32_t>(f), result.cliques.add({nodes, nodes + per_face})});
  }
  return result;
}

std::vector<PointPair> SoftContact::pairs_around(const NodalVector& state) const {
  const Sight& sight = look(state, kAround);
  return couple(sight, kSooner * law_.thickness)
      .cliques.name_pairs(static_cast<Index>(points_.rest().size()));
}

void SoftContact::take_blocks(const NodalVector& state, PairBlocks& result) const {
  Sight& sight = look(state, 1);
  const ContactNeighbours& near = neighbours_.front();
  Coupling coupling = couple(sight, 0);
  result.pairs = coupling.cliques.name_pairs(static_cast<Index>(points_.rest().size()));
  std::vector<Mat3>& blocks = result.values;
  blocks.assign(result.pairs.size(), Mat3::Zero());
  if (coupling.groups.empty()) return;
  (void)differentiate(sight);
  const ContactKernels& kernels = best_contact_kernels();
  std::vector<CurvaturePacket> curvature(near.num_packets(), CurvaturePacket{});
  std::vector<double> room;
  std::vector<double> matrix;
  const int per_face = points_.nodes_per_face();
  for (const Coupling::Group& group : coupling.groups) {
    const std::size_t num_nodes = coupling.cliques.nodes(group.clique).size();
    const std::size_t size = clique_rows(num_nodes);
    if (room.size() < group_room(num_nodes)) room.resize(group_room(num_nodes));
    if (matrix.size() < size * size) matrix.resize(size * size);
    const std::int32_t face = near.face_of[group.packet];
    const ContactGroupView view{
        group.packet,
        per_face,
        points_.shapes(near.faces[face]) + group.packet - near.first_packet[face],
        static_cast<std::int32_t>(group.seen.size()),
        group.seen.data(),
        group.shapes_seen.data(),
        group.allowed.data(),
        group.face_seen.data(),
        group.places.data(),
        static_cast<std::int32_t>(num_nodes)};
    kernels.couple(view, sight.points.data(), sight.jets.view(), curvature.data(), room.data(),
                   matrix.data());
    coupling.cliques.add_blocks(group.clique, matrix.data(), size, blocks);
  }
  double of_face[kOfFace * kOfFace];
  for (const auto& [face, clique] : coupling.faces) {
    const std::int32_t first = near.first_packet[face];
    kernels.of_face(near.first_packet[face + 1] - first, points_.shapes(near.faces[face]),
                    &sight.points[first], &curvature[first],
                    &sight.gradient[6 * kPacketSize * static_cast<std::size_t>(first)], of_face);
    coupling.cliques.add_blocks(clique, of_face, kOfFace, blocks);
  }
}

}  // namespace palpate
