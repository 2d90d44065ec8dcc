// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/rigid_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/quantity.h"
namespace palpate {
namespace {

/// A face that looks away from the tool by more than this sine is not touched.
constexpr double kAway = 0.5;
/// The largest step of the tool, or of the surface, as a share of the smallest extent of the tool.
/// In a longer step, the surface could pass through the tool and come out on its other side.
constexpr double kLongestStep = 0.5;

/// For Hertz's pressure p: the mean of p^{1/3} that the force follows, over the mean weighted by p.
constexpr double kMeanOfHertz = 5.0 / 6;

/// A ramp from 0 at x = 0 to 1 at x = 1 and its first two derivatives. Its first three derivatives
/// vanish at both ends.
struct Ramp {
  double value, slope, curvature;
};
Ramp ramp(double x) {
  const double x2 = x * x;
  const double r = 1 - x;
  return {x2 * x2 * (35 - x * (84 - x * (70 - 20 * x))), 140 * x2 * x * r * r * r,
          420 * x2 * r * r * (1 - 2 * x)};
}

/// (∇³d · n)_ij = Σ_k d_ijk n_k, of the ten components.
Mat3 contracted(const Eigen::Matrix<double, 10, 1>& t, const Vec3& n) {
  Mat3 m;
  m(0, 0) = t[0] * n[0] + t[1] * n[1] + t[2] * n[2];
  m(0, 1) = t[1] * n[0] + t[3] * n[1] + t[4] * n[2];
  m(0, 2) = t[2] * n[0] + t[4] * n[1] + t[5] * n[2];
  m(1, 1) = t[3] * n[0] + t[6] * n[1] + t[7] * n[2];
  m(1, 2) = t[4] * n[0] + t[7] * n[1] + t[8] * n[2];
  m(2, 2) = t[5] * n[0] + t[8] * n[1] + t[9] * n[2];
  m(1, 0) = m(0, 1);
  m(2, 0) = m(0, 2);
  m(2, 1) = m(1, 2);
  return m;
}

/// A box that contains a face wherever its nodes are: the box around the control points of its
/// Bézier form.
Eigen::AlignedBox3d box_of(const Eigen::Matrix3Xd& places) {
  Eigen::AlignedBox3d box;
  for (int a = 0; a < 3; ++a) box.extend(places.col(a));
  for (Eigen::Index a = 3; a < places.cols(); ++a) {
    box.extend(2 * places.col(a) - 0.5 * (places.col(a - 3) + places.col((a - 2) % 3)));
  }
  return box;
}

/// The second derivatives of the energy of a point of integration, per unit of area, that involve
/// coordinates of the tool.
struct CoordinatePart {
  /// The derivatives by the place of the point and the coordinates [3 × d].
  PoseColumns mixed;
  /// The derivatives by the coordinates [d × d].
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxPoseCoordinates, kMaxPoseCoordinates>
      of_coordinates;
};

template <class Point>
CoordinatePart part_of_coordinates(const PoseJet& pose, const Vec3& y, const Vec3& normal,
                                   const Point& point) {
  CoordinatePart part;
  const PoseColumns y_by = pose.point_by(y);
  PoseColumns in_tool = point.by_yy * y_by;
  if (!pose.turns) {
    part.mixed = pose.rotation * in_tool;
    part.of_coordinates = y_by.transpose() * in_tool;
    return part;
  }
  const PoseColumns m_by = pose.direction_by(normal);
  in_tool += point.by_ym * m_by;
  part.mixed = pose.rotation * in_tool;
  for (int i = 0; i < pose.num_coordinates; ++i) {
    part.mixed.col(i) += pose.rotation_by[i] * point.by_y;
  }
  part.of_coordinates = y_by.transpose() * in_tool +
                        m_by.transpose() * (point.by_ym.transpose() * y_by + point.by_mm * m_by);
  for (int i = 0; i < pose.num_coordinates; ++i) {
    for (int j = 0; j < pose.num_coordinates; ++j) {
      part.of_coordinates(i, j) += point.by_y.dot(pose.point_by_two(y, i, j)) +
                                   point.by_m.dot(pose.direction_by_two(normal, i, j));
    }
  }
  return part;
}

}  // namespace

RigidContact::RigidContact(std::shared_ptr<const ContactSurface> surface, RigidShapePtr shape,
                           ContactLaw law, PoseMapPtr pose)
    : surface_(std::move(surface)), shape_(std::move(shape)), law_(law), pose_(std::move(pose)) {
  validate(law);
  longest_step_ = kLongestStep * 0.5 * shape_->bounds().sizes().minCoeff();
}

std::unique_ptr<Interaction> RigidContact::clone() const {
  return std::make_unique<RigidContact>(*this);
}

double RigidContact::displacement_scale(const Eigen::VectorXd& /*q*/) const {
  return law_.thickness;
}

std::string RigidContact::describe(const Eigen::VectorXd& q) const {
  return shape_->description() + " at " + quantity(pose_->at(q).place, "m");
}

std::vector<Vec3> RigidContact::inner_places(const Eigen::VectorXd& q) const {
  const Pose pose = pose_->at(q);
  std::vector<Vec3> places = shape_->inner_places();
  for (Vec3& place : places) place = pose.in_scene(place);
  return places;
}

bool RigidContact::evaluate(const Vec3& y, const Vec3& m, bool with_hessian, Point& point) const {
  RigidShape::Jet jet = shape_->evaluate(y, with_hessian ? 2 : 1);
  if (!law_.acts_at(jet.value)) return false;
  const double towards = -m.dot(jet.gradient);
  if (towards <= -kAway) return false;
  const auto [psi, slope, curvature] = law_.evaluate(jet.value);
  const Vec3& n = jet.gradient;
  point = {};
  if (towards >= 0) {
    point.value = psi;
    point.by_y = slope * n;
    if (with_hessian) point.by_yy = curvature * n * n.transpose() + slope * jet.hessian;
    return true;
  }
  // The face begins to look away.
  jet = shape_->evaluate(y, with_hessian ? 3 : 2);
  const Ramp s = ramp(1 + towards / kAway);
  const double ds = s.slope / kAway;
  const double dds = s.curvature / (kAway * kAway);
  const Vec3 turn = -jet.hessian * m;
  point.value = psi * s.value;
  point.by_y = slope * s.value * n + psi * ds * turn;
  point.by_m = -psi * ds * n;
  if (with_hessian) {
    const Mat3 mixed = n * turn.transpose();
    point.by_yy = s.value * (curvature * n * n.transpose() + slope * jet.hessian) +
                  slope * ds * (mixed + mixed.transpose()) + psi * dds * turn * turn.transpose() -
                  psi * ds * contracted(jet.third, m);
    point.by_ym = -(slope * ds * n + psi * dds * turn) * n.transpose() - psi * ds * jet.hessian;
    point.by_mm = psi * dds * n * n.transpose();
  }
  return true;
}

template <class Visit>
void RigidContact::for_each_touched_point(const PoseJet& pose, const NodalVector& state,
                                          bool with_hessian, Visit&& visit) const {
  Eigen::AlignedBox3d reach = shape_->bounds();
  const double margin = law_.reach() + shape_->error();
  reach = Eigen::AlignedBox3d(reach.min().array() - margin, reach.max().array() + margin);
  Eigen::Matrix3Xd places(3, surface_->nodes_per_face());
  Point point;
  for (Index f = 0; f < surface_->num_faces(); ++f) {
    const ContactSurface::Face face = surface_->face(f);
    for (Eigen::Index a = 0; a < places.cols(); ++a) {
      const Index p = face.nodes[a];
      places.col(a) = pose.point(surface_->points()[p] + state.segment<3>(3 * Eigen::Index{p}));
    }
    if (!box_of(places).intersects(reach)) continue;
    const Vec3 m = pose.direction(face.normal);
    for (Eigen::Index i = 0; i < face.shape->rows(); ++i) {
      const Vec3 y = places * face.shape->row(i).transpose();
      if (!reach.contains(y)) continue;
      if (evaluate(y, m, with_hessian, point)) visit(face, i, y, point);
    }
  }
}

double RigidContact::potential(const Eigen::VectorXd& q, const NodalVector& state,
                               NodalVector& force, Eigen::VectorXd& of_q) const {
  const PoseJet pose = pose_->evaluate(q, 1);
  double sum = 0;
  for_each_touched_point(
      pose, state, false,
      [&](const ContactSurface::Face& face, Eigen::Index i, const Vec3& y, const Point& point) {
        const double weight = face.weights[i];
        sum += weight * point.value;
        const Vec3 pull = weight * (pose.rotation * point.by_y);
        for (Eigen::Index a = 0; a < face.shape->cols(); ++a) {
          force.segment<3>(3 * Eigen::Index{face.nodes[a]}) += (*face.shape)(i, a) * pull;
        }
        of_q += weight * (pose.point_by(y).transpose() * point.by_y +
                          pose.direction_by(face.normal).transpose() * point.by_m);
      });
  return sum;
}

void RigidContact::add_hessian(const Eigen::VectorXd& q, const NodalVector& state,
                               PotentialHessian& hessian) const {
  const PoseJet pose = pose_->evaluate(q, 2);
  const int nodes = surface_->nodes_per_face();
  const int coordinates = pose.num_coordinates;
  const Index* last = nullptr;
  // The blocks of the face whose points are being visited.
  std::size_t first_of_points = 0;
  std::size_t first_mixed = 0;
  for_each_touched_point(
      pose, state, true,
      [&](const ContactSurface::Face& face, Eigen::Index i, const Vec3& y, const Point& point) {
        if (face.nodes != last) {
          last = face.nodes;
          first_of_points = hessian.of_points.size();
          first_mixed = hessian.mixed.size();
          for (int a = 0; a < nodes; ++a) {
            for (int b = 0; b <= a; ++b) {
              hessian.of_points.push_back({face.nodes[a], face.nodes[b], Mat3::Zero()});
            }
            hessian.mixed.push_back({face.nodes[a], 0, PoseColumns::Zero(3, coordinates)});
          }
        }
        const double weight = face.weights[i];
        const Mat3 of_place = weight * (pose.rotation * point.by_yy * pose.rotation.transpose());
        const CoordinatePart part = part_of_coordinates(pose, y, face.normal, point);
        const PoseColumns mixed = weight * part.mixed;
        std::size_t block = first_of_points;
        for (int a = 0; a < nodes; ++a) {
          const double share = (*face.shape)(i, a);
          const Mat3 of_a = share * of_place;
          for (int b = 0; b <= a; ++b) {
            hessian.of_points[block++].value += (*face.shape)(i, b) * of_a;
          }
          hessian.mixed[first_mixed + static_cast<std::size_t>(a)].value += share * mixed;
        }
        hessian.of_coordinates += weight * part.of_coordinates;
      });
}

PressedSurface RigidContact::pressed_surface(const Eigen::VectorXd& q,
                                             const NodalVector& state) const {
  PressedSurface result;
  const Index* last = nullptr;
  for_each_touched_point(
      pose_->evaluate(q, 0), state, false,
      [&](const ContactSurface::Face& face, Eigen::Index i, const Vec3&, const Point&) {
        result.area += face.weights[i];
        // The points of a face come one after the other.
        if (std::exchange(last, face.nodes) == face.nodes) return;
        result.faces.push_back({{face.nodes[0], face.nodes[1], face.nodes[2]}, face.longest_edge});
      });
  return result;
}

RigidContact::Patch RigidContact::patch(const Eigen::VectorXd& q, const NodalVector& state) const {
  Patch result;
  const std::size_t num_points = surface_->points().size();
  result.pressure.assign(num_points, 0);
  std::vector<double> areas(num_points, 0);
  const auto share = [&](const ContactSurface::Face& face, Eigen::Index i, int a) {
    // The shape functions of corners are negative near the middles of edges.
    return face.weights[i] * std::max((*face.shape)(i, a), 0.0);
  };
  for (Index f = 0; f < surface_->num_faces(); ++f) {
    const ContactSurface::Face face = surface_->face(f);
    for (Eigen::Index i = 0; i < face.shape->rows(); ++i) {
      for (int a = 0; a < surface_->nodes_per_face(); ++a) {
        areas[face.nodes[a]] += share(face, i, a);
      }
    }
  }
  double force = 0;
  double moment = 0;
  for_each_touched_point(
      pose_->evaluate(q, 0), state, false,
      [&](const ContactSurface::Face& face, Eigen::Index i, const Vec3&, const Point& point) {
        const double pressure = point.by_y.norm();
        force += face.weights[i] * pressure;
        moment += face.weights[i] * pressure * std::cbrt(pressure / law_.stiffness);
        result.area += face.weights[i];
        result.longest_edge = std::max(result.longest_edge, face.longest_edge);
        for (int a = 0; a < surface_->nodes_per_face(); ++a) {
          result.pressure[face.nodes[a]] += share(face, i, a) * pressure;
        }
      });
  for (std::size_t p = 0; p < num_points; ++p) {
    if (areas[p] > 0) result.pressure[p] /= areas[p];
  }
  if (force > 0) {
    result.layer_depth = law_.reach() - kMeanOfHertz * law_.thickness * moment / force;
  }
  return result;
}

double contact_layer_force(double layer_depth, const Vec3& force, const Mat3& stiffness) {
  const double size = force.norm();
  if (size == 0) return 0;
  const double along = force.dot(stiffness * force) / (size * size);
  if (!(along > 0)) return std::numeric_limits<double>::quiet_NaN();
  const double share = layer_depth * along / (1.5 * size);
  return size * (1 - std::pow(std::max(1 - share, 0.0), 1.5));
}

}  // namespace palpate
