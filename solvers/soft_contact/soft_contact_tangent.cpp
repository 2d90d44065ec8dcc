// SPDX-License-Identifier: BSD-3-Clause
// The second derivative of the energy of contact. The energy of a point i depends on the sums P and
// S, so that
//
//   D²Φ_i = Φ_P D²P + Φ_S D²S + [DP DS] [Φ_PP Φ_PS; Φ_PS Φ_SS] [DP DS]ᵀ
//
// Its last part couples all nodes of the faces that i sees. Points that lie together on a face see
// the same faces, so that they share one matrix.
#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "soft_contact/cliques.h"
#include "soft_contact/contact_sight.h"
#include "soft_contact/soft_contact.h"

namespace palpate {
namespace {

/// How many points that follow each other on a face share a matrix.
constexpr std::uint32_t kPointsTogether = 6;
/// Pairs that are near to being coupled have theirs at these times ρ, or where the law would act if
/// it began this share of the thickness earlier.
constexpr double kAround = 1.2;
constexpr double kSooner = 0.3;

constexpr int kOfFace = 3 * ContactPoints::kMostNodes;
using Slopes = ContactPoints::Slopes;

}  // namespace

/// Which points act, what these see, and the nodes that are coupled by it.
struct SoftContact::Coupling {
  /// What a point sees: the other point, and the pair of the two.
  struct Seen {
    std::uint32_t other;
    std::uint32_t pair;
  };

  /// Points of one face, and the faces that they see.
  struct Group {
    std::vector<std::uint32_t> points;
    std::size_t clique;
    /// The places of the nodes of the face, then of those of each face that is seen, in the clique
    /// [(1 + faces) × nodes per face].
    std::vector<std::uint16_t> of_faces;
  };

  std::vector<char> acts;
  /// Where what each point sees begins [points + 1]; only of points that act.
  std::vector<std::size_t> first_seen;
  /// Ascending by the other point.
  std::vector<Seen> seen;
  /// The place of the face of the other among those that the group sees, from 1.
  std::vector<std::uint32_t> slots;
  std::vector<Group> groups;
  Cliques cliques;
  /// The clique of each face that has a part in it; kNone: it has none.
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> clique_of_face;
};

SoftContact::Coupling SoftContact::couple(const Sight& sight, double further) const {
  const ContactNeighbours& near = neighbours_.front();
  const std::size_t num_points = near.points.size();
  Coupling result;
  result.acts.resize(num_points);
  for (std::size_t i = 0; i < num_points; ++i) {
    result.acts[i] = acts(near.points[i], sight.sums[i], further) ? 1 : 0;
  }
  result.first_seen.assign(num_points + 1, 0);
  for (std::size_t p = 0; p < sight.num_pairs; ++p) {
    const FeltPair& pair = sight.pairs[p];
    result.first_seen[pair.i + 1] += result.acts[pair.i] != 0 ? 1 : 0;
    result.first_seen[pair.j + 1] += result.acts[pair.j] != 0 ? 1 : 0;
  }
  for (std::size_t i = 0; i < num_points; ++i) result.first_seen[i + 1] += result.first_seen[i];
  result.seen.resize(result.first_seen.back());
  result.slots.resize(result.seen.size());
  std::vector<std::size_t> next(result.first_seen.begin(), result.first_seen.end() - 1);
  for (std::uint32_t p = 0; p < sight.num_pairs; ++p) {
    const FeltPair& pair = sight.pairs[p];
    if (result.acts[pair.i] != 0) result.seen[next[pair.i]++] = {pair.j, p};
    if (result.acts[pair.j] != 0) result.seen[next[pair.j]++] = {pair.i, p};
  }

  const int per_face = points_.nodes_per_face();
  const std::size_t num_faces = near.faces.size();
  result.clique_of_face.assign(num_faces, Coupling::kNone);
  std::vector<std::uint32_t> slot_of(num_faces, 0);
  std::vector<std::uint32_t> faces;
  for (std::size_t f = 0; f < num_faces; ++f) {
    for (std::uint32_t first = near.first_point[f]; first < near.first_point[f + 1];
         first += kPointsTogether) {
      const std::uint32_t last = std::min(first + kPointsTogether, near.first_point[f + 1]);
      Coupling::Group group;
      faces.assign(1, static_cast<std::uint32_t>(f));
      for (std::uint32_t i = first; i < last; ++i) {
        if (result.acts[i] == 0) continue;
        group.points.push_back(i);
        for (std::size_t k = result.first_seen[i]; k < result.first_seen[i + 1]; ++k) {
          const std::uint32_t face = near.face_of[result.seen[k].other];
          if (slot_of[face] == 0) {
            slot_of[face] = static_cast<std::uint32_t>(faces.size());
            faces.push_back(face);
          }
          result.slots[k] = slot_of[face];
        }
      }
      if (group.points.empty()) continue;
      std::vector<Index> nodes;
      for (const std::uint32_t face : faces) {
        slot_of[face] = 0;
        result.clique_of_face[face] = 0;
        for (int a = 0; a < per_face; ++a) {
          const Index node = points_.nodes(near.faces[face])[a];
          const auto at = std::find(nodes.begin(), nodes.end(), node);
          group.of_faces.push_back(static_cast<std::uint16_t>(at - nodes.begin()));
          if (at == nodes.end()) nodes.push_back(node);
        }
      }
      group.clique = result.cliques.add(std::move(nodes));
      result.groups.push_back(std::move(group));
    }
  }
  for (std::size_t f = 0; f < num_faces; ++f) {
    if (result.clique_of_face[f] == Coupling::kNone) continue;
    const Index* nodes = points_.nodes(near.faces[f]);
    result.clique_of_face[f] = result.cliques.add({nodes, nodes + per_face});
  }
  return result;
}

std::vector<PointPair> SoftContact::pairs_around(const NodalVector& state) const {
  const Sight& sight = look(state, kAround * reach_);
  return couple(sight, kSooner * law_.thickness)
      .cliques.name_pairs(static_cast<Index>(points_.rest().size()));
}

void SoftContact::take_blocks(const NodalVector& state, PairBlocks& result) const {
  const Sight& sight = look(state, reach_);
  const ContactNeighbours& near = neighbours_.front();
  Coupling coupling = couple(sight, 0);
  result.pairs = coupling.cliques.name_pairs(static_cast<Index>(points_.rest().size()));
  std::vector<Mat3>& blocks = result.values;
  blocks.assign(result.pairs.size(), Mat3::Zero());
  const std::size_t num_points = near.points.size();
  // By place and normal of each point.
  std::vector<Vec6> gradient(num_points, Vec6::Zero());
  std::vector<Mat6> curvature(num_points, Mat6::Zero());
  std::vector<Slopes> slopes(num_points);
  std::vector<char> has_slopes(num_points, 0);
  const auto slopes_at = [&](std::uint32_t i) -> const Slopes& {
    if (has_slopes[i] == 0) {
      slopes[i] = points_.slopes(near.points[i], sight.at[i]);
      has_slopes[i] = 1;
    }
    return slopes[i];
  };
  const auto per_face = static_cast<std::size_t>(points_.nodes_per_face());
  Eigen::MatrixXd whole;
  Eigen::MatrixXd of_sums;
  Eigen::MatrixXd weighed;
  for (const Coupling::Group& group : coupling.groups) {
    const auto size = static_cast<Eigen::Index>(3 * coupling.cliques.nodes(group.clique).size());
    whole.setZero(size, size);
    // Two columns for each point: the derivatives of P and of S by the nodes.
    of_sums.setZero(size, 2 * static_cast<Eigen::Index>(group.points.size()));
    weighed.resize(size, of_sums.cols());
    Eigen::Index column = 0;
    for (const std::uint32_t i : group.points) {
      const Jet jet = energy_of(near.points[i], sight.sums[i]);
      const Slopes& of_i = slopes_at(i);
      const SeenPoint& here = sight.seen[i];
      Vec6 p_i = Vec6::Zero();
      Vec6 s_i = Vec6::Zero();
      for (std::size_t k = coupling.first_seen[i]; k < coupling.first_seen[i + 1];) {
        const std::uint32_t slot = coupling.slots[k];
        Slopes crossed = Slopes::Zero();
        Eigen::Matrix<double, kOfFace, 2> of_slot = Eigen::Matrix<double, kOfFace, 2>::Zero();
        for (; k < coupling.first_seen[i + 1] && coupling.slots[k] == slot; ++k) {
          const auto [other, number] = coupling.seen[k];
          const FeltPair& pair = sight.pairs[number];
          const SeenPoint& there = sight.seen[other];
          const CommonTerms common = common_terms(here, there, pair.t, pair.facing, reach_);
          const Vec3 r = here.place - there.place;
          const PairGradient by_p = gradient_of(common, r, here, there, {0, 1});
          const PairGradient by_s = gradient_of(common, r, here, there, {1, 0});
          const PairCurvature d = curvature_of(common, r, here, there, {jet.s, jet.p});
          p_i += by_p.i;
          s_i += by_s.i;
          curvature[i] += d.ii;
          curvature[other] += d.jj;
          gradient[other] += jet.p * by_p.j + jet.s * by_s.j;
          const Slopes& of_j = slopes_at(other);
          crossed.noalias() += d.ij * of_j;
          of_slot.col(0).noalias() += of_j.transpose() * by_p.j;
          of_slot.col(1).noalias() += of_j.transpose() * by_s.j;
        }
        const Eigen::Matrix<double, kOfFace, kOfFace> block = of_i.transpose() * crossed;
        for (std::size_t b = 0; b < per_face; ++b) {
          const Eigen::Index of_b = 3 * Eigen::Index{group.of_faces[slot * per_face + b]};
          of_sums.block<3, 2>(of_b, column) +=
              of_slot.middleRows<3>(3 * static_cast<Eigen::Index>(b));
          for (std::size_t a = 0; a < per_face; ++a) {
            const Eigen::Index of_a = 3 * Eigen::Index{group.of_faces[a]};
            const auto of_nodes = block.block<3, 3>(3 * static_cast<Eigen::Index>(a),
                                                    3 * static_cast<Eigen::Index>(b));
            if (of_a >= of_b) whole.block<3, 3>(of_a, of_b) += of_nodes;
            if (of_b >= of_a) whole.block<3, 3>(of_b, of_a) += of_nodes.transpose();
          }
        }
      }
      gradient[i] += jet.p * p_i + jet.s * s_i;
      const auto rows = static_cast<Eigen::Index>(3 * per_face);
      of_sums.col(column).head(rows) += (of_i.transpose() * p_i).head(rows);
      of_sums.col(column + 1).head(rows) += (of_i.transpose() * s_i).head(rows);
      Eigen::Matrix2d by_sums;
      by_sums << jet.pp, jet.ps, jet.ps, jet.ss;
      weighed.middleCols<2>(column) = of_sums.middleCols<2>(column) * by_sums;
      column += 2;
    }
    whole.noalias() += weighed * of_sums.transpose();
    coupling.cliques.add_blocks(group.clique, whole, blocks);
  }
  ContactPoints::FaceBlock of_face;
  for (std::size_t f = 0; f < near.faces.size(); ++f) {
    if (coupling.clique_of_face[f] == Coupling::kNone) continue;
    of_face.setZero();
    for (std::uint32_t i = near.first_point[f]; i < near.first_point[f + 1]; ++i) {
      if (has_slopes[i] == 0) continue;
      of_face += slopes[i].transpose() * curvature[i] * slopes[i];
      points_.add_curvature(near.points[i], sight.at[i], gradient[i].tail<3>(), of_face);
    }
    const auto rows = static_cast<Eigen::Index>(3 * per_face);
    coupling.cliques.add_blocks(coupling.clique_of_face[f], of_face.topLeftCorner(rows, rows),
                                blocks);
  }
}

}  // namespace palpate
