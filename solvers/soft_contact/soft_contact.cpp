// SPDX-License-Identifier: BSD-3-Clause
#include "soft_contact/soft_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/quantity.h"
#include "mesh/box_tree.h"
#include "mesh/surface_tree.h"
#include "soft_contact/contact_defaults.h"

namespace palpate {
namespace {

/// ρ in thicknesses of the layer, and at least in distances of points.
constexpr double kReachOfThickness = 2;
constexpr double kReachOfSpacing = 2.8;
/// The distance of points, in thicknesses and at least in mean edges of the surface.
constexpr double kSpacing = 0.7;
constexpr double kSpacingOfEdge = 1 / 7.5;
/// −n_i · n_j from which on two points face each other fully.
constexpr double kFacing = 0.5;
/// S₀ as a share of S beside a plane.
constexpr double kLeastCover = 0.05;
/// S in S₀ up to which there is no contact.
constexpr double kNoCover = 0.01;
/// A point sees enough of the other side, in S₀, to know that it is too deep inside. At the depth
/// ρ/2 a plane has 4.7, and half of a plane half of that.
constexpr double kSeen = 2;
/// Points of one part are on two sides of it, and do not touch, if at rest they are within so many
/// ρ and one is behind the surface at the other by this share of their distance.
constexpr double kSameNeighbourhood = 2;
constexpr double kBehind = 0.1;
/// How far beyond ρ neighbours are searched for, in ρ.
constexpr double kMargin = 0.5;
/// No point of a face moves by more than this times its farthest node: Σ |N_a| ≤ 5/3.
constexpr double kNodeToPoint = 5.0 / 3;

/// The share of a motion across the normal of a face that may be along the normal elsewhere in it.
constexpr double kAcrossNormals = 0.25;

/// A step from 0 to 1 with three derivatives that are continuous, t⁴ (35 − 84 t + 70 t² − 20 t³).
struct Step {
  double value, slope, curvature;
};

Step smooth_step(double t) {
  if (t <= 0) return {0, 0, 0};
  if (t >= 1) return {1, 0, 0};
  const double r = 1 - t;
  const double t3 = t * t * t;
  return {t3 * t * (35 + t * (-84 + t * (70 - 20 * t))), 140 * t3 * r * r * r,
          420 * t * t * r * r * (1 - 2 * t)};
}

BoxTree::Box inflated(BoxTree::Box box, double by) {
  box.min().array() -= by;
  box.max().array() += by;
  return box;
}

/// The share of a step after which two boxes that are moved may meet; nothing: they do not.
/// @param way_a, way_b The boxes of how far the points of a box are moved.
std::optional<double> first_meeting(const BoxTree::Box& a, const BoxTree::Box& way_a,
                                    const BoxTree::Box& b, const BoxTree::Box& way_b) {
  double first = 0;
  for (int k = 0; k < 3; ++k) {
    // What is between them on either side, and how fast that becomes less.
    const double gaps[2] = {b.min()[k] - a.max()[k], a.min()[k] - b.max()[k]};
    const double rates[2] = {way_a.max()[k] - way_b.min()[k], way_b.max()[k] - way_a.min()[k]};
    for (int side = 0; side < 2; ++side) {
      if (gaps[side] <= 0) continue;
      if (rates[side] <= 0) return std::nullopt;
      first = std::max(first, gaps[side] / rates[side]);
    }
  }
  if (first > 1) return std::nullopt;
  return first;
}

/// @throws InputError a corner of one part is inside another part by more than the thickness.
void require_apart(const Body& body, double thickness) {
  std::vector<Index> cells;
  const std::vector<Index> faces = boundary_faces(body.mesh, &cells);
  const auto per_face = static_cast<std::size_t>(nodes_per_face(body.mesh.order));
  std::map<Index, std::vector<std::array<Index, 3>>> triangles;
  for (std::size_t f = 0; f < cells.size(); ++f) {
    const Index* face = &faces[f * per_face];
    triangles[body.part_of(cells[f])].push_back({face[0], face[1], face[2]});
  }
  if (triangles.size() < 2) return;
  double deepest = thickness;
  std::optional<Vec3> place;
  for (const auto& [part, own] : triangles) {
    const SurfaceTree surface(body.mesh.points, own);
    const BoxTree::Box box = surface.bounds();
    for (const auto& [other, theirs] : triangles) {
      if (other == part) continue;
      for (const auto& triangle : theirs) {
        for (const Index corner : triangle) {
          const Vec3& point = body.mesh.points[corner];
          if (!box.contains(point)) continue;
          const double depth = -surface.nearest(point).distance;
          if (depth <= deepest) continue;
          deepest = depth;
          place = point;
        }
      }
    }
  }
  if (!place) return;
  throw InputError("Two parts that touch each other overlap by " + quantity(deepest, "m") + " at " +
                   quantity(*place, "m") +
                   " before anything moves. Move them apart, or mesh them so that they do not "
                   "overlap.");
}

double spacing_for(const Scene& scene) {
  return std::max(kSpacing * scene.organ.contact.thickness,
                  kSpacingOfEdge * mean_surface_edge(scene.body.mesh));
}

}  // namespace

/// The faces that have others in reach are numbered; so are their points, face by face.
struct SoftContact::Neighbours {
  struct Other {
    /// The number of a point.
    std::uint32_t point;
    /// The place of its face among the other faces of this one.
    std::uint32_t slot;
  };

  /// The places of the nodes for which this was found, as displacements, m.
  NodalVector reference;
  std::vector<Index> faces;
  /// The number of the first point of each face [faces + 1].
  std::vector<std::uint32_t> first_point;
  /// Where the others of each point begin [points + 1].
  std::vector<std::size_t> first_other;
  std::vector<Other> others;

  /// The nodes of a face, followed by those of its other faces, each once.
  struct Local {
    std::vector<Index> nodes;
    /// The places of the nodes of each other face in `nodes` [slots × nodes per face].
    std::vector<std::uint16_t> of_slots;
    /// The place of each two of `nodes`, a ≥ b, among the pairs [n (n + 1) / 2]; empty before
    /// name_pairs().
    std::vector<Index> pairs;
  };
  std::vector<Local> local;
  /// The pairs of nodes that the faces couple, ascending; empty before name_pairs().
  std::vector<PointPair> pairs;

  void name_pairs();
};

/// A numbered point in a state.
struct SoftContact::NearPoint : PointFeatures {
  Index point;
  double area;
};

SoftContact::SoftContact(const Scene& scene) : SoftContact(scene, spacing_for(scene)) {}

SoftContact::SoftContact(const Scene& scene, double spacing)
    : points_(scene.body, spacing),
      with_themselves_(scene.organ.touching == TouchingParts::all),
      law_(scene.organ.contact),
      reach_(std::max(kReachOfThickness * law_.thickness, kReachOfSpacing * spacing)),
      least_sum_(kLeastCover * M_PI * reach_ * reach_ / 5),
      offsets_(static_cast<std::size_t>(points_.num_points()), 0.0) {
  validate(law_);
  require_apart(scene.body, law_.thickness);
  if (with_themselves_) {
    const NodalVector none = NodalVector::Zero(3 * Eigen::Index{scene.body.mesh.num_points()});
    rest_.reserve(offsets_.size());
    for (Index p = 0; p < points_.num_points(); ++p) rest_.push_back(points_.features(p, none));
  }
  set_offsets();
}

SoftContact::~SoftContact() = default;

bool SoftContact::may_touch(Index face, Index other) const {
  if (face == other || (points_.is_fixed(face) && points_.is_fixed(other))) return false;
  return with_themselves_ || points_.part(face) != points_.part(other);
}

void SoftContact::Neighbours::name_pairs() {
  if (!pairs.empty()) return;
  const auto key = [](Index a, Index b) {
    const auto [low, high] = std::minmax(a, b);
    return static_cast<std::uint64_t>(low) << 32U | static_cast<std::uint64_t>(high);
  };
  std::vector<std::uint64_t> keys;
  for (const Local& each : local) {
    for (std::size_t a = 0; a < each.nodes.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) keys.push_back(key(each.nodes[a], each.nodes[b]));
    }
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  pairs.reserve(keys.size());
  for (const std::uint64_t each : keys) {
    pairs.push_back({static_cast<Index>(each >> 32U), static_cast<Index>(each & 0xffffffffU)});
  }
  for (Local& each : local) {
    for (std::size_t a = 0; a < each.nodes.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const auto at =
            std::lower_bound(keys.begin(), keys.end(), key(each.nodes[a], each.nodes[b]));
        each.pairs.push_back(static_cast<Index>(at - keys.begin()));
      }
    }
  }
}

std::unique_ptr<SoftContact::Neighbours> SoftContact::find_neighbours(
    const NodalVector& state) const {
  auto found = std::make_unique<Neighbours>();
  found->reference = state;
  const double reach = (1 + kMargin) * reach_;
  const Index num_faces = points_.num_faces();
  std::vector<Vec3> places;
  places.reserve(static_cast<std::size_t>(points_.num_points()));
  std::vector<BoxTree::Box> boxes(static_cast<std::size_t>(num_faces));
  for (Index f = 0; f < num_faces; ++f) {
    for (Index p = points_.first_point(f); p < points_.first_point(f + 1); ++p) {
      places.push_back(points_.features(p, state).place);
      boxes[f].extend(places.back());
    }
  }
  const BoxTree tree(boxes);
  // Point by point, face by face; faces without others are left out afterwards.
  std::vector<std::vector<Index>> others_of_face(boxes.size());
  for (Index f = 0; f < num_faces; ++f) {
    const BoxTree::Box box = inflated(boxes[f], reach);
    tree.for_overlapping(box, [&](Index place) {
      const Index other = tree.order()[place];
      if (may_touch(f, other) && box.intersects(boxes[other])) {
        others_of_face[f].push_back(other);
      }
    });
    std::sort(others_of_face[f].begin(), others_of_face[f].end());
  }
  // The others are points of the surface until all that are felt are numbered.
  std::vector<Neighbours::Other>& others = found->others;
  std::vector<std::uint32_t> number(static_cast<std::size_t>(points_.num_points()), 0);
  std::vector<Index> kept;
  std::vector<std::uint32_t> slot_of;
  std::uint32_t num_points = 0;
  found->first_other.push_back(0);
  for (Index f = 0; f < num_faces; ++f) {
    if (others_of_face[f].empty()) continue;
    const std::size_t first = others.size();
    const std::size_t first_list = found->first_other.size();
    slot_of.assign(others_of_face[f].size(), 0);
    std::vector<char> is_used(others_of_face[f].size(), 0);
    for (Index p = points_.first_point(f); p < points_.first_point(f + 1); ++p) {
      for (std::size_t s = 0; s < others_of_face[f].size(); ++s) {
        const Index other = others_of_face[f][s];
        if (boxes[other].squaredExteriorDistance(places[p]) >= reach * reach) continue;
        for (Index q = points_.first_point(other); q < points_.first_point(other + 1); ++q) {
          if ((places[p] - places[q]).squaredNorm() >= reach * reach) continue;
          if (points_.part(f) == points_.part(other) && are_two_sides(p, q)) continue;
          others.push_back({static_cast<std::uint32_t>(q), static_cast<std::uint32_t>(s)});
          is_used[s] = 1;
        }
      }
      found->first_other.push_back(others.size());
    }
    if (others.size() == first) {
      found->first_other.resize(first_list);
      continue;
    }
    kept.clear();
    for (std::size_t s = 0; s < is_used.size(); ++s) {
      slot_of[s] = static_cast<std::uint32_t>(kept.size());
      if (is_used[s] != 0) kept.push_back(others_of_face[f][s]);
    }
    for (std::size_t i = first; i < others.size(); ++i) others[i].slot = slot_of[others[i].slot];
    others_of_face[f] = kept;
    found->faces.push_back(f);
    found->first_point.push_back(num_points);
    for (Index p = points_.first_point(f); p < points_.first_point(f + 1); ++p) {
      number[p] = num_points++;
    }
  }
  found->first_point.push_back(num_points);
  for (Neighbours::Other& other : others) other.point = number[other.point];

  const int per_face = points_.nodes_per_face();
  for (const Index f : found->faces) {
    Neighbours::Local& local = found->local.emplace_back();
    local.nodes.assign(points_.nodes(f), points_.nodes(f) + per_face);
    for (const Index other : others_of_face[f]) {
      for (int a = 0; a < per_face; ++a) {
        const Index node = points_.nodes(other)[a];
        const auto at = std::find(local.nodes.begin(), local.nodes.end(), node);
        local.of_slots.push_back(static_cast<std::uint16_t>(at - local.nodes.begin()));
        if (at == local.nodes.end()) local.nodes.push_back(node);
      }
    }
  }
  return found;
}

SoftContact::Neighbours& SoftContact::near(const NodalVector& state) const {
  const auto is_near = [&] {
    const double most = kMargin * reach_ / (2 * kNodeToPoint);
    const Eigen::Index displacements = 3 * static_cast<Eigen::Index>(points_.rest().size());
    for (Eigen::Index i = 0; i < displacements; i += 3) {
      const Vec3 moved = state.segment<3>(i) - neighbours_->reference.segment<3>(i);
      if (!(moved.squaredNorm() < most * most)) return false;
    }
    return true;
  };
  if (neighbours_ == nullptr || !is_near()) neighbours_ = find_neighbours(state);
  return *neighbours_;
}

std::vector<SoftContact::NearPoint> SoftContact::features(const Neighbours& near,
                                                          const NodalVector& state) const {
  std::vector<NearPoint> features;
  features.reserve(near.first_point.back());
  for (const Index f : near.faces) {
    for (Index p = points_.first_point(f); p < points_.first_point(f + 1); ++p) {
      features.push_back({points_.features(p, state), p, points_.area(p)});
    }
  }
  return features;
}

namespace {

/// m and g of a point i and another point j, with what their derivatives take.
struct PairTerms {
  double area;
  Vec3 r;
  /// w k and w s; m is w k s.
  double of_kernel, of_facing;
  double m;
  double g;
  /// ∂k/∂r = by_r r, and ∂²k/∂r² = by_r I + by_rr r rᵀ.
  double by_r, by_rr;
  /// s, by −n_i · n_j.
  Step facing;
};

/// @param area w of j.
/// @returns False: m is 0.
bool find_pair(const PointFeatures& i, const PointFeatures& j, double area, double reach,
               PairTerms& pair) {
  pair.r = i.place - j.place;
  const double inverse = 1 / (reach * reach);
  const double t = 1 - pair.r.squaredNorm() * inverse;
  if (t <= 0) return false;
  const double facing = -i.normal.dot(j.normal);
  if (facing <= 0) return false;
  pair.area = area;
  pair.facing = smooth_step(facing / kFacing);
  pair.facing.slope /= kFacing;
  pair.facing.curvature /= kFacing * kFacing;
  const double t2 = t * t;
  pair.of_kernel = area * t2 * t2;
  pair.of_facing = area * pair.facing.value;
  pair.m = pair.of_kernel * pair.facing.value;
  pair.g = j.normal.dot(pair.r);
  pair.by_r = -8 * t2 * t * inverse;
  pair.by_rr = 48 * t2 * inverse * inverse;
  return true;
}

/// Adds a second derivative by some nodes to the blocks of their pairs.
/// @param pairs The pair of each two nodes, a ≥ b.
void add_blocks(const std::vector<Index>& nodes, const std::vector<Index>& pairs,
                const Eigen::Ref<const Eigen::MatrixXd>& whole, std::size_t num_nodes,
                std::vector<Mat3>& blocks) {
  std::size_t at = 0;
  for (std::size_t a = 0; a < num_nodes; ++a) {
    for (std::size_t b = 0; b <= a; ++b, ++at) {
      const bool is_lower = nodes[b] <= nodes[a];
      const auto row = static_cast<Eigen::Index>(3 * (is_lower ? b : a));
      const auto column = static_cast<Eigen::Index>(3 * (is_lower ? a : b));
      blocks[pairs[at]] += whole.block<3, 3>(row, column);
    }
  }
}

/// The derivatives of m by r, n_i and n_j. Those of g are n_j, 0 and r.
struct PairSlopes {
  Vec3 r, i, j;
};

PairSlopes slopes_of(const PairTerms& pair, const PointFeatures& i, const PointFeatures& j) {
  const double by_facing = -pair.of_kernel * pair.facing.slope;
  return {pair.of_facing * pair.by_r * pair.r, by_facing * j.normal, by_facing * i.normal};
}

/// by_s Dm + by_p D(m g) by place and normal of i and j, with all = by_s + by_p g.
struct PairGradient {
  Vec6 i, j;
};

PairGradient gradient_of(const PairTerms& pair, const PairSlopes& m, const PointFeatures& j,
                         double all, double by_p) {
  PairGradient d;
  const double of_g = by_p * pair.m;
  d.i.head<3>() = all * m.r + of_g * j.normal;
  d.i.tail<3>() = all * m.i;
  d.j.head<3>() = -d.i.head<3>();
  d.j.tail<3>() = all * m.j + of_g * pair.r;
  return d;
}

/// by_s D²m + by_p D²(m g), likewise.
struct PairCurvature {
  Mat6 ii, ij, jj;
};

PairCurvature curvature_of(const PairTerms& pair, const PairSlopes& m, const PointFeatures& i,
                           const PointFeatures& j, double all, double by_p) {
  const Vec3 across = -all * pair.area * pair.facing.slope * pair.by_r * pair.r;
  const double turned = all * pair.of_kernel * pair.facing.curvature;
  const Mat3 of_m = m.r * j.normal.transpose();
  const Mat3 rr = all * pair.of_facing *
                      (pair.by_r * Mat3::Identity() + pair.by_rr * pair.r * pair.r.transpose()) +
                  by_p * (of_m + of_m.transpose());
  const Mat3 ri = across * j.normal.transpose() + by_p * j.normal * m.i.transpose();
  const Mat3 rj =
      across * i.normal.transpose() +
      by_p * (m.r * pair.r.transpose() + j.normal * m.j.transpose() + pair.m * Mat3::Identity());
  const Mat3 turn = m.j * pair.r.transpose();
  PairCurvature d;
  d.ii << rr, ri, ri.transpose(), turned * j.normal * j.normal.transpose();
  d.ij << -rr, rj, -ri.transpose(),
      turned * j.normal * i.normal.transpose() -
          all * pair.of_kernel * pair.facing.slope * Mat3::Identity() +
          by_p * m.i * pair.r.transpose();
  d.jj << rr, -rj, -rj.transpose(),
      turned * i.normal * i.normal.transpose() + by_p * (turn + turn.transpose());
  return d;
}

}  // namespace

/// Another point that one sees.
struct SoftContact::FeltPair : PairTerms {
  Neighbours::Other other;
};

SoftContact::Sums SoftContact::sums(const Neighbours& near, const std::vector<NearPoint>& at,
                                    std::size_t i, std::vector<FeltPair>& felt) const {
  Sums sums;
  felt.clear();
  FeltPair pair;
  for (std::size_t k = near.first_other[i]; k < near.first_other[i + 1]; ++k) {
    pair.other = near.others[k];
    const NearPoint& j = at[pair.other.point];
    if (!find_pair(at[i], j, j.area, reach_, pair)) continue;
    sums.s += pair.m;
    sums.p += pair.m * pair.g;
    felt.push_back(pair);
  }
  return sums;
}

bool SoftContact::find_energy(const NearPoint& i, const Sums& sums, Jet& jet) const {
  if (!is_covered(sums)) return false;
  const double f = sums.gap();
  const double distance = f - offsets_[i.point];
  if (!law_.acts_at(distance)) return false;
  const ContactLaw::Jet psi = law_.evaluate(distance);
  const double range = (1 - kNoCover) * least_sum_;
  Step cover = smooth_step((sums.s - kNoCover * least_sum_) / range);
  cover.slope /= range;
  cover.curvature /= range * range;
  const double s = sums.s;
  const double half = 0.5 * i.area;
  jet.value = half * psi.value * cover.value;
  jet.p = half * psi.slope * cover.value / s;
  jet.s = half * (psi.value * cover.slope - psi.slope * f * cover.value / s);
  jet.pp = half * psi.curvature * cover.value / (s * s);
  jet.ps = half *
           (psi.slope * cover.slope / s - (psi.curvature * f + psi.slope) * cover.value / (s * s));
  jet.ss = half * (psi.value * cover.curvature - 2 * psi.slope * f * cover.slope / s +
                   (psi.curvature * f + 2 * psi.slope) * f * cover.value / (s * s));
  jet.pressure = -psi.slope * cover.value;
  return true;
}

double SoftContact::add(const NodalVector& state, NodalVector& force,
                        std::vector<double>* /*values*/) const {
  const Neighbours& near = this->near(state);
  const std::vector<NearPoint> at = features(near, state);
  std::vector<Vec6> gradient(at.size(), Vec6::Zero());
  double energy = 0;
  Jet jet;
  std::vector<FeltPair> felt;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Sums sums = this->sums(near, at, i, felt);
    if (has_passed_through(sums)) return std::numeric_limits<double>::infinity();
    if (!find_energy(at[i], sums, jet)) continue;
    energy += jet.value;
    for (const FeltPair& pair : felt) {
      const NearPoint& j = at[pair.other.point];
      const PairGradient d =
          gradient_of(pair, slopes_of(pair, at[i], j), j, jet.s + jet.p * pair.g, jet.p);
      gradient[i] += d.i;
      gradient[pair.other.point] += d.j;
    }
  }
  if (energy == 0) return 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (gradient[i].isZero(0)) continue;
    const Eigen::Matrix<double, 3 * ContactPoints::kMostNodes, 1> of_nodes =
        points_.slopes(at[i].point, at[i]).transpose() * gradient[i];
    const Index* nodes = points_.nodes(points_.face_of(at[i].point));
    for (int a = 0; a < points_.nodes_per_face(); ++a) {
      force.segment<3>(3 * Eigen::Index{nodes[a]}) += of_nodes.segment<3>(3 * a);
    }
  }
  return energy;
}

void SoftContact::take_blocks(const NodalVector& state, PairBlocks& result) const {
  Neighbours& near = this->near(state);
  near.name_pairs();
  result.pairs = near.pairs;
  std::vector<Mat3>& blocks = result.values;
  blocks.assign(near.pairs.size(), Mat3::Zero());
  const std::vector<NearPoint> at = features(near, state);
  // By place and normal of each point.
  std::vector<Vec6> gradient(at.size(), Vec6::Zero());
  std::vector<Mat6> curvature(at.size(), Mat6::Zero());
  constexpr int kOfFace = 3 * ContactPoints::kMostNodes;
  const int per_face = points_.nodes_per_face();
  using Slopes = ContactPoints::Slopes;
  std::vector<Slopes> slopes(at.size());
  std::vector<char> has_slopes(at.size(), 0);
  const auto slopes_at = [&](std::size_t i) -> const Slopes& {
    if (has_slopes[i] == 0) {
      slopes[i] = points_.slopes(at[i].point, at[i]);
      has_slopes[i] = 1;
    }
    return slopes[i];
  };
  Jet jet;
  std::vector<FeltPair> felt;
  Eigen::MatrixXd whole;
  Eigen::Matrix<double, Eigen::Dynamic, 2> of_sums;
  for (std::size_t f = 0; f < near.faces.size(); ++f) {
    const Neighbours::Local& local = near.local[f];
    const auto size = static_cast<Eigen::Index>(3 * local.nodes.size());
    const std::size_t num_slots = local.of_slots.size() / static_cast<std::size_t>(per_face);
    bool acts = false;
    for (std::size_t i = near.first_point[f]; i < near.first_point[f + 1]; ++i) {
      const Sums sums = this->sums(near, at, i, felt);
      if (!find_energy(at[i], sums, jet)) continue;
      if (!acts) whole.setZero(size, size);
      acts = true;
      // Columns: the derivatives of P and of S by the nodes.
      of_sums.setZero(size, 2);
      Vec6 p_i = Vec6::Zero();
      Vec6 s_i = Vec6::Zero();
      auto next = felt.begin();
      for (std::size_t slot = 0; slot < num_slots; ++slot) {
        Eigen::Matrix<double, 6, kOfFace> crossed = Eigen::Matrix<double, 6, kOfFace>::Zero();
        Eigen::Matrix<double, kOfFace, 2> of_slot = Eigen::Matrix<double, kOfFace, 2>::Zero();
        if (next == felt.end() || next->other.slot != slot) continue;
        for (; next != felt.end() && next->other.slot == slot; ++next) {
          const FeltPair& pair = *next;
          const std::uint32_t other = pair.other.point;
          const NearPoint& j = at[other];
          const PairSlopes m = slopes_of(pair, at[i], j);
          const PairGradient by_p = gradient_of(pair, m, j, pair.g, 1);
          const PairGradient by_s = gradient_of(pair, m, j, 1, 0);
          const PairCurvature d = curvature_of(pair, m, at[i], j, jet.s + jet.p * pair.g, jet.p);
          p_i += by_p.i;
          s_i += by_s.i;
          curvature[i] += d.ii;
          curvature[other] += d.jj;
          gradient[i] += jet.p * by_p.i + jet.s * by_s.i;
          gradient[other] += jet.p * by_p.j + jet.s * by_s.j;
          const Slopes& of_j = slopes_at(other);
          crossed += d.ij * of_j;
          of_slot.col(0) += of_j.transpose() * by_p.j;
          of_slot.col(1) += of_j.transpose() * by_s.j;
        }
        const Eigen::Matrix<double, kOfFace, kOfFace> block = slopes_at(i).transpose() * crossed;
        for (int b = 0; b < per_face; ++b) {
          const Eigen::Index column =
              3 * Eigen::Index{local.of_slots[slot * static_cast<std::size_t>(per_face) +
                                              static_cast<std::size_t>(b)]};
          of_sums.middleRows<3>(column) += of_slot.middleRows<3>(3 * b);
          for (int a = 0; a < per_face; ++a) {
            const Mat3 of_nodes = block.block<3, 3>(3 * a, 3 * b);
            whole.block<3, 3>(3 * a, column) += of_nodes;
            whole.block<3, 3>(column, 3 * a) += of_nodes.transpose();
          }
        }
      }
      const Eigen::Matrix<double, kOfFace, 1> p_nodes = slopes_at(i).transpose() * p_i;
      const Eigen::Matrix<double, kOfFace, 1> s_nodes = slopes_at(i).transpose() * s_i;
      of_sums.col(0).head(3 * per_face) += p_nodes.head(3 * per_face);
      of_sums.col(1).head(3 * per_face) += s_nodes.head(3 * per_face);
      Eigen::Matrix2d by_sums;
      by_sums << jet.pp, jet.ps, jet.ps, jet.ss;
      const Eigen::Matrix<double, Eigen::Dynamic, 2> weighed = of_sums * by_sums;
      whole.noalias() += weighed * of_sums.transpose();
    }
    if (acts) add_blocks(local.nodes, local.pairs, whole, local.nodes.size(), blocks);
  }
  ContactPoints::FaceBlock of_face;
  for (std::size_t f = 0; f < near.faces.size(); ++f) {
    bool acts = false;
    for (std::size_t i = near.first_point[f]; i < near.first_point[f + 1]; ++i) {
      if (has_slopes[i] == 0) continue;
      if (!acts) of_face.setZero();
      acts = true;
      of_face += slopes[i].transpose() * curvature[i] * slopes[i];
      points_.add_curvature(at[i].point, at[i], gradient[i].tail<3>(), of_face);
    }
    if (acts)
      add_blocks(near.local[f].nodes, near.local[f].pairs, of_face,
                 static_cast<std::size_t>(per_face), blocks);
  }
}

void SoftContact::set_offsets() {
  const NodalVector rest = NodalVector::Zero(3 * static_cast<Eigen::Index>(points_.rest().size()));
  const Neighbours& near = this->near(rest);
  const std::vector<NearPoint> at = features(near, rest);
  std::vector<FeltPair> felt;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Sums sums = this->sums(near, at, i, felt);
    if (!is_covered(sums)) continue;
    offsets_[at[i].point] = std::min(sums.gap(), law_.thickness) - law_.thickness;
  }
}

bool SoftContact::is_covered(const Sums& sums) const { return sums.s > kNoCover * least_sum_; }

bool SoftContact::has_passed_through(const Sums& sums) const {
  return sums.s > kSeen * least_sum_ && sums.gap() < -0.5 * reach_;
}

bool SoftContact::are_two_sides(Index point, Index other) const {
  const PointFeatures& i = rest_[point];
  const PointFeatures& j = rest_[other];
  const Vec3 r = i.place - j.place;
  const double distance = r.norm();
  if (distance > kSameNeighbourhood * reach_) return false;
  return std::min(j.normal.dot(r), -i.normal.dot(r)) < -kBehind * distance;
}

double SoftContact::longest_share(const NodalVector& state, const NodalVector& step) const {
  const std::size_t num_points = points_.rest().size();
  double fastest = 0;
  for (std::size_t p = 0; p < num_points; ++p) {
    fastest = std::max(fastest, step.segment<3>(3 * static_cast<Eigen::Index>(p)).squaredNorm());
  }
  fastest = kNodeToPoint * std::sqrt(fastest);
  const double safe = 0.5 * reach_;
  if (2 * fastest <= safe) return 1;
  // Faces that are farther apart than this do not meet in the step.
  const double farthest = 2 * fastest;
  const auto num_faces = static_cast<std::size_t>(points_.num_faces());
  std::vector<BoxTree::Box> boxes(num_faces);
  std::vector<BoxTree::Box> ways(num_faces);
  std::vector<Vec3> normals(num_faces);
  for (std::size_t f = 0; f < num_faces; ++f) {
    const Index* nodes = points_.nodes(static_cast<Index>(f));
    for (int a = 0; a < points_.nodes_per_face(); ++a) {
      boxes[f].extend(points_.node_place(nodes[a], state));
      ways[f].extend(Vec3(step.segment<3>(3 * Eigen::Index{nodes[a]})));
    }
    const Vec3 corner = points_.node_place(nodes[0], state);
    normals[f] = (points_.node_place(nodes[1], state) - corner)
                     .cross(points_.node_place(nodes[2], state) - corner)
                     .normalized();
  }
  const BoxTree tree(boxes);
  double share = 1;
  for (std::size_t f = 0; f < num_faces; ++f) {
    tree.for_overlapping(inflated(boxes[f], farthest), [&](Index place) {
      const auto g = static_cast<std::size_t>(tree.order()[place]);
      if (g <= f || !may_touch(static_cast<Index>(f), static_cast<Index>(g))) return;
      const std::optional<double> meet = first_meeting(boxes[f], ways[f], boxes[g], ways[g]);
      if (!meet) return;
      // How far f comes nearer to g, against the normals of both; these differ within a face.
      const Vec3 way = ways[f].center() - ways[g].center();
      const double nearer = std::max({0.0, -normals[g].dot(way), normals[f].dot(way)});
      const double within = 0.5 * (ways[f].sizes().norm() + ways[g].sizes().norm());
      const double most = nearer + kAcrossNormals * way.norm() + kNodeToPoint * within;
      share = std::min(share, *meet + safe / most);
    });
  }
  return share;
}

std::vector<SoftContact::AtPoint> SoftContact::points_in_reach(const NodalVector& state) const {
  const Neighbours& near = this->near(state);
  const std::vector<NearPoint> at = features(near, state);
  std::vector<AtPoint> found;
  std::vector<FeltPair> felt;
  Jet jet;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Sums sums = this->sums(near, at, i, felt);
    if (!is_covered(sums)) continue;
    const bool acts = find_energy(at[i], sums, jet);
    found.push_back({at[i].point, sums.gap(), acts ? jet.pressure : 0});
  }
  return found;
}

SoftContact::OnSurface SoftContact::on_surface(const NodalVector& state) const {
  OnSurface result;
  const std::size_t num_points = points_.rest().size();
  result.pressure.assign(num_points, 0);
  result.gap.assign(num_points, 0);
  std::vector<double> area(num_points, 0);
  std::vector<double> area_in_reach(num_points, 0);
  std::vector<double> pressures(static_cast<std::size_t>(points_.num_points()), 0);
  std::vector<double> gaps(pressures.size(), std::numeric_limits<double>::quiet_NaN());
  for (const AtPoint& at : points_in_reach(state)) {
    pressures[at.point] = at.pressure;
    gaps[at.point] = at.gap;
    result.deepest = std::max(result.deepest, -at.gap);
  }
  NodalVector force = NodalVector::Zero(state.size());
  (void)add(state, force, nullptr);
  std::vector<Index> part_of_node(num_points, -1);
  for (Index f = 0; f < points_.num_faces(); ++f) {
    double of_face = 0;
    double in_reach = 0;
    double load = 0;
    double gap = 0;
    for (Index p = points_.first_point(f); p < points_.first_point(f + 1); ++p) {
      of_face += points_.area(p);
      load += points_.area(p) * pressures[p];
      if (std::isnan(gaps[p])) continue;
      in_reach += points_.area(p);
      gap += points_.area(p) * gaps[p];
    }
    for (int a = 0; a < points_.nodes_per_face(); ++a) {
      const Index node = points_.nodes(f)[a];
      area[node] += of_face;
      area_in_reach[node] += in_reach;
      result.pressure[node] += load;
      result.gap[node] += gap;
      part_of_node[node] = points_.part(f);
    }
    const auto num_parts = static_cast<std::size_t>(points_.part(f)) + 1;
    if (result.force_on_part.size() < num_parts)
      result.force_on_part.resize(num_parts, Vec3::Zero());
  }
  for (std::size_t n = 0; n < num_points; ++n) {
    if (area[n] > 0) result.pressure[n] /= area[n];
    result.gap[n] = area_in_reach[n] > 0 ? result.gap[n] / area_in_reach[n]
                                         : std::numeric_limits<double>::quiet_NaN();
    if (part_of_node[n] < 0) continue;
    result.force_on_part[part_of_node[n]] -= force.segment<3>(3 * static_cast<Eigen::Index>(n));
  }
  return result;
}

std::unique_ptr<const SoftContact> make_soft_contact(const Scene& scene) {
  if (scene.organ.touching == TouchingParts::none) return nullptr;
  return std::make_unique<const SoftContact>(scene);
}

std::vector<const EnergyTerm*> with_contact(const SoftContact* contact,
                                            const std::vector<const EnergyTerm*>& terms) {
  std::vector<const EnergyTerm*> all = terms;
  if (contact != nullptr) all.insert(all.begin(), contact);
  return all;
}

}  // namespace palpate
