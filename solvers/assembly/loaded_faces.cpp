// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/loaded_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {
namespace {

FacePoint face_point(ElementOrder order, double weight, double xi, double eta) {
  FacePoint point;
  point.weight = weight;
  point.of_corners = Vec3(1 - xi - eta, xi, eta);
  const Vec3& l = point.of_corners;
  Eigen::Matrix<double, 3, 2> slopes;
  slopes << -1, -1, 1, 0, 0, 1;
  if (order == ElementOrder::linear) {
    point.values = l;
    point.slopes = slopes;
    return point;
  }
  point.values.resize(6);
  point.slopes.resize(6, 2);
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    point.values[a] = l[a] * (2 * l[a] - 1);
    point.slopes.row(a) = (4 * l[a] - 1) * slopes.row(a);
    point.values[3 + a] = 4 * l[a] * l[b];
    point.slopes.row(3 + a) = 4 * (l[a] * slopes.row(b) + l[b] * slopes.row(a));
  }
  return point;
}

}  // namespace

Eigen::Matrix3Xd places_of_face(const TetMesh& mesh, const Index* nodes) {
  Eigen::Matrix3Xd places(3, nodes_per_face(mesh.order));
  for (Eigen::Index a = 0; a < places.cols(); ++a) places.col(a) = mesh.points[nodes[a]];
  return places;
}

double area_at(const FacePoint& point, const Eigen::Matrix3Xd& places) {
  const Eigen::Matrix<double, 3, 2> t = places * point.slopes;
  return point.weight * t.col(0).cross(t.col(1)).norm();
}

std::vector<FacePoint> face_quadrature(ElementOrder order) {
  std::vector<FacePoint> points{face_point(order, 9.0 / 80, 1.0 / 3, 1.0 / 3)};
  for (const double sign : {1.0, -1.0}) {
    const double a = (6 + sign * std::sqrt(15)) / 21;
    const double weight = (155 + sign * std::sqrt(15)) / 2400;
    points.push_back(face_point(order, weight, a, a));
    points.push_back(face_point(order, weight, 1 - 2 * a, a));
    points.push_back(face_point(order, weight, a, 1 - 2 * a));
  }
  return points;
}

std::vector<FacePoint> divided_quadrature(ElementOrder order, int divisions) {
  /// Barycentric coordinates of a point, and its share of the area.
  struct RulePoint {
    double a, b, share;
  };
  constexpr double kNear = 0.445948490915965;
  constexpr double kNearShare = 0.223381589678011;
  constexpr double kFar = 0.091576213509771;
  constexpr double kFarShare = 0.109951743655322;
  constexpr RulePoint kRule[6] = {
      {kNear, kNear, kNearShare},         {1 - 2 * kNear, kNear, kNearShare},
      {kNear, 1 - 2 * kNear, kNearShare}, {kFar, kFar, kFarShare},
      {1 - 2 * kFar, kFar, kFarShare},    {kFar, 1 - 2 * kFar, kFarShare}};
  const double side = 1.0 / divisions;
  std::vector<FacePoint> points;
  points.reserve(6 * static_cast<std::size_t>(divisions) * static_cast<std::size_t>(divisions));
  for (int i = 0; i < divisions; ++i) {
    for (int j = 0; i + j < divisions; ++j) {
      for (const bool is_turned : {false, true}) {
        if (is_turned && i + j + 1 == divisions) continue;
        for (const RulePoint& p : kRule) {
          const double a = is_turned ? 1 - p.a : p.a;
          const double b = is_turned ? 1 - p.b : p.b;
          const double weight = 0.5 * (side * side * p.share);
          points.push_back(face_point(order, weight, side * (i + a), side * (j + b)));
        }
      }
    }
  }
  return points;
}

std::vector<Index> faces_where(const TetMesh& mesh,
                               const std::function<bool(const Index* corners)>& holds) {
  const std::vector<Index> all = boundary_faces(mesh);
  const int nodes = nodes_per_face(mesh.order);
  std::vector<Index> chosen;
  for (auto face = all.begin(); face != all.end(); face += nodes) {
    if (holds(&*face)) chosen.insert(chosen.end(), face, face + nodes);
  }
  return chosen;
}

namespace {

template <class Value>
bool all_other_than(const Value& none, const std::vector<Value>& array, const Index* corners) {
  return std::all_of(corners, corners + 3, [&](Index p) { return array[p] != none; });
}

}  // namespace

bool is_under_pressure(const std::vector<double>& pressure, const Index* corners) {
  const double first = pressure[corners[0]];
  return first != 0 && first == pressure[corners[1]] && first == pressure[corners[2]];
}

bool has_traction(const std::vector<Vec3>& traction, const Index* corners) {
  return all_other_than(Vec3(Vec3::Zero()), traction, corners);
}

std::vector<Index> faces_with(const TetMesh& mesh, const std::vector<double>& array) {
  if (array.empty()) return {};
  return faces_where(mesh, [&](const Index* c) { return all_other_than(0.0, array, c); });
}

std::vector<Index> faces_with(const TetMesh& mesh, const std::vector<Vec3>& array) {
  if (array.empty()) return {};
  return faces_where(mesh, [&](const Index* c) { return has_traction(array, c); });
}

std::vector<Index> faces_under_pressure(const TetMesh& mesh, const std::vector<double>& pressure) {
  if (pressure.empty()) return {};
  return faces_where(mesh, [&](const Index* c) { return is_under_pressure(pressure, c); });
}

double area_of(const TetMesh& mesh, const std::vector<Index>& faces) {
  const std::vector<FacePoint> rule = face_quadrature(mesh.order);
  const int nodes = nodes_per_face(mesh.order);
  double area = 0;
  for (std::size_t first = 0; first < faces.size(); first += nodes) {
    const Eigen::Matrix3Xd x = places_of_face(mesh, &faces[first]);
    for (const FacePoint& point : rule) area += area_at(point, x);
  }
  return area;
}

std::vector<Vec3> normals_at(const TetMesh& mesh, const std::vector<Index>& faces) {
  std::vector<Vec3> normals(mesh.points.size(), Vec3::Zero());
  const int nodes = nodes_per_face(mesh.order);
  for (std::size_t first = 0; first < faces.size(); first += nodes) {
    const Vec3& origin = mesh.points[faces[first]];
    const Vec3 normal =
        (mesh.points[faces[first + 1]] - origin).cross(mesh.points[faces[first + 2]] - origin);
    for (int a = 0; a < nodes; ++a) normals[faces[first + a]] += normal;
  }
  return normals;
}

std::vector<char> points_of_cavities(const TetMesh& mesh) {
  std::vector<Index> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  const std::vector<Index> faces = boundary_faces(mesh);
  const int nodes = nodes_per_face(mesh.order);
  for (std::size_t first = 0; first < faces.size(); first += nodes) {
    for (int a = 1; a < nodes; ++a) parent[root(faces[first + a])] = root(faces[first]);
  }
  // Faces point out of the body, and so into a cavity: the volume that the faces of a cavity
  // enclose is negative.
  std::vector<double> volume(mesh.points.size(), 0);
  for (std::size_t first = 0; first < faces.size(); first += nodes) {
    const Index part = root(faces[first]);
    const Vec3& origin = mesh.points[part];
    const Vec3 a = mesh.points[faces[first]] - origin;
    const Vec3 b = mesh.points[faces[first + 1]] - origin;
    const Vec3 c = mesh.points[faces[first + 2]] - origin;
    volume[part] += a.dot(b.cross(c)) / 6;
  }
  std::vector<char> chosen(mesh.points.size(), 0);
  for (Index p = 0; p < mesh.num_points(); ++p) chosen[p] = volume[root(p)] < 0 ? 1 : 0;
  return chosen;
}

}  // namespace palpate
