// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/domain_integral.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "elements/tetrahedron.h"
#include "mesh/cell_faces.h"
#include "solvers/support/closed_form.h"

namespace palpate::test {
namespace {

/// Places and weights of a rule on a triangle that is exact for the second degree.
constexpr double kNear = 1.0 / 6;
constexpr double kFar = 2.0 / 3;

struct Weight {
  double value = 0;
  Vec3 gradient = Vec3::Zero();
};

/// The energy density and Σ at a place of a cell.
struct Local {
  double energy = 0;
  Mat3 eshelby;
};

class Cell {
 public:
  Cell(const Scene& scene, const NodalVector& u, Index cell) : scene_(scene), cell_(cell) {
    const Index* points = scene.body.mesh.cell(cell);
    const Index nodes = nodes_per_cell(scene.body.mesh.order);
    displacement_.resize(3, nodes);
    for (Index k = 0; k < nodes; ++k) displacement_.col(k) = u.segment<3>(3 * points[k]);
    first_ = scene.body.mesh.points[points[0]];
    for (int k = 0; k < 3; ++k) sides_.col(k) = scene.body.mesh.points[points[k + 1]] - first_;
  }

  [[nodiscard]] double jacobian() const { return sides_.determinant(); }
  [[nodiscard]] Vec3 place(const Vec3& xi) const { return first_ + sides_ * xi; }

  [[nodiscard]] Local at(const Vec3& xi) const {
    const auto by_reference = shape_gradients(scene_.body.mesh.order, xi);
    const Mat3 h = displacement_ * by_reference * sides_.inverse();
    const Point point = evaluate(scene_.material_of(cell_), Mat3(h + Mat3::Identity()), 0);
    return {point.energy, point.energy * Mat3::Identity() - h.transpose() * point.stress};
  }

 private:
  const Scene& scene_;
  Index cell_;
  Eigen::Matrix3Xd displacement_;
  Vec3 first_;
  Mat3 sides_;
};

double distance_to(const std::pair<Vec3, Vec3>& edge, const Vec3& place, Vec3& away) {
  const Vec3 along = edge.second - edge.first;
  const double share = std::clamp((place - edge.first).dot(along) / along.squaredNorm(), 0.0, 1.0);
  away = place - edge.first - share * along;
  return away.norm();
}

Weight weight_at(const CutFront& front, const Vec3& place, double reach) {
  double nearest = reach;
  Vec3 away = Vec3::Zero();
  for (const auto& edge : front.edges) {
    Vec3 from_this;
    const double distance = distance_to(edge, place, from_this);
    if (distance >= nearest) continue;
    nearest = distance;
    away = from_this;
  }
  if (nearest >= reach) return {};
  if (nearest <= 0.5 * reach) return {1, Vec3::Zero()};
  const double x = 2 * nearest / reach - 1;
  return {1 - x * x * (3 - 2 * x), -6 * x * (1 - x) * 2 / reach * away / nearest};
}

}  // namespace

double CutFront::distance(const Vec3& place) const {
  double nearest = INFINITY;
  Vec3 away;
  for (const auto& edge : edges) nearest = std::min(nearest, distance_to(edge, place, away));
  return nearest;
}

CutFront find_front(const TetMesh& closed, const std::vector<OpenedFaces>& faces, int stage) {
  // The corner opposite to each edge of the sheet, on its open side and on the other.
  std::map<EdgeKey, std::pair<Index, Index>> sides;
  for (Index c = 0; c < closed.num_cells(); ++c) {
    for (int k = 0; k < 4; ++k) {
      if (faces[c][k] == 0) continue;
      const FaceKey face = face_opposite(closed.cell(c), k);
      for (int e = 0; e < 3; ++e) {
        auto& [open, still] =
            sides.emplace(edge_of(face[e], face[(e + 1) % 3]), std::pair<Index, Index>(-1, -1))
                .first->second;
        (is_open(faces[c][k], stage) ? open : still) = face[(e + 2) % 3];
      }
    }
  }
  CutFront front;
  for (const auto& [edge, opposite] : sides) {
    const auto& [open, still] = opposite;
    if (open < 0 || still < 0) continue;
    const Vec3& a = closed.points[edge.first];
    const Vec3& b = closed.points[edge.second];
    front.edges.emplace_back(a, b);
    const Vec3 along = (b - a).normalized();
    Vec3 ahead = closed.points[still] - closed.points[open];
    ahead -= ahead.dot(along) * along;
    front.direction += (b - a).norm() * ahead.normalized();
  }
  front.direction.normalize();
  for (const auto& [a, b] : front.edges) {
    front.length += ((b - a) - (b - a).dot(front.direction) * front.direction).norm();
  }
  return front;
}

double release_rate(const Scene& scene, const NodalVector& u, const CutFront& front, double reach) {
  const TetMesh& mesh = scene.body.mesh;
  double sum = 0;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Cell cell(scene, u, c);
    for (const QuadraturePoint& q : fine_quadrature()) {
      const Weight weight = weight_at(front, cell.place(q.xi), reach);
      if (weight.gradient.isZero(0)) continue;
      sum -=
          q.weight * cell.jacobian() * front.direction.dot(cell.at(q.xi).eshelby * weight.gradient);
    }
  }
  const std::vector<CellFace> all = sorted_faces(mesh);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i + 1 < all.size() && all[i + 1].corners == all[i].corners) {
      ++i;
      continue;
    }
    const Cell cell(scene, u, all[i].cell);
    const auto corner = [](int k) { return k == 0 ? Vec3(Vec3::Zero()) : Vec3(Vec3::Unit(k - 1)); };
    std::array<Vec3, 3> at;
    for (int k = 0, n = 0; k < 4; ++k) {
      if (k != all[i].opposite) at[n++] = corner(k);
    }
    const Vec3 a = cell.place(at[0]);
    Vec3 area = 0.5 * (cell.place(at[1]) - a).cross(cell.place(at[2]) - a);
    if (area.dot(cell.place(corner(all[i].opposite)) - a) > 0) area = -area;
    for (int k = 0; k < 3; ++k) {
      const Vec3 xi = kFar * at[k] + kNear * (at[(k + 1) % 3] + at[(k + 2) % 3]);
      const Weight weight = weight_at(front, cell.place(xi), reach);
      if (weight.value == 0) continue;
      sum += cell.at(xi).energy * weight.value * area.dot(front.direction) / 3;
    }
  }
  return sum / front.length;
}

}  // namespace palpate::test
