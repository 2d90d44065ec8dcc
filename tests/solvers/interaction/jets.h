// SPDX-License-Identifier: BSD-3-Clause
// Checks of the jets of rigid shapes.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "interaction/rigid_shape.h"
#include "solvers/support/finite_difference.h"

namespace palpate::test {

using Jet = RigidShape::Jet;

/// ∇³d as one matrix: the derivative of the Hessian along an axis.
inline Mat3 third_along(const Jet& jet, int axis) {
  constexpr int kPlace[3][3][3] = {{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}},
                                   {{1, 3, 4}, {3, 6, 7}, {4, 7, 8}},
                                   {{2, 4, 5}, {4, 7, 8}, {5, 8, 9}}};
  Mat3 m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) = jet.third[kPlace[axis][i][j]];
  }
  return m;
}

/// The derivatives are those of the value at a place.
/// @param step Of the differences, m: on both sides of the place by that much the shape is smooth,
/// or
///   the tolerance knows that it is not.
/// @param tolerance Of the gradient; that of the Hessian in units of 1/length and that of the third
///   derivative in 1/length² is the same.
inline void expect_consistent(const RigidShape& shape, const Vec3& place, double step,
                              double length, double tolerance) {
  const Jet jet = shape.evaluate(place);
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = [&](double t) { return shape.evaluate(place + t * Vec3::Unit(axis)); };
    const double slope = derivative([&](double t) { return at(t).value; }, step);
    const Vec3 row = derivative([&](double t) { return at(t).gradient; }, step);
    const Mat3 third = derivative([&](double t) { return at(t).hessian; }, step);
    EXPECT_NEAR(jet.gradient[axis], slope, tolerance) << place.transpose();
    EXPECT_LT((jet.hessian.col(axis) - row).norm() * length, tolerance) << place.transpose();
    EXPECT_LT((third_along(jet, axis) - third).norm() * length * length, tolerance)
        << place.transpose();
  }
}

/// What differs between two jets, in units of a length.
inline double difference(const Jet& a, const Jet& b, double length) {
  return std::max({std::abs(a.value - b.value) / length, (a.gradient - b.gradient).norm(),
                   (a.hessian - b.hessian).norm() * length,
                   (a.third - b.third).norm() * length * length});
}

inline bool all_finite(const Jet& jet) {
  return std::isfinite(jet.value) && jet.gradient.allFinite() && jet.hessian.allFinite() &&
         jet.third.allFinite();
}

/// An order gives the derivatives up to it as the highest does, and zero above.
inline void expect_orders_agree(const RigidShape& shape, const Vec3& place) {
  const Jet full = shape.evaluate(place);
  EXPECT_EQ(shape.value(place), full.value);
  for (int order = 0; order <= 3; ++order) {
    const Jet jet = shape.evaluate(place, order);
    EXPECT_EQ(jet.value, full.value);
    EXPECT_EQ(jet.gradient, order < 1 ? Vec3(Vec3::Zero()) : full.gradient);
    EXPECT_EQ(jet.hessian, order < 2 ? Mat3(Mat3::Zero()) : full.hessian);
    EXPECT_EQ(jet.third, order < 3 ? Jet().third : full.third);
  }
}

}  // namespace palpate::test
