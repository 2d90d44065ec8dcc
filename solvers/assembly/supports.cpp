// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/supports.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "assembly/loaded_faces.h"
#include "base/error.h"
#include "base/quantity.h"
#include "mesh/pieces.h"

namespace palpate {
namespace {

/// Directions that are orthonormal to this tolerance are not changed by a bit.
constexpr double kOrthonormal = 1e-14;
/// A second direction counts as the first if the sine of the angle between them is at most this.
constexpr double kSameDirection = 1e-6;
/// A direction counts as one that a point is held along if so much of its length lies within those
/// of the point: the normals of neighbouring points of a round surface differ by less.
constexpr double kSharedDirection = 0.9;
/// A rigid motion whose resistance is below this share of the largest one is free. Resistances are
/// squares of lengths, so held points must lie 1e-5 of the body's size off a line.
constexpr double kFreeMotion = 1e-10;
/// A rim lies in a plane if it deviates from the plane by less than this share of the length of its
/// edges.
constexpr double kInPlane = 1e-6;

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

std::string text_of(const Vec3& v) {
  // −0 and components that are only rounding become 0.
  const auto rounded = [&](double x) { return std::abs(x) < 1e-9 * v.norm() ? 0.0 : x; };
  return quantity(Vec3(v.unaryExpr(rounded)));
}

std::string at_point(const Body& body, Index point) {
  return "point " + std::to_string(point) + " at " + text_of(body.mesh.points[point]) + " m";
}

bool is_zero(double number) { return number == 0; }
template <class Derived>
bool is_zero(const Eigen::MatrixBase<Derived>& values) {
  return values.isZero(0);
}
bool is_finite(double number) { return std::isfinite(number); }
template <class Derived>
bool is_finite(const Eigen::MatrixBase<Derived>& values) {
  return values.allFinite();
}

/// @throws InputError the array has another size, or an entry that is not finite.
template <class T>
void check_array(const Body& body, const char* name, std::vector<T>& array) {
  if (array.empty()) return;
  if (array.size() != body.mesh.points.size()) {
    throw InputError(std::string("The array ") + name + " needs one value for each of the " +
                     std::to_string(body.mesh.points.size()) + " points.");
  }
  for (std::size_t p = 0; p < array.size(); ++p) {
    if (is_finite(array[p])) continue;
    throw InputError(std::string("The array ") + name + " is no number at " +
                     at_point(body, static_cast<Index>(p)) + ". Give every point one.");
  }
  const bool has_none =
      std::all_of(array.begin(), array.end(), [](const T& value) { return is_zero(value); });
  if (has_none) array.clear();
}

void make_orthonormal(HeldDirections& held) {
  if (held.col(0).isZero(0)) held.col(0).swap(held.col(1));
  if (held.col(0).isZero(0)) return;
  if (std::abs(held.col(0).norm() - 1) > kOrthonormal) held.col(0).normalize();
  if (held.col(1).isZero(0)) return;
  if (std::abs(held.col(1).norm() - 1) > kOrthonormal) held.col(1).normalize();
  const double along = held.col(0).dot(held.col(1));
  if (std::abs(along) <= kOrthonormal) return;
  held.col(1) -= along * held.col(0);
  if (held.col(1).norm() <= kSameDirection) {
    held.col(1).setZero();
  } else {
    held.col(1).normalize();
  }
}

[[noreturn]] void throw_no_face(const char* name) {
  throw InputError(std::string("No face of the surface has ") + name +
                   " at all of its three corners, so that it acts nowhere. Give it to the corners "
                   "of whole faces.");
}

/// 1 for each point on springs [num_points].
std::vector<char> points_on_springs(const Body& body) {
  std::vector<char> on_springs(body.mesh.points.size(), 0);
  for (const Index p : faces_with(body.mesh, body.support_stiffness)) on_springs[p] = 1;
  return on_springs;
}

bool has_directions(const Body& body, Index point) {
  return !body.held_directions.empty() && !body.held_directions[point].isZero(0);
}

/// The resistance of supports against the rigid motions of a piece: translations, and rotations
/// about its centre that move points at `radius` by a unit.
struct Resistance {
  Vec3 middle = Vec3::Zero();
  Index num_points = 0;
  double radius = 0;
  Mat6 gram = Mat6::Zero();
  /// Whether the piece has supports besides fixed points.
  bool has_supports = false;

  void hold(const Vec3& at, const Vec3& along) {
    Vec6 row;
    row << along, (at - middle).cross(along) / radius;
    gram += row * row.transpose();
  }
};

/// Describes a free motion, given a basis of the free ones.
std::string describe_free(const Resistance& of,
                          const Eigen::Matrix<double, 6, Eigen::Dynamic>& free) {
  // Combinations of the motions without rotation.
  const Eigen::JacobiSVD<Eigen::MatrixXd> turns(free.bottomRows<3>(), Eigen::ComputeFullV);
  Eigen::Index rank = 0;
  while (rank < turns.singularValues().size() && turns.singularValues()[rank] > 1e-4) ++rank;
  if (rank < free.cols()) {
    const Vec3 way = free.topRows<3>() * turns.matrixV().col(free.cols() - 1);
    return "moves freely along " + text_of(way.normalized());
  }
  const Vec3 move = free.col(0).head<3>();
  const Vec3 turn = free.col(0).tail<3>() / of.radius;
  const Vec3 centre = of.middle + turn.cross(move) / turn.squaredNorm();
  return "turns freely about " + text_of(turn.normalized()) + " through " + text_of(centre) + " m";
}

/// @throws InputError a piece with directions or springs can move rigidly.
void check_held(const Body& body) {
  const TetMesh& mesh = body.mesh;
  const Pieces pieces = find_pieces(mesh);
  const std::vector<Index> piece_of = piece_of_points(mesh, pieces);
  std::vector<Resistance> resistances(pieces.each.size());
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (piece_of[p] < 0) continue;
    Resistance& piece = resistances[piece_of[p]];
    piece.middle += mesh.points[p];
    ++piece.num_points;
  }
  for (Resistance& piece : resistances) piece.middle /= piece.num_points;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (piece_of[p] < 0) continue;
    Resistance& piece = resistances[piece_of[p]];
    piece.radius = std::max(piece.radius, (mesh.points[p] - piece.middle).norm());
  }
  const std::vector<char> on_springs = points_on_springs(body);
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (piece_of[p] < 0) continue;
    Resistance& piece = resistances[piece_of[p]];
    if (body.fixed[p] != 0 || on_springs[p] != 0) {
      for (int axis = 0; axis < 3; ++axis) piece.hold(mesh.points[p], Vec3::Unit(axis));
    } else if (has_directions(body, p)) {
      for (int i = 0; i < 2; ++i) piece.hold(mesh.points[p], body.held_directions[p].col(i));
    }
    piece.has_supports = piece.has_supports || on_springs[p] != 0 || has_directions(body, p);
  }
  for (std::size_t i = 0; i < resistances.size(); ++i) {
    const Resistance& piece = resistances[i];
    if (!piece.has_supports) continue;
    const Eigen::SelfAdjointEigenSolver<Mat6> motions(piece.gram);
    const Vec6& resists = motions.eigenvalues();
    const Eigen::Index num_free = (resists.array() <= kFreeMotion * resists[5]).count();
    if (num_free == 0) continue;
    throw InputError("The piece of the body of " + describe(pieces.each[i]) + ' ' +
                     describe_free(piece, motions.eigenvectors().leftCols(num_free)) +
                     ". Hold it there too with Set Boundary: fix points, hold some along a "
                     "direction, or give it springs.");
  }
}

/// The edges that belong to one of the faces only: their nodes, in the order of boundary_faces().
std::vector<std::vector<Index>> rim_of(const std::vector<Index>& faces, ElementOrder order) {
  const int nodes = nodes_per_face(order);
  std::map<std::pair<Index, Index>, std::pair<int, std::vector<Index>>> edges;
  for (std::size_t f = 0; f < faces.size(); f += nodes) {
    for (int i = 0; i < 3; ++i) {
      const Index a = faces[f + i];
      const Index b = faces[f + (i + 1) % 3];
      auto& [turns, of_edge] = edges[std::minmax(a, b)];
      turns += a < b ? 1 : -1;
      of_edge = {a, b};
      if (order == ElementOrder::quadratic) of_edge.push_back(faces[f + 3 + i]);
    }
  }
  std::vector<std::vector<Index>> rim;
  for (auto& [key, edge] : edges) {
    if (edge.first != 0) rim.push_back(std::move(edge.second));
  }
  return rim;
}

/// Whether an edge cannot move, slides in its plane, or moves along one line.
bool is_led(const Body& body, const std::vector<Index>& edge) {
  Mat3 free = Mat3::Zero();
  for (const Index p : edge) {
    if (body.fixed[p] != 0) continue;
    free += body.held_directions.empty() ? Mat3::Identity() : projector(body.held_directions[p]);
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(free);
  const Eigen::Index num_held = (axes.eigenvalues().array() <= kInPlane).count();
  if (num_held != 1) return num_held > 1;
  const Vec3 normal = axes.eigenvectors().col(0);
  const std::vector<Vec3>& points = body.mesh.points;
  const double length = (points[edge[1]] - points[edge[0]]).norm();
  return std::all_of(edge.begin(), edge.end(), [&](Index p) {
    return std::abs(normal.dot(points[p] - points[edge[0]])) <= kInPlane * length;
  });
}

}  // namespace

std::vector<char> holding_points(const Body& body) {
  std::vector<char> holds = body.fixed;
  if (!body.has_supports()) return holds;
  const std::vector<Index> piece_of = piece_of_points(body.mesh, find_pieces(body.mesh));
  const std::vector<char> on_springs = points_on_springs(body);
  std::vector<char> has_supports(body.mesh.points.size(), 0);
  for (Index p = 0; p < body.mesh.num_points(); ++p) {
    if (piece_of[p] < 0) continue;
    if (on_springs[p] != 0 || has_directions(body, p)) has_supports[piece_of[p]] = 1;
  }
  for (Index p = 0; p < body.mesh.num_points(); ++p) {
    if (piece_of[p] >= 0 && has_supports[piece_of[p]] != 0) holds[p] = 1;
  }
  return holds;
}

Mat3 held_space(const Body& body, Index point) {
  if (body.fixed[point] != 0) return Mat3::Identity();
  if (body.held_directions.empty()) return Mat3::Zero();
  return body.held_directions[point] * body.held_directions[point].transpose();
}

Mat3 common_directions(const Body& body, const std::vector<Index>& points) {
  Mat3 sum = Mat3::Zero();
  for (const Index p : points) sum += held_space(body, p);
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(sum);
  Mat3 common = Mat3::Zero();
  int count = 0;
  for (int i = 2; i >= 0; --i) {
    const Vec3 axis = axes.eigenvectors().col(i);
    const bool is_common = std::all_of(points.begin(), points.end(), [&](Index p) {
      return (held_space(body, p) * axis).norm() >= kSharedDirection;
    });
    if (is_common) common.col(count++) = axis;
  }
  return common;
}

void hold_along(const Vec3& direction, HeldDirections& held, char& fixed) {
  make_orthonormal(held);
  const Vec3 left = projector(held) * direction.normalized();
  if (fixed != 0 || left.norm() <= kSameDirection) return;
  if (held.col(0).isZero(0)) {
    held.col(0) = left.normalized();
  } else if (held.col(1).isZero(0)) {
    held.col(1) = left.normalized();
  } else {
    held.setZero();
    fixed = 1;
  }
}

void check_supports(Body& body) {
  if (!body.has_supports()) return;
  check_array(body, "HeldDirection", body.held_directions);
  check_array(body, "SupportStiffness", body.support_stiffness);
  const std::vector<char> used = points_in_use(body.mesh);
  for (std::size_t p = 0; p < body.held_directions.size(); ++p) {
    HeldDirections& held = body.held_directions[p];
    if (used[p] == 0 || body.fixed[p] != 0) held.setZero();
    make_orthonormal(held);
  }
  check_array(body, "HeldDirection", body.held_directions);
  for (std::size_t p = 0; p < body.support_stiffness.size(); ++p) {
    if (body.support_stiffness[p] >= 0) continue;
    throw InputError("SupportStiffness is negative at " + at_point(body, static_cast<Index>(p)) +
                     ". Give a stiffness above 0 N/m³, or 0 where there are no springs.");
  }
  if (!body.support_stiffness.empty() && faces_with(body.mesh, body.support_stiffness).empty()) {
    throw_no_face("SupportStiffness");
  }
  if (body.has_supports()) check_held(body);
}

void check_surface_loads(Body& body) {
  check_array(body, "AppliedPressure", body.applied_pressure);
  check_array(body, "AppliedTraction", body.applied_traction);
  if (!body.applied_traction.empty() && faces_with(body.mesh, body.applied_traction).empty()) {
    throw_no_face("AppliedTraction");
  }
  if (body.applied_pressure.empty()) return;
  const std::vector<Index> faces = faces_under_pressure(body.mesh, body.applied_pressure);
  if (faces.empty()) throw_no_face("the same AppliedPressure");
  for (const std::vector<Index>& edge : rim_of(faces, body.mesh.order)) {
    if (is_led(body, edge)) continue;
    throw InputError(
        "The rim of the surface under AppliedPressure is free to move at " +
        at_point(body, edge.front()) +
        ". There a pressure that follows the surface has no energy, and no symmetric tangent. Fix "
        "the rim, hold it along the normal of the plane in which it lies, close the surface, or "
        "give it AppliedTraction instead, which does not follow the surface.");
  }
}

}  // namespace palpate
