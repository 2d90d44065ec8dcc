// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/touching_pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "mesh/box_tree.h"

namespace palpate {
namespace {

/// Distance below which points coincide, relative to the shortest edge.
constexpr double kCoincident = 1e-3;
/// Two faces lie on each other only if their normals are opposite with at least this cosine.
constexpr double kAgainst = 0.5;

/// The length of the shortest edge of the cells at each point, m [num_points].
std::vector<double> shortest_edges(const TetMesh& mesh) {
  std::vector<double> shortest(mesh.points.size(), std::numeric_limits<double>::infinity());
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    double of_cell = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) {
        of_cell = std::min(of_cell, (mesh.points[cell[a]] - mesh.points[cell[b]]).norm());
      }
    }
    for (int a = 0; a < nodes_per_cell(mesh.order); ++a) {
      shortest[cell[a]] = std::min(shortest[cell[a]], of_cell);
    }
  }
  return shortest;
}

/// Groups of coincident points, at most one point of each piece in a group.
class Groups {
 public:
  explicit Groups(std::vector<Index> piece_of_point)
      : piece_(std::move(piece_of_point)), first_(piece_.size()), members_(piece_.size()) {
    std::iota(first_.begin(), first_.end(), 0);
  }

  /// Joins the groups of two points, unless that would join two points of one piece.
  [[nodiscard]] bool join(Index a, Index b) {
    if (first_[a] == first_[b]) return true;
    Index one = first_[a];
    Index other = first_[b];
    if (other < one) std::swap(one, other);
    const std::vector<Index> added = with_first(other);
    for (const Index p : with_first(one)) {
      for (const Index q : added) {
        if (piece_[p] == piece_[q]) return false;
      }
    }
    for (const Index q : added) first_[q] = one;
    members_[one].insert(members_[one].end(), added.begin(), added.end());
    members_[other].clear();
    return true;
  }

  [[nodiscard]] const std::vector<Index>& first() const { return first_; }

 private:
  [[nodiscard]] std::vector<Index> with_first(Index first) const {
    std::vector<Index> all = members_[first];
    all.push_back(first);
    return all;
  }

  std::vector<Index> piece_;
  /// The first point of the group of each point [num_points].
  std::vector<Index> first_;
  /// For the first point of each group, the other points of it.
  std::vector<std::vector<Index>> members_;
};

struct SurfaceFace {
  /// The corners, then the midside nodes.
  std::vector<Index> nodes;
  Index piece;
  Vec3 normal;
  double shortest_edge;
};

std::vector<SurfaceFace> faces_of(const TetMesh& mesh, const Pieces& pieces) {
  std::vector<Index> cells;
  const std::vector<Index> nodes = boundary_faces(mesh, &cells);
  std::vector<SurfaceFace> faces;
  for (std::size_t f = 0; f < cells.size(); ++f) {
    const Index* face = nodes.data() + f * static_cast<std::size_t>(nodes_per_face(mesh.order));
    const Vec3& a = mesh.points[face[0]];
    const Vec3& b = mesh.points[face[1]];
    const Vec3& c = mesh.points[face[2]];
    faces.push_back({{face, face + nodes_per_face(mesh.order)},
                     pieces.of_cell[cells[f]],
                     (b - a).cross(c - a).normalized(),
                     std::min({(b - a).norm(), (c - b).norm(), (a - c).norm()})});
  }
  return faces;
}

std::vector<Index> merged_nodes(const SurfaceFace& face, const std::vector<Index>& merged) {
  std::vector<Index> nodes = face.nodes;
  for (Index& p : nodes) p = merged[p];
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

class Search {
 public:
  Search(const TetMesh& mesh, const Pieces& pieces)
      : mesh_(mesh),
        piece_of_point_(piece_of_points(mesh, pieces)),
        touches_(pieces.each.size(), 0),
        faces_(faces_of(mesh, pieces)) {}

  TouchingPieces find() {
    TouchingPieces found;
    find_points(found);
    find_faces(found);
    found.num_pieces = static_cast<Index>(std::count(touches_.begin(), touches_.end(), 1));
    return found;
  }

 private:
  void find_points(TouchingPieces& found) {
    const std::vector<double> edge = shortest_edges(mesh_);
    const std::vector<char> on_boundary = boundary_points(mesh_);
    std::vector<Index> points;
    std::vector<BoxTree::Box> boxes;
    for (Index p = 0; p < mesh_.num_points(); ++p) {
      if (on_boundary[p] == 0) continue;
      points.push_back(p);
      boxes.emplace_back(mesh_.points[p]);
    }
    const BoxTree tree(boxes);
    Groups groups(piece_of_point_);
    for (const Index p : points) {
      const double radius = kCoincident * edge[p];
      const BoxTree::Box around(mesh_.points[p].array() - radius, mesh_.points[p].array() + radius);
      tree.for_overlapping(around, [&](Index place) {
        const Index q = points[tree.order()[place]];
        if (piece_of_point_[p] == piece_of_point_[q] || q < p) return;
        const double distance = (mesh_.points[p] - mesh_.points[q]).norm();
        if (distance > kCoincident * std::min(edge[p], edge[q])) return;
        touches_[piece_of_point_[p]] = touches_[piece_of_point_[q]] = 1;
        if (!groups.join(p, q)) ++found.num_of_slits;
      });
    }
    found.merged = groups.first();
    for (Index p = 0; p < mesh_.num_points(); ++p) {
      if (found.merged[p] != p) ++found.num_coincident;
    }
  }

  void find_faces(TouchingPieces& found) {
    std::vector<BoxTree::Box> boxes;
    for (const SurfaceFace& face : faces_) {
      BoxTree::Box& box = boxes.emplace_back();
      for (int a = 0; a < 3; ++a) box.extend(mesh_.points[face.nodes[a]]);
    }
    const BoxTree tree(boxes);
    for (const SurfaceFace& face : faces_) {
      Vec3 centre = Vec3::Zero();
      for (int a = 0; a < 3; ++a) centre += mesh_.points[face.nodes[a]] / 3;
      const double radius = kCoincident * face.shortest_edge;
      const BoxTree::Box around(centre.array() - radius, centre.array() + radius);
      bool lies_on_another = false;
      bool is_matched = false;
      tree.for_overlapping(around, [&](Index place) {
        const SurfaceFace& other = faces_[tree.order()[place]];
        if (other.piece == face.piece || face.normal.dot(other.normal) > -kAgainst) return;
        const Index* corner = other.nodes.data();
        const OnTriangle nearest = nearest_on_triangle(
            mesh_.points[corner[0]], mesh_.points[corner[1]], mesh_.points[corner[2]], centre);
        if (nearest.squared_distance > radius * radius) return;
        touches_[face.piece] = touches_[other.piece] = 1;
        lies_on_another = true;
        is_matched =
            is_matched || merged_nodes(face, found.merged) == merged_nodes(other, found.merged);
      });
      if (lies_on_another && !is_matched) ++found.num_other_faces;
    }
  }

  const TetMesh& mesh_;
  std::vector<Index> piece_of_point_;
  /// Whether each piece touches another one: 1 or 0.
  std::vector<char> touches_;
  std::vector<SurfaceFace> faces_;
};

}  // namespace

TouchingPieces find_touching_pieces(const TetMesh& mesh, const Pieces& pieces) {
  if (pieces.size() > 1) return Search(mesh, pieces).find();
  TouchingPieces none;
  none.merged.resize(mesh.points.size());
  std::iota(none.merged.begin(), none.merged.end(), 0);
  return none;
}

std::optional<std::string> describe(const TouchingPieces& touching, Index num_pieces,
                                    bool are_merged) {
  const auto count = [](Index number, const char* one, const char* several) {
    return std::to_string(number) + (number == 1 ? one : several);
  };
  const bool leaves_some = touching.num_other_faces > 0 || touching.num_of_slits > 0;
  if (touching.num_pieces == 0 || (are_merged && !leaves_some)) return std::nullopt;
  std::ostringstream text;
  text << touching.num_pieces << " of the " << num_pieces
       << " pieces of the body touch without sharing points, and nothing joins them there";
  if (are_merged) text << " but the points that were merged";
  text << ". ";
  if (touching.num_coincident > 0 && !are_merged) {
    text << count(touching.num_coincident, " point coincides", " points coincide")
         << " with one of another piece, which Merge of Set Boundary makes one. ";
  }
  if (touching.num_of_slits > 0) {
    text << count(touching.num_of_slits, " pair of points is", " pairs of points are")
         << " left two, since one point would close a slit in a piece. ";
  }
  if (touching.num_other_faces > 0) {
    text << count(touching.num_other_faces, " face lies", " faces lie")
         << " on faces of another piece that are divided or curved otherwise, which merging does "
            "not join: "
            "mesh the pieces as one body. ";
  }
  text << "Where pieces are meant to be apart, leave them so, or let them touch with Contact of "
          "Set Boundary.";
  return text.str();
}

MergedMesh merge_points(const TetMesh& mesh, const TouchingPieces& touching) {
  MergedMesh merged;
  merged.mesh.order = mesh.order;
  merged.number.resize(mesh.points.size());
  for (Index p = 0; p < mesh.num_points(); ++p) {
    const Index first = touching.merged[p];
    if (first != p) {
      merged.number[p] = merged.number[first];
      continue;
    }
    merged.number[p] = merged.mesh.num_points();
    merged.mesh.points.push_back(mesh.points[p]);
    merged.before.push_back(p);
  }
  merged.mesh.cells.reserve(mesh.cells.size());
  for (const Index p : mesh.cells) merged.mesh.cells.push_back(merged.number[p]);
  if (const std::optional<Index> cell = find_overlap(merged.mesh)) {
    const Vec3& at = mesh.points[mesh.cell(*cell)[0]];
    std::ostringstream text;
    text << "Pieces of the body overlap, so that they cannot be merged: cell " << *cell << " at ("
         << at.x() << ", " << at.y() << ", " << at.z()
         << ") m shares a face with a cell on the same side of it. Remove what is there twice, or "
            "do not "
            "merge.";
    throw InputError(text.str());
  }
  return merged;
}

}  // namespace palpate
