// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/sheet_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "mesh/cell_faces.h"
#include "mesh/pieces.h"
#include "mesh/refinement.h"

namespace palpate {
namespace {

using Corners = std::array<Index, 4>;

constexpr double kDegrees = 180 / M_PI;
/// A cell at the sheet is divided if its longest edge is longer than what is asked for by this.
constexpr double kLonger = 1.25;
/// A point is moved onto the sheet if that divides one of its edges at less than this share.
constexpr double kSnap = 0.3;
/// A move may leave an angle of this many degrees, or of this share of what was there.
constexpr double kLeastAfterMove = 8;
constexpr double kShareAfterMove = 0.6;
/// A point that cannot be moved counts as one of the sheet if its edge is divided at less than
/// this.
constexpr double kBend = 0.15;
/// A point of a wall is moved along it if that takes it off a face by less than this share of the
/// edge along which it moves; how far off it gets counts so many times as much as how far it moves.
constexpr double kOffWall = 0.05;
constexpr double kWeightOfOff = 20;
/// Points of walls are moved off them, by this share of an edge at the most, if that mends a cell
/// with an angle below so many times what is asked for.
constexpr double kMostOffWall = 0.08;
constexpr double kMendWall = 1.5;
/// The mesh follows the sheet so far beyond its border, in edges around.
constexpr double kMargin = 1;
/// An edge does not cross the sheet where that turns away before it is so near, in edges.
constexpr double kBesideSheet = 0.05;
/// The place at which an edge crosses a curved sheet is found by so many secants.
constexpr int kSecants = 4;
/// A cell with an angle below this is improved, degrees, in so many sweeps, and one that would be
/// refused in some more.
constexpr double kGoodAngle = 6;
constexpr int kSweeps = 8;
constexpr int kFurtherSweeps = 12;
/// The most edges that are divided to mend the mesh.
constexpr int kMostRepairs = 50;
/// The most edges of bad cells that are divided.
constexpr int kMostDivisions = 8;
/// The steps of the search for a better place, in edges.
constexpr double kSteps[] = {0.3, 0.15, 0.07, 0.03, 0.01};
/// A place that is so near to the sheet, in spacings, is on it; and the step of a difference.
constexpr double kOnSheet = 1e-9;
constexpr double kDifference = 1e-3;
/// A front that ends within this share of the spacing ends at it.
constexpr double kOnFront = 1e-6;
/// A last strip that is narrower than this share of the spacing joins the one before.
constexpr double kNarrow = 0.3;

/// The least dihedral angle of a cell, degrees; not positive if it has no volume or is inside out.
double least_angle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double volume = (b - a).cross(c - a).dot(d - a);
  if (!(volume > 0)) return -1;
  const Vec3 normals[4] = {(d - b).cross(c - b).normalized(), (c - a).cross(d - a).normalized(),
                           (d - a).cross(b - a).normalized(), (b - a).cross(c - a).normalized()};
  double largest = -1;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) largest = std::max(largest, -normals[i].dot(normals[j]));
  }
  return std::acos(std::clamp(largest, -1.0, 1.0)) * kDegrees;
}

FaceKey key_of(Index a, Index b, Index c) {
  FaceKey face{a, b, c};
  std::sort(face.begin(), face.end());
  return face;
}

std::optional<MeshFault> find_any_fault(const SheetMesh& cut) {
  for (int stage = 1; stage <= cut.num_stages(); ++stage) {
    if (auto fault = find_fault(cut.mesh, cut.faces, stage)) return fault;
  }
  return std::nullopt;
}

class SheetCutter {
 public:
  SheetCutter(const TetMesh& mesh, const std::vector<Index>& regions, const Sheet& sheet,
              const SheetOptions& options)
      : sheet_(sheet), options_(options) {
    take(mesh, regions);
  }

  SheetMesh run();
  /// The mesh with one more point, in the middle of an edge. Call it after run().
  SheetMesh divide_middle(const EdgeKey& edge);
  /// The longest edge of the cell with the least angle.
  [[nodiscard]] EdgeKey longest_edge_of_worst() const;

 private:
  void take(const TetMesh& mesh, const std::vector<Index>& regions);
  /// Halves edges that the sheet crosses until they are short enough.
  void refine_near();
  void find_neighbours();
  void find_walls();
  void add_wall(const FaceKey& face);
  void add_sheet_face(const FaceKey& face);
  void find_heights();
  void move_onto_sheet();
  void divide_at_sheet();
  void find_sheet_faces();
  void fit_fronts();
  /// Moves points around cells with an angle below this, degrees.
  void improve(double good_angle);
  /// Whether a point of a wall would be too far off it at a place.
  [[nodiscard]] bool leaves_wall(Index point, const Vec3& place);
  SheetMesh finish();

  /// The share of the way from a to b at which an edge crosses the sheet; negative: it does not,
  /// or too far beyond the border.
  [[nodiscard]] double crossing(Index a, Index b) const;
  /// How far a point of a wall leaves that on a share of the way to another one, in ways.
  [[nodiscard]] double off_wall(Index point, Index other, double share) const;
  /// The least angle of the cells around a point if it were somewhere else.
  [[nodiscard]] double angle_around(Index point, const Vec3& place) const;
  /// Moves a point if the cells around it keep a good shape.
  bool move(Index point, const Vec3& place);
  /// Whether all points of a cell would be on the sheet if one more was.
  [[nodiscard]] bool would_flatten(Index point) const;
  /// Divides an edge and all cells around it. @returns The new point.
  Index divide(Index a, Index b, const Vec3& place);
  [[nodiscard]] std::vector<EdgeKey> all_edges() const;
  [[nodiscard]] double longest_edge(Index point) const;
  void sort_by_length(std::vector<EdgeKey>& edges) const;
  /// Where the sheet is above a place that shall be on it.
  [[nodiscard]] Vec3 onto_sheet(Vec3 place) const;
  [[nodiscard]] Vec3 onto_front(Vec3 place, double front) const;

  const Sheet& sheet_;
  const SheetOptions& options_;
  std::vector<Vec3> points_;
  std::vector<Corners> cells_;
  std::vector<Index> parents_;
  std::vector<Index> regions_;
  std::vector<std::vector<Index>> cells_of_;
  /// 1 for points on the surface of the body or on a wall, and their edges.
  std::vector<char> on_wall_;
  std::set<FaceKey> walls_;
  std::set<EdgeKey> wall_edges_;
  std::vector<std::vector<Vec3>> wall_normals_;
  /// Where points of walls were before they were moved off it.
  std::map<Index, Vec3> homes_;
  /// 0 for the points on the sheet.
  std::vector<double> heights_;
  std::vector<double> front_of_;
  std::set<FaceKey> sheet_faces_;
  std::set<EdgeKey> sheet_edges_;
  std::vector<char> on_sheet_;
  std::vector<char> on_front_;
  std::vector<double> fronts_;
};

void SheetCutter::take(const TetMesh& mesh, const std::vector<Index>& regions) {
  points_ = mesh.points;
  cells_.clear();
  parents_.clear();
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    cells_.push_back({cell[0], cell[1], cell[2], cell[3]});
    parents_.push_back(c);
  }
  regions_ = regions.empty() ? std::vector<Index>(cells_.size(), 0) : regions;
}

void SheetCutter::refine_near() {
  if (options_.edge <= 0) return;
  for (;;) {
    std::vector<char> chosen(cells_.size(), 0);
    bool any = false;
    find_heights();
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      double longest = 0;
      double low = std::numeric_limits<double>::infinity();
      double high = -low;
      Vec3 middle = Vec3::Zero();
      for (const auto& [m, n] : kTetEdges) {
        longest = std::max(longest, (points_[cells_[c][m]] - points_[cells_[c][n]]).norm());
      }
      for (const Index point : cells_[c]) {
        low = std::min(low, heights_[point]);
        high = std::max(high, heights_[point]);
        middle += 0.25 * points_[point];
      }
      if (longest <= kLonger * options_.edge || low > 0 || high < 0 ||
          sheet_.at(middle).beyond > longest) {
        continue;
      }
      chosen[c] = 1;
      any = true;
    }
    if (!any) return;
    TetMesh mesh;
    mesh.points = points_;
    for (const Corners& cell : cells_)
      mesh.cells.insert(mesh.cells.end(), cell.begin(), cell.end());
    const Refinement finer = refine(mesh, chosen);
    std::vector<Index> parents;
    std::vector<Index> regions;
    for (const Index parent : finer.parents) {
      parents.push_back(parents_[parent]);
      regions.push_back(regions_[parent]);
    }
    take(finer.mesh, regions);
    parents_ = std::move(parents);
  }
}

void SheetCutter::find_neighbours() {
  cells_of_.assign(points_.size(), {});
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    for (const Index p : cells_[c]) cells_of_[p].push_back(static_cast<Index>(c));
  }
}

void SheetCutter::find_walls() {
  struct Side {
    FaceKey face;
    Index region;
  };
  std::vector<Side> sides;
  sides.reserve(4 * cells_.size());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    for (int k = 0; k < 4; ++k) sides.push_back({face_opposite(cells_[c].data(), k), regions_[c]});
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.face < b.face; });
  on_wall_.assign(points_.size(), 0);
  wall_normals_.assign(points_.size(), {});
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const bool has_other = i + 1 < sides.size() && sides[i + 1].face == sides[i].face;
    if (!has_other || sides[i + 1].region != sides[i].region) add_wall(sides[i].face);
    if (has_other) ++i;
  }
}

void SheetCutter::add_wall(const FaceKey& face) {
  const auto& [a, b, c] = face;
  walls_.insert(face);
  wall_edges_.insert({{a, b}, {b, c}, {a, c}});
  const Vec3 normal = (points_[b] - points_[a]).cross(points_[c] - points_[a]).normalized();
  for (const Index p : face) {
    on_wall_[p] = 1;
    wall_normals_[p].push_back(normal);
  }
}

void SheetCutter::add_sheet_face(const FaceKey& face) {
  const auto& [a, b, c] = face;
  sheet_faces_.insert(face);
  sheet_edges_.insert({{a, b}, {b, c}, {a, c}});
  for (const Index p : face) on_sheet_[p] = 1;
}

void SheetCutter::find_heights() {
  heights_.resize(points_.size());
  front_of_.resize(points_.size());
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Sheet::Place at = sheet_.at(points_[p]);
    heights_[p] = at.height;
    front_of_[p] = at.front;
  }
}

double SheetCutter::crossing(Index a, Index b) const {
  if (!(heights_[a] * heights_[b] < 0)) return -1;
  const Vec3 way = points_[b] - points_[a];
  double low = 0;
  double high = 1;
  double of_low = heights_[a];
  double of_high = heights_[b];
  double share = 0;
  Sheet::Place at;
  for (int i = 0; i < kSecants; ++i) {
    share = low + (high - low) * of_low / (of_low - of_high);
    at = sheet_.at(points_[a] + share * way);
    if (at.height * of_low > 0) {
      low = share;
      of_low = at.height;
    } else {
      high = share;
      of_high = at.height;
    }
    if (!(of_low * of_high < 0)) break;
  }
  const double length = way.norm();
  // Where the sheet bends away, the signs of two far points say nothing.
  if (std::abs(at.height) > kBesideSheet * length) return -1;
  const auto margin = [&] { return kMargin * std::max(longest_edge(a), longest_edge(b)); };
  if (at.beyond > 0 && at.beyond > margin()) return -1;
  return share;
}

double SheetCutter::off_wall(Index point, Index other, double share) const {
  const Vec3 way = (points_[other] - points_[point]).normalized();
  double most = 0;
  for (const Vec3& normal : wall_normals_[point]) most = std::max(most, std::abs(normal.dot(way)));
  return share * most;
}

double SheetCutter::angle_around(Index point, const Vec3& place) const {
  double least = 180;
  for (const Index c : cells_of_[point]) {
    Vec3 x[4];
    for (int k = 0; k < 4; ++k) x[k] = cells_[c][k] == point ? place : points_[cells_[c][k]];
    least = std::min(least, least_angle(x[0], x[1], x[2], x[3]));
    if (least <= 0) return least;
  }
  return least;
}

bool SheetCutter::move(Index point, const Vec3& place) {
  const double before = angle_around(point, points_[point]);
  const double after = angle_around(point, place);
  if (after < std::min(kLeastAfterMove, kShareAfterMove * before)) return false;
  points_[point] = place;
  return true;
}

Vec3 SheetCutter::onto_sheet(Vec3 place) const {
  for (int i = 0; i < kSecants; ++i) {
    const Sheet::Place at = sheet_.at(place);
    place = at.foot;
    if (std::abs(at.height) < kOnSheet * options_.spacing) break;
  }
  return place;
}

Vec3 SheetCutter::onto_front(Vec3 place, double front) const {
  const double step = kDifference * options_.spacing;
  for (int i = 0; i < kSecants; ++i) {
    place = onto_sheet(place);
    const double missing = front - sheet_.at(place).front;
    if (std::abs(missing) < kOnSheet * options_.spacing) break;
    Vec3 gradient;
    for (int k = 0; k < 3; ++k) {
      const Vec3 way = step * Vec3::Unit(k);
      gradient[k] = (sheet_.at(place + way).front - sheet_.at(place - way).front) / (2 * step);
    }
    if (gradient.isZero(0)) break;
    place += missing / gradient.squaredNorm() * gradient;
  }
  return place;
}

std::vector<EdgeKey> SheetCutter::all_edges() const {
  std::vector<EdgeKey> edges;
  edges.reserve(6 * cells_.size());
  for (const Corners& cell : cells_) {
    for (const auto& [a, b] : kTetEdges) edges.push_back(edge_of(cell[a], cell[b]));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

void SheetCutter::move_onto_sheet() {
  struct Candidate {
    double cost;
    double share;
    Index point;
    Index other;
  };
  std::vector<Candidate> candidates;
  for (const auto& [a, b] : all_edges()) {
    const double share = crossing(a, b);
    if (share < 0) continue;
    const bool is_wall_edge = wall_edges_.count({a, b}) != 0;
    const auto limit = [&](Index p) { return on_wall_[p] == 0 || is_wall_edge ? kSnap : kBend; };
    const auto add = [&](double way, Index from, Index to) {
      if (way >= limit(from)) return;
      candidates.push_back({way + kWeightOfOff * off_wall(from, to, way), way, from, to});
    };
    add(share, a, b);
    add(1 - share, b, a);
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::pair(a.cost, a.point) < std::pair(b.cost, b.point);
  });
  for (const auto& [cost, share, point, other] : candidates) {
    if (heights_[point] == 0 || would_flatten(point)) continue;
    bool is_moved = false;
    if (on_wall_[point] == 0) {
      is_moved = move(point, onto_sheet(points_[point]));
    } else if (wall_edges_.count(edge_of(point, other)) != 0 &&
               off_wall(point, other, share) <= kOffWall) {
      // The other point may have moved meanwhile.
      const double now = crossing(point, other);
      is_moved = now >= 0 && now < 0.5 &&
                 move(point, points_[point] + now * (points_[other] - points_[point]));
    }
    // Otherwise the sheet bends to a point that is near enough.
    if (!is_moved && share >= kBend) continue;
    heights_[point] = 0;
    front_of_[point] = sheet_.at(points_[point]).front;
  }
}

bool SheetCutter::would_flatten(Index point) const {
  for (const Index c : cells_of_[point]) {
    int num_on = 0;
    for (const Index p : cells_[c]) num_on += p != point && heights_[p] == 0 ? 1 : 0;
    if (num_on == 3) return true;
  }
  return false;
}

Index SheetCutter::divide(Index a, Index b, const Vec3& place) {
  const auto point = static_cast<Index>(points_.size());
  points_.push_back(place);
  heights_.push_back(0);
  front_of_.push_back(sheet_.at(place).front);
  cells_of_.emplace_back();
  on_wall_.push_back(0);
  wall_normals_.emplace_back();
  on_sheet_.push_back(0);
  on_front_.push_back(0);
  std::set<Index> opposite;
  const std::vector<Index> around = cells_of_[a];
  for (const Index c : around) {
    Corners& cell = cells_[c];
    if (std::find(cell.begin(), cell.end(), b) == cell.end()) continue;
    const auto added = static_cast<Index>(cells_.size());
    for (const Index p : cell) {
      if (p != a && p != b) opposite.insert(p);
    }
    Corners other = cell;
    std::replace(cell.begin(), cell.end(), b, point);
    std::replace(other.begin(), other.end(), a, point);
    auto& of_b = cells_of_[b];
    of_b.erase(std::find(of_b.begin(), of_b.end(), c));
    for (const Index p : other) cells_of_[p].push_back(added);
    cells_of_[point].push_back(c);
    cells_.push_back(other);
    parents_.push_back(parents_[c]);
    regions_.push_back(regions_[c]);
  }
  for (const Index p : opposite) {
    const FaceKey face = key_of(a, b, p);
    const FaceKey parts[2] = {key_of(a, point, p), key_of(point, b, p)};
    if (walls_.erase(face) != 0) {
      for (const FaceKey& part : parts) add_wall(part);
    }
    if (sheet_faces_.erase(face) != 0) {
      for (const FaceKey& part : parts) add_sheet_face(part);
    }
  }
  wall_edges_.erase(edge_of(a, b));
  sheet_edges_.erase(edge_of(a, b));
  return point;
}

void SheetCutter::sort_by_length(std::vector<EdgeKey>& edges) const {
  std::sort(edges.begin(), edges.end(), [&](const EdgeKey& e, const EdgeKey& f) {
    const double a = (points_[e.first] - points_[e.second]).squaredNorm();
    const double b = (points_[f.first] - points_[f.second]).squaredNorm();
    return a != b ? a > b : e < f;
  });
}

void SheetCutter::divide_at_sheet() {
  std::vector<EdgeKey> crossed;
  std::map<EdgeKey, double> shares;
  for (const EdgeKey& edge : all_edges()) {
    const double share = crossing(edge.first, edge.second);
    if (share < 0) continue;
    shares[edge] = share;
    crossed.push_back(edge);
  }
  sort_by_length(crossed);
  for (const EdgeKey& edge : crossed) {
    const auto& [a, b] = edge;
    divide(a, b, points_[a] + shares[edge] * (points_[b] - points_[a]));
  }
}

void SheetCutter::find_sheet_faces() {
  // A face of three points on the sheet is on it if one cell is in front of it and one behind.
  std::map<FaceKey, std::array<int, 2>> sides;
  for (const Corners& cell : cells_) {
    int num_on = 0;
    double side = 0;
    for (const Index p : cell) {
      if (heights_[p] == 0) {
        ++num_on;
      } else {
        side = heights_[p];
      }
    }
    if (num_on != 3) continue;
    FaceKey face{};
    int next = 0;
    for (const Index p : cell) {
      if (heights_[p] == 0) face[next++] = p;
    }
    std::sort(face.begin(), face.end());
    ++sides[face][side > 0 ? 0 : 1];
  }
  for (const auto& [face, count] : sides) {
    if (count[0] != 1 || count[1] != 1) continue;
    // Points may be in the plane of the sheet far from it.
    const auto& [a, b, c] = face;
    const double size = std::max({longest_edge(a), longest_edge(b), longest_edge(c)});
    const Vec3 middle = (points_[a] + points_[b] + points_[c]) / 3;
    if (sheet_.at(middle).beyond <= kMargin * size) add_sheet_face(face);
  }
}

void SheetCutter::fit_fronts() {
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    if (on_sheet_[p] == 0 || sheet_.at(points_[p]).beyond > 0) continue;
    first = std::min(first, front_of_[p]);
    last = std::max(last, front_of_[p]);
  }
  if (first > last) {
    throw InputError("The sheet does not meet the body. Move it, or check its unit of length.");
  }
  // The sheet ends inside the body, or where it leaves it.
  last = std::min(sheet_.last_front(), last + options_.spacing);
  fronts_.assign(1, first);
  while (fronts_.back() + (1 + kNarrow) * options_.spacing < last) {
    fronts_.push_back(fronts_.back() + options_.spacing);
  }
  fronts_.push_back(last);
  for (std::size_t j = 1; j < fronts_.size(); ++j) {
    const double front = fronts_[j];
    const auto share_of = [&](const EdgeKey& edge) {
      const double a = front_of_[edge.first] - front;
      const double b = front_of_[edge.second] - front;
      return a * b < 0 ? a / (a - b) : -1;
    };
    // Points that are near enough move along the sheet; those of the surface along an edge of both.
    std::vector<std::pair<double, EdgeKey>> near;
    for (const EdgeKey& edge : sheet_edges_) {
      const double share = share_of(edge);
      if (share < 0) continue;
      if (share < kSnap) near.push_back({share, edge});
      if (1 - share < kSnap) near.push_back({1 - share, {edge.second, edge.first}});
    }
    std::sort(near.begin(), near.end());
    for (const auto& [unused, edge] : near) {
      const auto& [point, other] = edge;
      const double share = share_of(edge);
      if (share < 0 || share > 0.5 || on_front_[point] != 0) continue;
      if (on_wall_[point] != 0 && (wall_edges_.count(edge_of(point, other)) == 0 ||
                                   off_wall(point, other, share) > kOffWall)) {
        continue;
      }
      Vec3 place = points_[point] + share * (points_[other] - points_[point]);
      if (on_wall_[point] == 0) place = onto_sheet(place);
      if (!move(point, place)) continue;
      front_of_[point] = front;
      on_front_[point] = 1;
    }
    std::vector<EdgeKey> crossed;
    for (const EdgeKey& edge : sheet_edges_) {
      if (share_of(edge) >= 0) crossed.push_back(edge);
    }
    sort_by_length(crossed);
    for (const EdgeKey& edge : crossed) {
      const double share = share_of(edge);
      const Vec3 place = points_[edge.first] + share * (points_[edge.second] - points_[edge.first]);
      const Index point = divide(edge.first, edge.second, place);
      front_of_[point] = front;
      on_front_[point] = 1;
    }
  }
}

double SheetCutter::longest_edge(Index point) const {
  double longest = 0;
  for (const Index c : cells_of_[point]) {
    for (const Index p : cells_[c])
      longest = std::max(longest, (points_[p] - points_[point]).norm());
  }
  return longest;
}

void SheetCutter::improve(double good_angle) {
  constexpr int kAxes[13][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1}, {1, 1, 0},  {1, -1, 0},
                                {1, 0, 1},  {1, 0, -1}, {0, 1, 1}, {0, 1, -1}, {1, 1, 1},
                                {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};
  for (int sweep = 0; sweep < kSweeps + kFurtherSweeps; ++sweep) {
    if (sweep >= kSweeps) good_angle = std::min(good_angle, kMendWall * options_.least_angle);
    // Other directions in each sweep.
    const Eigen::AngleAxisd turn(sweep, Vec3(1, 2, 3).normalized());
    std::vector<std::pair<double, Index>> bad;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      const auto& [a, b, d, e] = cells_[c];
      const double angle = least_angle(points_[a], points_[b], points_[d], points_[e]);
      if (angle < good_angle) bad.push_back({angle, static_cast<Index>(c)});
    }
    std::sort(bad.begin(), bad.end());
    bool any = false;
    for (const auto& [angle, c] : bad) {
      for (const Index p : cells_[c]) {
        if (on_wall_[p] != 0 && angle >= kMendWall * options_.least_angle) continue;
        double best = angle_around(p, points_[p]);
        const double length = longest_edge(p);
        for (const double step : kSteps) {
          Vec3 found = points_[p];
          bool is_better = false;
          for (const auto& axis : kAxes) {
            for (const double sign : {1.0, -1.0}) {
              const Vec3 way = sign * (turn * Vec3(axis[0], axis[1], axis[2]).normalized());
              Vec3 place = points_[p] + step * length * way;
              if (on_front_[p] != 0) {
                place = onto_front(place, front_of_[p]);
              } else if (on_sheet_[p] != 0) {
                place = onto_sheet(place);
              }
              if (leaves_wall(p, place)) continue;
              const double now = angle_around(p, place);
              if (now <= best) continue;
              best = now;
              found = place;
              is_better = true;
            }
          }
          if (is_better) {
            points_[p] = found;
            any = true;
          }
        }
        if (on_sheet_[p] != 0 && on_front_[p] == 0) front_of_[p] = sheet_.at(points_[p]).front;
      }
    }
    if (!any) return;
  }
}

bool SheetCutter::leaves_wall(Index point, const Vec3& place) {
  if (on_wall_[point] == 0) return false;
  const Vec3 way = place - homes_.emplace(point, points_[point]).first->second;
  const double most = kMostOffWall * longest_edge(point);
  const auto& normals = wall_normals_[point];
  return std::any_of(normals.begin(), normals.end(),
                     [&](const Vec3& normal) { return std::abs(normal.dot(way)) > most; });
}

SheetMesh SheetCutter::finish() {
  SheetMesh result;
  result.mesh.points = points_;
  for (const Corners& cell : cells_) {
    result.mesh.cells.insert(result.mesh.cells.end(), cell.begin(), cell.end());
  }
  result.parents = parents_;
  result.fronts = fronts_;
  result.areas.assign(fronts_.size(), 0);
  std::map<FaceKey, std::int32_t> stages;
  const double tolerance = kOnFront * options_.spacing;
  for (const FaceKey& face : sheet_faces_) {
    const auto& [a, b, c] = face;
    const Vec3 middle = (points_[a] + points_[b] + points_[c]) / 3;
    const double size = (points_[b] - points_[a]).norm();
    // The middle of a face of a curved sheet is a little beside it.
    if (sheet_.at(middle).beyond > kOnFront * size) continue;
    const double front = (front_of_[a] + front_of_[b] + front_of_[c]) / 3;
    if (front > fronts_.back() + tolerance) continue;
    const auto next = std::upper_bound(fronts_.begin(), fronts_.end(), front);
    const auto stage = std::clamp<std::ptrdiff_t>(next - fronts_.begin(), 1,
                                                  static_cast<std::ptrdiff_t>(fronts_.size()) - 1);
    stages.emplace(face, static_cast<std::int32_t>(stage));
    result.areas[stage] += 0.5 * (points_[b] - points_[a]).cross(points_[c] - points_[a]).norm();
  }
  for (std::size_t j = 1; j < result.areas.size(); ++j) result.areas[j] += result.areas[j - 1];
  for (const Corners& cell : cells_) {
    OpenedFaces faces{};
    for (int k = 0; k < 4; ++k) {
      const FaceKey face = face_opposite(cell.data(), k);
      const auto found = stages.find(face);
      faces[k] = found == stages.end() ? 0 : found->second;
    }
    result.faces.push_back(faces);
  }
  result.least_angle = least_dihedral_angle(result.mesh);
  return result;
}

SheetMesh SheetCutter::run() {
  refine_near();
  find_neighbours();
  find_walls();
  find_heights();
  on_sheet_.assign(points_.size(), 0);
  on_front_.assign(points_.size(), 0);
  move_onto_sheet();
  divide_at_sheet();
  find_sheet_faces();
  fit_fronts();
  improve(kGoodAngle);
  return finish();
}

SheetMesh SheetCutter::divide_middle(const EdgeKey& edge) {
  const auto& [a, b] = edge;
  const Index point = divide(a, b, 0.5 * (points_[a] + points_[b]));
  if (on_front_[a] != 0 && on_front_[b] != 0 && front_of_[a] == front_of_[b]) {
    on_front_[point] = 1;
    front_of_[point] = front_of_[a];
  }
  improve(kMendWall * options_.least_angle);
  return finish();
}

EdgeKey SheetCutter::longest_edge_of_worst() const {
  const auto angle = [&](const Corners& cell) {
    return least_angle(points_[cell[0]], points_[cell[1]], points_[cell[2]], points_[cell[3]]);
  };
  const Corners& worst =
      *std::min_element(cells_.begin(), cells_.end(),
                        [&](const Corners& a, const Corners& b) { return angle(a) < angle(b); });
  std::vector<EdgeKey> edges;
  for (const auto& [a, b] : kTetEdges) edges.push_back(edge_of(worst[a], worst[b]));
  sort_by_length(edges);
  return edges.front();
}

/// @throws InputError a part falls off.
void require_one_piece(const TetMesh& before, const SheetMesh& cut) {
  const Index num_parts = find_rigid_parts(before).size();
  const auto parts_at = [&](int stage) {
    return find_rigid_parts(open_mesh(cut.mesh, cut.faces, stage).mesh);
  };
  if (parts_at(cut.num_stages()).size() == num_parts) return;
  int stage = 1;
  while (parts_at(stage).size() == num_parts) ++stage;
  const std::vector<Piece> parts = parts_at(stage).each;
  const Piece& smallest =
      *std::min_element(parts.begin(), parts.end(),
                        [](const Piece& a, const Piece& b) { return a.volume < b.volume; });
  throw InputError("The cut severs the body when it has come " +
                   quantity(cut.fronts[stage] - cut.fronts[0], "m") + " far: " +
                   describe(smallest) + " would fall off. Let the sheet end inside the body.");
}

}  // namespace

double least_dihedral_angle(const TetMesh& mesh) {
  double least = 180;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    least = std::min(least, least_angle(mesh.points[cell[0]], mesh.points[cell[1]],
                                        mesh.points[cell[2]], mesh.points[cell[3]]));
  }
  return least;
}

SheetMesh put_sheet(const TetMesh& mesh, const std::vector<Index>& regions, const Sheet& sheet,
                    const SheetOptions& options) {
  SheetCutter cutter(mesh, regions, sheet, options);
  SheetMesh result = cutter.run();
  // An edge that opens between two points that do not is the only one there: it needs a third.
  std::optional<MeshFault> fault = find_any_fault(result);
  for (int i = 0; i < kMostRepairs && fault && fault->edge; ++i) {
    result = cutter.divide_middle(*fault->edge);
    fault = find_any_fault(result);
  }
  if (result.areas.back() == 0) {
    throw InputError(
        "The sheet opens no face of the body: it ends before its first front. Move it "
        "deeper into the body, or make its edges shorter.");
  }
  require_one_piece(mesh, result);
  // A point in a bad cell can be moved where its corners cannot.
  const double least = std::min(options.least_angle, least_dihedral_angle(mesh));
  for (int i = 0; i < kMostDivisions && !fault && result.least_angle < least; ++i) {
    SheetMesh divided = cutter.divide_middle(cutter.longest_edge_of_worst());
    if (find_any_fault(divided)) break;
    result = std::move(divided);
  }
  if (fault) {
    throw InputError("The sheet does not fit the mesh: " + fault->text +
                     ". Move the sheet a little, or make cells smaller near it.");
  }
  if (result.least_angle < least) {
    throw InputError("The sheet leaves a cell with an angle of " +
                     std::to_string(result.least_angle) +
                     " degrees. Move the sheet a little, or make cells smaller near it.");
  }
  return result;
}

}  // namespace palpate
