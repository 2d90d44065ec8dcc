// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/piece_support.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "assembly/supports.h"
#include "base/error.h"

namespace palpate {
namespace {

/// Points lie on a line if their spread across it is below this share of their spread along it.
constexpr double kLine = 1e-6;
/// The number of loose pieces that are described, the largest first.
constexpr std::size_t kMostDescribed = 3;

/// The dimension of the span of points: −1 none, 0 a point, 1 a line, 2 more.
int dimension(const std::vector<Vec3>& points) {
  if (points.empty()) return -1;
  Mat3 squares = Mat3::Zero();
  for (const Vec3& p : points) squares += (p - points[0]) * (p - points[0]).transpose();
  const Vec3 spread =
      Eigen::SelfAdjointEigenSolver<Mat3>(squares).eigenvalues().cwiseMax(0).cwiseSqrt();
  if (spread[2] == 0) return 0;
  return spread[1] <= kLine * spread[2] ? 1 : 2;
}

std::string how_it_moves(int spanned) {
  switch (spanned) {
    case -1: return "is not held";
    case 0: return "is not held but at one point, about which it turns";
    default: return "is not held but along one line, about which it turns";
  }
}

}  // namespace

PieceSupport::PieceSupport(const TetMesh& mesh, const std::vector<char>& fixed) {
  const Pieces pieces = find_pieces(mesh);
  num_pieces_ = pieces.size();
  const std::vector<Index> piece_of_point = piece_of_points(mesh, pieces);
  std::vector<std::vector<Vec3>> fixed_of_piece(pieces.each.size());
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (fixed[p] != 0 && piece_of_point[p] >= 0) {
      fixed_of_piece[piece_of_point[p]].push_back(mesh.points[p]);
    }
  }
  std::vector<Index> weak_of_piece(pieces.each.size(), -1);
  for (Index piece = 0; piece < pieces.size(); ++piece) {
    if (dimension(fixed_of_piece[piece]) == 2) continue;
    weak_of_piece[piece] = static_cast<Index>(weak_.size());
    weak_.push_back({pieces.each[piece], fixed_of_piece[piece]});
  }
  if (weak_.empty()) return;
  points_ = mesh.points;
  for (const Index piece : piece_of_point) {
    weak_of_point_.push_back(piece < 0 ? -1 : weak_of_piece[piece]);
  }
}

PieceSupport::PieceSupport(const Scene& scene)
    : PieceSupport(scene.body.mesh, holding_points(scene.body)) {
  parts_touch_ = scene.has_contact();
  if (!parts_touch_ || weak_.empty()) return;
  part_of_weak_.resize(weak_.size());
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    const Index weak = weak_of_point_[scene.body.mesh.cell(c)[0]];
    if (weak >= 0) part_of_weak_[weak] = scene.body.part_of(c);
  }
}

std::vector<std::vector<Vec3>> PieceSupport::held_places(
    const std::vector<Index>& held_by_tools) const {
  std::vector<std::vector<Vec3>> places;
  for (const Weak& weak : weak_) places.push_back(weak.fixed);
  for (const Index p : held_by_tools) {
    if (weak_of_point_[p] >= 0) places[weak_of_point_[p]].push_back(points_[p]);
  }
  return places;
}

std::optional<std::string> PieceSupport::find_loose_pieces(
    const std::vector<std::vector<Vec3>>& held) const {
  std::vector<std::size_t> loose;
  for (std::size_t i = 0; i < weak_.size(); ++i) {
    if (held[i].empty()) loose.push_back(i);
  }
  if (loose.empty()) return std::nullopt;
  std::stable_sort(loose.begin(), loose.end(), [&](std::size_t a, std::size_t b) {
    return weak_[a].piece.volume > weak_[b].piece.volume;
  });
  const bool one = loose.size() == 1;
  std::ostringstream text;
  text << "The body has " << num_pieces_ << " pieces that share no point, and "
       << (one ? "one of them is" : std::to_string(loose.size()) + " of them are") << " not held: ";
  const std::size_t described = std::min(loose.size(), kMostDescribed);
  for (std::size_t i = 0; i < described; ++i) {
    text << (i > 0 ? "; " : "") << describe(weak_[loose[i]].piece);
    if (parts_touch_) text << ", of part " << part_of_weak_[loose[i]] << " (ContactPart)";
  }
  if (described < loose.size()) text << "; and " << loose.size() - described << " smaller";
  const char* it = one ? "it" : "them";
  if (parts_touch_) {
    text << ". Contact alone holds nothing: draw " << it << " to where "
         << (one ? "it lies" : "they lie")
         << " with Springs as Support of Set Boundary, such as 1e3 N/m³ for ligaments or a bed, or "
            "fix some of "
         << it << '.';
    return text.str();
  }
  text << ". Hold " << it << " with Set Boundary, remove " << it
       << " (with the filters Connectivity and Threshold, or SmallestIsland of Tetrahedralize "
          "Label Map), or join what touches with Merge of Set Boundary.";
  return text.str();
}

void PieceSupport::require_held(const std::vector<Index>& held_by_tools) const {
  if (weak_.empty()) return;
  if (const auto loose = find_loose_pieces(held_places(held_by_tools))) throw InputError(*loose);
}

std::optional<std::string> PieceSupport::find_mobile_piece(
    const std::vector<Index>& held_by_tools) const {
  if (weak_.empty()) return std::nullopt;
  const std::vector<std::vector<Vec3>> held = held_places(held_by_tools);
  if (auto loose = find_loose_pieces(held)) return loose;
  for (std::size_t i = 0; i < weak_.size(); ++i) {
    const int spanned = dimension(held[i]);
    if (spanned == 2) continue;
    return "The piece of " + describe(weak_[i].piece) + ' ' + how_it_moves(spanned) +
           ". Fix three points of every connected piece that are not on a line.";
  }
  return std::nullopt;
}

std::optional<std::string> find_mobile_part(const TetMesh& mesh, const std::vector<char>& held) {
  const Pieces parts = find_rigid_parts(mesh);
  if (parts.size() == 1) return std::nullopt;
  // A point that belongs to several parts holds each of them to the rest.
  constexpr Index kNone = -1;
  constexpr Index kSeveral = -2;
  std::vector<Index> part_of_point(mesh.points.size(), kNone);
  const int nodes = nodes_per_cell(mesh.order);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 0; a < nodes; ++a) {
      Index& part = part_of_point[mesh.cell(c)[a]];
      part = part == kNone || part == parts.of_cell[c] ? parts.of_cell[c] : kSeveral;
    }
  }
  std::vector<std::vector<Vec3>> held_of_part(parts.each.size());
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 0; a < nodes; ++a) {
      const Index p = mesh.cell(c)[a];
      if (held[p] == 0 && part_of_point[p] != kSeveral) continue;
      held_of_part[parts.of_cell[c]].push_back(mesh.points[p]);
    }
  }
  for (Index part = 0; part < parts.size(); ++part) {
    const int spanned = dimension(held_of_part[part]);
    if (spanned == 2) continue;
    return "The part of " + describe(parts.each[part]) + ' ' + how_it_moves(spanned) +
           ": it shares no face with the rest. Mesh the body so that its parts share faces, remove "
           "the part, or fix three of its points that are not on a line.";
  }
  return std::nullopt;
}

}  // namespace palpate
