// SPDX-License-Identifier: BSD-3-Clause
#include "soft_contact/soft_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "mesh/box_tree.h"
#include "mesh/surface_tree.h"
#include "soft_contact/contact_defaults.h"
#include "soft_contact/contact_sight.h"
#include "soft_contact/smooth_step.h"

namespace palpate {
namespace {

/// ρ in thicknesses of the layer, and at least in distances of points.
constexpr double kReachOfThickness = 2;
constexpr double kReachOfSpacing = 2.8;
/// The distance of points, in thicknesses and at least in edges around a face.
constexpr double kSpacing = 0.7;
constexpr double kSpacingOfEdge = 1 / 7.5;
/// S₀: a share of the S beside a plane, which is π/5.
constexpr double kLeastSum = 0.05 * M_PI / 5;
/// S in S₀ up to which there is no contact.
constexpr double kNoCover = 0.01;
/// A point sees enough of the other side, in S₀, to know that it is too deep inside. At the depth
/// ρ/2 a plane has 4.7, and half of a plane half of that.
constexpr double kSeen = 2;
/// The depth in ρ up to which a point is sure to be found inside, where it sees a whole plane; and
/// that to which it may come in a state of finite energy.
constexpr double kSafe = 0.55;
constexpr double kDeepest = 0.5;
/// The largest step of a difference, in thicknesses.
constexpr double kDifference = 1e-3;
/// Of how many states the neighbours are kept.
constexpr std::size_t kKeptNeighbours = 4;
/// How far beyond ρ neighbours are searched for, in the mean ρ.
constexpr double kMargin = 0.5;
/// No point of a face moves by more than this times its farthest node: Σ |N_a| ≤ 5/3.
constexpr double kNodeToPoint = 5.0 / 3;

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

/// The values of a quadratic function at the nodes of a face bound those in the face.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void extend(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double middle() const { return 0.5 * (low + high); }
  [[nodiscard]] double least() const { return middle() - kNodeToPoint * (middle() - low); }
  [[nodiscard]] double most() const { return middle() + kNodeToPoint * (high - middle()); }
};

struct AlongNormal {
  Range place, way;
};

/// The normal of a face at its corners in the mean, and the sine of the largest angle between that
/// and the normal at a corner.
struct FaceNormal {
  Vec3 middle = Vec3::Zero();
  double turn = 0;
};

FaceNormal normal_of(const ContactPoints& points, Index face, const NodalVector& state) {
  FaceNormal result;
  std::array<Vec3, 3> at_corners;
  for (int corner = 0; corner < 3; ++corner) {
    at_corners[corner] = points.corner_normal(face, corner, state);
    result.middle += at_corners[corner];
  }
  result.middle.normalize();
  for (const Vec3& normal : at_corners) {
    result.turn = std::max(result.turn, result.middle.cross(normal).norm());
  }
  return result;
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

ContactPoints make_points(const Scene& scene, double most_edge) {
  const double thickness = scene.organ.contact.thickness;
  std::vector<double> spacings;
  std::vector<double> reaches;
  for (const double edge : local_surface_edges(scene.body.mesh, most_edge)) {
    spacings.push_back(std::max(kSpacing * thickness, kSpacingOfEdge * edge));
    reaches.push_back(std::max(kReachOfThickness * thickness, kReachOfSpacing * spacings.back()));
  }
  return {scene.body, spacings, std::move(reaches)};
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

SoftContact::SoftContact(const Scene& scene)
    : SoftContact(scene, mean_surface_edge(scene.body.mesh)) {}

SoftContact::SoftContact(const Scene& scene, double most_edge)
    : law_(scene.organ.contact),
      points_(make_points(scene, most_edge)),
      rule_(points_, scene.organ.touching),
      least_reach_(*std::min_element(points_.reaches().begin(), points_.reaches().end())),
      margin_(kMargin * mean(points_.reaches())),
      offsets_(static_cast<std::size_t>(points_.num_points()), 0.0) {
  validate(law_);
  require_apart(scene.body, law_.thickness);
  set_offsets();
}

SoftContact::~SoftContact() = default;

double SoftContact::reach() const {
  return *std::max_element(points_.reaches().begin(), points_.reaches().end());
}

const ContactNeighbours& SoftContact::near(const NodalVector& state) const {
  const double most = margin_ / (2 * kNodeToPoint);
  const Eigen::Index displacements = 3 * static_cast<Eigen::Index>(points_.rest().size());
  const auto serves = [&](const ContactNeighbours& found) {
    for (Eigen::Index i = 0; i < displacements; i += 3) {
      const Vec3 moved = state.segment<3>(i) - found.reference.segment<3>(i);
      if (!(moved.squaredNorm() < most * most)) return false;
    }
    return true;
  };
  const auto found = std::find_if(neighbours_.begin(), neighbours_.end(), serves);
  if (found != neighbours_.end()) {
    neighbours_.splice(neighbours_.begin(), neighbours_, found);
  } else {
    neighbours_.push_front(find_neighbours(points_, rule_, state, margin_));
    if (neighbours_.size() > kKeptNeighbours) neighbours_.pop_back();
  }
  return neighbours_.front();
}

SoftContact::Sight& SoftContact::look(const NodalVector& state, double around) const {
  if (sight_ != nullptr && sight_->around == around && sight_->state == state) return *sight_;
  const ContactNeighbours& near = this->near(state);
  if (sight_ == nullptr) sight_ = std::make_unique<Sight>();
  Sight& sight = *sight_;
  sight.state = state;
  sight.around = around;
  points_.take_features(near.faces, state, sight.points);
  sight.s.resize(near.num_packets() * kPacketSize);
  sight.p.resize(sight.s.size());
  sight.rows.resize(near.others.size());
  best_contact_kernels().sums(sight.points.data(), near.view(), around, sight.s.data(),
                              sight.p.data(), sight.rows.data());
  return sight;
}

bool SoftContact::acts(Index point, const Sums& sums, double further) const {
  return points_.area(point) > 0 && is_covered(sums) &&
         law_.acts_at(sums.gap() - offsets_[point] - further);
}

SoftContact::Jet SoftContact::energy_of(Index point, const Sums& sums) const {
  const double f = sums.gap();
  const ContactLaw::Jet psi = law_.evaluate(f - offsets_[point]);
  const double range = (1 - kNoCover) * kLeastSum;
  SmoothStep<double> cover =
      smooth_step(std::clamp((sums.s - kNoCover * kLeastSum) / range, 0.0, 1.0));
  cover.slope /= range;
  cover.curvature /= range * range;
  const double s = sums.s;
  const double half = 0.5 * points_.area(point);
  Jet jet;
  jet.value = half * psi.value * cover.value;
  jet.p = half * psi.slope * cover.value / s;
  jet.s = half * (psi.value * cover.slope - psi.slope * f * cover.value / s);
  jet.pp = half * psi.curvature * cover.value / (s * s);
  jet.ps = half *
           (psi.slope * cover.slope / s - (psi.curvature * f + psi.slope) * cover.value / (s * s));
  jet.ss = half * (psi.value * cover.curvature - 2 * psi.slope * f * cover.slope / s +
                   (psi.curvature * f + 2 * psi.slope) * f * cover.value / (s * s));
  jet.pressure = -psi.slope * cover.value;
  return jet;
}

double SoftContact::differentiate(Sight& sight) const {
  const ContactNeighbours& near = neighbours_.front();
  double energy = 0;
  sight.jets.resize(sight.num_points());
  for (std::size_t i = 0; i < sight.num_points(); ++i) {
    const Sums sums = sight.sums(i);
    const Index point = near.point(i);
    if (sight.is_point(i) && has_passed_through(point, sums)) {
      return std::numeric_limits<double>::infinity();
    }
    const Jet jet = acts(point, sums, 0) ? energy_of(point, sums) : Jet();
    energy += jet.value;
    sight.jets.set(i, jet);
  }
  sight.gradient.resize(6 * sight.num_points());
  if (energy > 0) {
    best_contact_kernels().gradient(sight.points.data(), near.view(), sight.rows.data(),
                                    sight.jets.view(), sight.gradient.data());
  }
  return energy;
}

double SoftContact::add(const NodalVector& state, NodalVector& force,
                        std::vector<double>* /*values*/) const {
  Sight& sight = look(state, 1);
  const double energy = differentiate(sight);
  if (energy > 0 && std::isfinite(energy)) {
    points_.add_to_nodes(neighbours_.front().faces, sight.points, sight.gradient, force);
  }
  return energy;
}

void SoftContact::set_offsets() {
  const NodalVector rest = NodalVector::Zero(3 * static_cast<Eigen::Index>(points_.rest().size()));
  const Sight& sight = look(rest, 1);
  for (std::size_t i = 0; i < sight.num_points(); ++i) {
    const Sums sums = sight.sums(i);
    if (!is_covered(sums)) continue;
    offsets_[neighbours_.front().point(i)] = std::min(sums.gap(), law_.thickness) - law_.thickness;
  }
}

bool SoftContact::is_covered(const Sums& sums) const { return sums.s > kNoCover * kLeastSum; }

bool SoftContact::has_passed_through(Index point, const Sums& sums) const {
  return sums.s > kSeen * kLeastSum &&
         sums.gap() < -kDeepest * points_.reaches()[points_.face_of(point)];
}

double SoftContact::longest_share(const NodalVector& state, const NodalVector& step) const {
  double fastest = 0;
  for (Eigen::Index i = 0; i < 3 * static_cast<Eigen::Index>(points_.rest().size()); i += 3) {
    fastest = std::max(fastest, step.segment<3>(i).squaredNorm());
  }
  // Two surfaces come nearer to each other by no more than this.
  const double nearer = 2 * kNodeToPoint * std::sqrt(fastest);
  if (nearer <= (kSafe - kDeepest) * least_reach_) return 1;
  // As far as is safe from here, then from there, until a point is too deep or the end is reached.
  double safe = 0;
  double share = 0;
  for (;;) {
    const NodalVector here = share == 0 ? state : NodalVector(state + share * step);
    const std::vector<double> depths = depths_of_faces(here);
    if (share > 0 && least_left(depths, kDeepest) < 0) return 0.5 * (safe + share);
    if ((1 - share) * nearer <= least_left(depths, kSafe)) return 1;
    safe = share;
    share += (1 - share) * safe_share(here, (1 - share) * step, 0.5 * (1 - share) * nearer, depths);
    if (share >= 1) return 1;
  }
}

double SoftContact::safe_share(const NodalVector& state, const NodalVector& step, double fastest,
                               const std::vector<double>& depths) const {
  // Faces that are farther apart than this do not meet in the step.
  const double farthest = 2 * fastest;
  const auto num_faces = static_cast<std::size_t>(points_.num_faces());
  std::vector<BoxTree::Box> boxes(num_faces);
  std::vector<BoxTree::Box> ways(num_faces);
  std::vector<FaceNormal> normals(num_faces);
  for (std::size_t f = 0; f < num_faces; ++f) {
    const Index* nodes = points_.nodes(static_cast<Index>(f));
    for (int a = 0; a < points_.nodes_per_face(); ++a) {
      boxes[f].extend(points_.node_place(nodes[a], state));
      ways[f].extend(Vec3(step.segment<3>(3 * Eigen::Index{nodes[a]})));
    }
    normals[f] = normal_of(points_, static_cast<Index>(f), state);
  }
  // Where the nodes of a face are along a direction, and how far they move along it.
  const auto along = [&](std::size_t f, const Vec3& direction) {
    AlongNormal range;
    const Index* nodes = points_.nodes(static_cast<Index>(f));
    for (int a = 0; a < points_.nodes_per_face(); ++a) {
      range.place.extend(direction.dot(points_.node_place(nodes[a], state)));
      range.way.extend(direction.dot(step.segment<3>(3 * Eigen::Index{nodes[a]})));
    }
    return range;
  };
  const BoxTree tree(boxes);
  double share = 1;
  for (std::size_t f = 0; f < num_faces; ++f) {
    tree.for_overlapping(inflated(boxes[f], farthest), [&](Index place) {
      const auto g = static_cast<std::size_t>(tree.order()[place]);
      if (g <= f || !rule_.may_touch(static_cast<Index>(f), static_cast<Index>(g))) return;
      const std::optional<double> meet = first_meeting(boxes[f], ways[f], boxes[g], ways[g]);
      if (!meet) return;
      // How far f comes nearer to g along the normal of each, which turns a little within it, and
      // how much nearer it may come.
      const double across = (ways[f].center() - ways[g].center()).norm();
      const double reach = points_.reach(static_cast<Index>(f), static_cast<Index>(g));
      const double depth = std::min(std::max(depths[f], depths[g]), kDeepest * reach);
      const double safe = kSafe * reach - depth;
      const auto check = [&](std::size_t face, std::size_t other) {
        const Vec3& normal = normals[face].middle;
        const AlongNormal here = along(face, normal);
        const AlongNormal there = along(other, normal);
        const double nearer = here.way.most() - there.way.least() + normals[face].turn * across;
        const double gap = there.place.least() - here.place.most();
        const double allowed = safe + std::max(0.0, gap);
        if (nearer > allowed) share = std::min(share, *meet + allowed / nearer);
      };
      check(f, g);
      check(g, f);
    });
  }
  return share;
}

std::vector<double> SoftContact::depths_of_faces(const NodalVector& state) const {
  std::vector<double> depths(static_cast<std::size_t>(points_.num_faces()), 0.0);
  for (const AtPoint& at : points_in_reach(state)) {
    double& depth = depths[points_.face_of(at.point)];
    depth = std::max(depth, -at.gap);
  }
  return depths;
}

double SoftContact::least_left(const std::vector<double>& depths, double deepest) const {
  double left = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < depths.size(); ++f) {
    left = std::min(left, deepest * points_.reaches()[f] - depths[f]);
  }
  return left;
}

std::vector<SoftContact::AtPoint> SoftContact::points_in_reach(const NodalVector& state) const {
  const Sight& sight = look(state, 1);
  std::vector<AtPoint> found;
  for (std::size_t i = 0; i < sight.num_points(); ++i) {
    const Sums sums = sight.sums(i);
    if (!sight.is_point(i) || !is_covered(sums)) continue;
    const Index point = neighbours_.front().point(i);
    const double pressure = acts(point, sums, 0) ? energy_of(point, sums).pressure : 0;
    found.push_back({point, sums.gap(), pressure, sums.s / kLeastSum});
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
    if (at.seen < 1) continue;
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

double SoftContact::layer_energy(const NodalVector& state) const {
  const Sight& sight = look(state, 1);
  double energy = 0;
  for (std::size_t i = 0; i < sight.num_points(); ++i) {
    const Sums sums = sight.sums(i);
    const Index point = neighbours_.front().point(i);
    if (!acts(point, sums, 0)) continue;
    const Jet jet = energy_of(point, sums);
    // From where the law begins to act, f falls by what is three times the energy for the pressure.
    const double begins = offsets_[point] + law_.reach();
    energy += 0.5 * points_.area(point) * begins * jet.pressure - 3 * jet.value;
  }
  return energy;
}

Eigen::VectorXd SoftContact::layer_force(const NodalVector& state,
                                         const Eigen::MatrixXd& sensitivity) const {
  Eigen::VectorXd force(sensitivity.cols());
  for (Eigen::Index c = 0; c < force.size(); ++c) {
    const double largest = sensitivity.col(c).lpNorm<Eigen::Infinity>();
    const double step = largest > 0 ? kDifference * law_.thickness / largest : 1;
    const NodalVector way = step * sensitivity.col(c);
    force[c] = (layer_energy(state + way) - layer_energy(state - way)) / (2 * step);
  }
  return force;
}

std::unique_ptr<const SoftContact> make_soft_contact(const Scene& scene) {
  if (!scene.has_contact()) return nullptr;
  return std::make_unique<const SoftContact>(scene);
}

std::vector<const EnergyTerm*> with_contact(const SoftContact* contact,
                                            const std::vector<const EnergyTerm*>& terms) {
  std::vector<const EnergyTerm*> all = terms;
  if (contact != nullptr) all.insert(all.begin(), contact);
  return all;
}

}  // namespace palpate
