// SPDX-License-Identifier: BSD-3-Clause
#include "elements/inversion.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

namespace palpate {
namespace {

/// After this many bisections a part of a cell is as small as a point.
constexpr int kMaxHalvings = 60;

/// The node in the middle of the edge between two corners.
constexpr int kMiddle[4][4] = {{-1, 4, 6, 7}, {4, -1, 5, 8}, {6, 5, -1, 9}, {7, 8, 9, -1}};

Mat3 cross(const Mat3& a, const Mat3& b) {
  Mat3 product;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3;
      const int i2 = (i + 2) % 3;
      const int j1 = (j + 1) % 3;
      const int j2 = (j + 2) % 3;
      product(i, j) = a(i1, j1) * b(i2, j2) - a(i1, j2) * b(i2, j1) + a(i2, j2) * b(i1, j1) -
                      a(i2, j1) * b(i1, j2);
    }
  }
  return product;
}

/// The least Bézier coefficient of the determinant, times six.
double least_bezier_coefficient(const CornerJacobians& j) {
  double least = cross(j[0], j[0]).cwiseProduct(j[0]).sum();
  for (int a = 0; a < 4; ++a) {
    for (int b = a; b < 4; ++b) {
      const Mat3 product = cross(j[a], j[b]);
      for (int c = b; c < 4; ++c) least = std::min(least, product.cwiseProduct(j[c]).sum());
    }
  }
  return least;
}

/// A part of a cell: ∂x/∂ξ at its corners, and their barycentric coordinates.
struct Part {
  CornerJacobians jacobians;
  std::array<Eigen::Vector4d, 4> places;
};

std::optional<Eigen::Vector4d> find_inversion(const Part& part, int halvings) {
  const CornerJacobians& j = part.jacobians;
  for (int a = 0; a < 4; ++a) {
    if (!(j[a].determinant() > 0)) return part.places[a];
  }
  if (least_bezier_coefficient(j) > 0) return std::nullopt;
  if (halvings == 0) return part.places[0];
  int from = 0;
  int to = 1;
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) {
      if ((j[a] - j[b]).squaredNorm() > (j[from] - j[to]).squaredNorm()) {
        from = a;
        to = b;
      }
    }
  }
  for (const auto& [kept, moved] : {std::pair{from, to}, std::pair{to, from}}) {
    Part half = part;
    half.jacobians[moved] = (j[kept] + j[moved]) / 2;
    half.places[moved] = (part.places[kept] + part.places[moved]) / 2;
    if (const auto found = find_inversion(half, halvings - 1)) return found;
  }
  return std::nullopt;
}

/// Whether all J_a are so near to J_0 that no mean of them is singular: a cheap sufficient test.
bool are_alike(const CornerJacobians& j) {
  const Mat3 inverse = j[0].inverse();
  return j[0].determinant() > 0 && std::all_of(j.begin() + 1, j.end(), [&](const Mat3& of_corner) {
           return (of_corner * inverse - Mat3::Identity()).squaredNorm() < 0.99;
         });
}

}  // namespace

CornerJacobians corner_jacobians(const std::array<Vec3, 10>& x) {
  CornerJacobians jacobians;
  for (int corner = 0; corner < 4; ++corner) {
    // The derivative along the edge to another corner.
    const auto along = [&](int other) -> Vec3 {
      if (other == corner) return Vec3::Zero();
      return 4 * x[kMiddle[corner][other]] - 3 * x[corner] - x[other];
    };
    const Vec3 to_first = along(0);
    for (int i = 0; i < 3; ++i) jacobians[corner].col(i) = along(i + 1) - to_first;
  }
  return jacobians;
}

std::optional<Eigen::Vector4d> find_inversion(const CornerJacobians& jacobians) {
  if (are_alike(jacobians)) return std::nullopt;
  Part whole{jacobians, {}};
  for (int a = 0; a < 4; ++a) whole.places[a] = Eigen::Vector4d::Unit(a);
  return find_inversion(whole, kMaxHalvings);
}

double determinant(const CornerJacobians& jacobians, const Eigen::Vector4d& place) {
  Mat3 at_place = Mat3::Zero();
  for (int a = 0; a < 4; ++a) at_place += place[a] * jacobians[a];
  return at_place.determinant();
}

}  // namespace palpate
