// SPDX-License-Identifier: BSD-3-Clause
// Random numbers that are the same on every machine: the generator is fixed by the standard, the
// distributions of the standard library are not.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <random>

#include "base/types.h"

namespace palpate::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double from, double to) {
    constexpr double unit = 1.0 / 9007199254740992.0;  // 2⁻⁵³
    return from + (to - from) * static_cast<double>(engine_() >> 11) * unit;
  }

  /// Components between −size and size.
  Mat3 matrix(double size) {
    Mat3 m;
    for (double& x : m.reshaped()) x = uniform(-size, size);
    return m;
  }

  Eigen::VectorXd vector(Eigen::Index length, double size) {
    Eigen::VectorXd v(length);
    for (double& x : v) x = uniform(-size, size);
    return v;
  }

  /// A rotation by up to a half turn about any axis.
  Mat3 rotation() {
    const Vec3 axis = vector(3, 1.0).normalized();
    return Eigen::AngleAxisd(uniform(-M_PI, M_PI), axis).toRotationMatrix();
  }

  /// A deformation gradient with this determinant: rotations, and stretches of which the ratio of
  /// two is up to e^(2·spread).
  Mat3 deformation_gradient(double det_f, double spread) {
    Vec3 logarithms = vector(3, spread);
    logarithms.array() += std::log(det_f) / 3 - logarithms.mean();
    return rotation() * Vec3(logarithms.array().exp()).asDiagonal() * rotation();
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace palpate::test
