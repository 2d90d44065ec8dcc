// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/loaded_faces.h"

#include <cmath>

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

std::vector<Index> faces_with(const TetMesh& mesh, const std::vector<double>& array) {
  if (array.empty()) return {};
  return faces_where(mesh, [&](const Index* c) {
    return array[c[0]] != 0 && array[c[1]] != 0 && array[c[2]] != 0;
  });
}

std::vector<Index> faces_with(const TetMesh& mesh, const std::vector<Vec3>& array) {
  if (array.empty()) return {};
  return faces_where(mesh, [&](const Index* c) {
    return !array[c[0]].isZero(0) && !array[c[1]].isZero(0) && !array[c[2]].isZero(0);
  });
}

std::vector<Index> faces_under_pressure(const TetMesh& mesh, const std::vector<double>& pressure) {
  if (pressure.empty()) return {};
  return faces_where(mesh, [&](const Index* c) {
    return pressure[c[0]] != 0 && pressure[c[0]] == pressure[c[1]] &&
           pressure[c[0]] == pressure[c[2]];
  });
}

}  // namespace palpate
