// SPDX-License-Identifier: BSD-3-Clause
#include "elements/tetrahedron.h"

#include <array>
#include <cmath>

namespace palpate {
namespace {

/// Barycentric coordinates of the four points of degree 2: with respect to the nearest corner, and
/// to the other three.
const double kNear = (5 + 3 * std::sqrt(5.0)) / 20;
const double kFar = (5 - std::sqrt(5.0)) / 20;

std::array<double, 4> barycentric(const Vec3& xi) { return {1 - xi.sum(), xi[0], xi[1], xi[2]}; }

/// ∂λ_a/∂ξ.
Vec3 barycentric_gradient(int a) {
  if (a == 0) return Vec3::Constant(-1);
  return Vec3::Unit(a - 1);
}

}  // namespace

const std::vector<QuadraturePoint>& quadrature(ElementOrder order) {
  static const std::vector<QuadraturePoint> one{{Vec3::Constant(0.25), 1.0 / 6}};
  static const std::vector<QuadraturePoint> four{{{kFar, kFar, kFar}, 1.0 / 24},
                                                 {{kNear, kFar, kFar}, 1.0 / 24},
                                                 {{kFar, kNear, kFar}, 1.0 / 24},
                                                 {{kFar, kFar, kNear}, 1.0 / 24}};
  return order == ElementOrder::linear ? one : four;
}

const std::vector<QuadraturePoint>& fine_quadrature() {
  static const std::vector<QuadraturePoint> points = [] {
    std::vector<QuadraturePoint> all{{Vec3::Constant(0.25), 0.030283678097089181}};
    // Adds the four points that have `one` as one barycentric coordinate and `three` as the others,
    // beginning with the coordinate of corner 0.
    const auto add_four = [&](double three, double one, double weight) {
      all.push_back({Vec3::Constant(three), weight});
      for (int i = 0; i < 3; ++i) {
        Vec3 xi = Vec3::Constant(three);
        xi[i] = one;
        all.push_back({xi, weight});
      }
    };
    add_four(1.0 / 3, 0, 27.0 / 4480);
    add_four(1.0 / 11, 8.0 / 11, 0.011645249086028974);
    const double a = 0.066550153573664281;
    const double b = 0.43344984642633573;
    for (int i = 0; i < 3; ++i) {
      Vec3 xi = Vec3::Constant(a);
      xi[i] = b;
      all.push_back({xi, 0.010949141561386449});
      all.push_back({Vec3::Constant(a + b) - xi, 0.010949141561386449});
    }
    return all;
  }();
  return points;
}

Eigen::Matrix<double, Eigen::Dynamic, 3> shape_gradients(ElementOrder order, const Vec3& xi) {
  Eigen::Matrix<double, Eigen::Dynamic, 3> gradients(nodes_per_cell(order), 3);
  const auto lambda = barycentric(xi);
  for (int a = 0; a < 4; ++a) {
    const double factor = order == ElementOrder::linear ? 1 : 4 * lambda[a] - 1;
    gradients.row(a) = factor * barycentric_gradient(a).transpose();
  }
  if (order == ElementOrder::quadratic) {
    for (int e = 0; e < 6; ++e) {
      const auto [a, b] = kTetEdges[e];
      gradients.row(4 + e) =
          4 *
          (lambda[a] * barycentric_gradient(b) + lambda[b] * barycentric_gradient(a)).transpose();
    }
  }
  return gradients;
}

Eigen::VectorXd shape_values(ElementOrder order, const Vec3& xi) {
  Eigen::VectorXd values(nodes_per_cell(order));
  const auto lambda = barycentric(xi);
  for (int a = 0; a < 4; ++a) {
    values[a] = order == ElementOrder::linear ? lambda[a] : lambda[a] * (2 * lambda[a] - 1);
  }
  if (order == ElementOrder::quadratic) {
    for (int e = 0; e < 6; ++e)
      values[4 + e] = 4 * lambda[kTetEdges[e][0]] * lambda[kTetEdges[e][1]];
  }
  return values;
}

}  // namespace palpate
