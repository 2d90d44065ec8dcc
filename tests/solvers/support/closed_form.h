// SPDX-License-Identifier: BSD-3-Clause
// The laws by formulas written here, from the invariants or the principal stretches, apart from
// those of the program.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "base/types.h"
#include "materials/material.h"

namespace palpate::test {

/// Energy per volume and first Piola–Kirchhoff stress at F. `pressure` is that of an incompressible
/// body; other laws have no use for it.
struct Point {
  double energy = 0;
  Mat3 stress;
};

/// Of Ogden's law.
inline Point evaluate_ogden(const Material& material, const Mat3& f) {
  const auto& q = material.parameters;
  const double j = f.determinant();
  const Eigen::SelfAdjointEigenSolver<Mat3> squares(f.transpose() * f);
  const Vec3 stretches = squares.eigenvalues().cwiseSqrt();
  Point point;
  point.energy = q[0] / 2 * (j - 1) * (j - 1);
  point.stress = q[0] * (j - 1) * j * f.inverse().transpose();
  for (int i = 1; i < 7; i += 2) {
    if (q[i] == 0) continue;
    const Vec3 powers = (stretches / std::cbrt(j)).array().pow(q[i + 1]);
    point.energy += 2 * q[i] / (q[i + 1] * q[i + 1]) * (powers.sum() - 3);
    const Vec3 by_stretch =
        2 * q[i] / q[i + 1] * (powers.array() - powers.mean()).cwiseQuotient(stretches.array());
    const Mat3& axes = squares.eigenvectors();
    point.stress += f * axes * by_stretch.cwiseQuotient(stretches).asDiagonal() * axes.transpose();
  }
  return point;
}

inline Point evaluate(const Material& material, const Mat3& f, double pressure) {
  if (material.law == Law::ogden) return evaluate_ogden(material, f);
  const auto& q = material.parameters;
  const Mat3 identity = Mat3::Identity();
  Point point;
  const double young = q[0];
  const double poisson = q[1];
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const double mu = young / (2 * (1 + poisson));
  if (material.law == Law::linear || material.law == Law::st_venant_kirchhoff) {
    const bool linear = material.law == Law::linear;
    const Mat3 h = f - identity;
    const Mat3 strain =
        linear ? Mat3((h + h.transpose()) / 2) : Mat3((h + h.transpose() + h.transpose() * h) / 2);
    const Mat3 stress = lambda * strain.trace() * identity + 2 * mu * strain;
    point.energy = strain.cwiseProduct(stress).sum() / 2;
    point.stress = linear ? stress : Mat3(f * stress);
    return point;
  }
  const double j = f.determinant();
  const Mat3 inverse_transpose = f.inverse().transpose();
  const Mat3 c = f.transpose() * f;
  const double i1 = c.trace();
  const double i2 = (i1 * i1 - (c * c).trace()) / 2;
  if (material.law == Law::neo_hookean) {
    const double log_j = std::log(j);
    point.energy = mu / 2 * (i1 - 3) - mu * log_j + lambda / 2 * log_j * log_j;
    point.stress = mu * (f - inverse_transpose) + lambda * log_j * inverse_transpose;
    return point;
  }
  const double first = std::pow(j, -2.0 / 3) * i1 - 3;
  const double second = std::pow(j, -4.0 / 3) * i2 - 3;
  double by_first = 0;
  double by_second = 0;
  double by_volume = 0;
  const auto add_polynomial = [&](int r, int s, double coefficient) {
    point.energy += coefficient * std::pow(first, r) * std::pow(second, s);
    if (r > 0) by_first += coefficient * r * std::pow(first, r - 1) * std::pow(second, s);
    if (s > 0) by_second += coefficient * s * std::pow(first, r) * std::pow(second, s - 1);
  };
  const auto add_bulk = [&](double kappa) {
    point.energy += kappa / 2 * (j - 1) * (j - 1);
    by_volume += kappa * (j - 1);
  };
  switch (material.law) {
    case Law::mooney_rivlin:
      add_polynomial(1, 0, q[0]);
      add_polynomial(0, 1, q[1]);
      add_bulk(q[2]);
      break;
    case Law::mooney_rivlin_polynomial: {
      constexpr int kPowers[9][2] = {{1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2},
                                     {3, 0}, {2, 1}, {1, 2}, {0, 3}};
      for (int i = 0; i < 9; ++i) add_polynomial(kPowers[i][0], kPowers[i][1], q[1 + i]);
      add_bulk(q[0]);
      break;
    }
    case Law::fung: {
      const double b = q[2];
      point.energy = mu / (2 * b) * (std::exp(b * first) - 1);
      by_first = mu / 2 * std::exp(b * first);
      add_bulk(young / (3 * (1 - 2 * poisson)));
      break;
    }
    case Law::neo_hookean_incompressible:
      add_polynomial(1, 0, young / 6);
      by_volume = pressure;
      break;
    default:
      add_polynomial(1, 0, q[0]);
      add_polynomial(0, 1, q[1]);
      by_volume = pressure;
      break;
  }
  point.stress = by_first * std::pow(j, -2.0 / 3) * (2 * f - 2.0 / 3 * i1 * inverse_transpose) +
                 by_second * std::pow(j, -4.0 / 3) *
                     (2 * (i1 * f - f * c) - 4.0 / 3 * i2 * inverse_transpose) +
                 by_volume * j * inverse_transpose;
  return point;
}

/// p = κ̂ g of a mixed compressible material.
inline double pressure_of(const Material& material, const Mat3& f) {
  const auto& q = material.parameters;
  const double lambda = q[0] * q[1] / ((1 + q[1]) * (1 - 2 * q[1]));
  switch (material.law) {
    case Law::linear: return lambda * (f.trace() - 3);
    case Law::st_venant_kirchhoff: return lambda * ((f.transpose() * f).trace() - 3) / 2;
    case Law::neo_hookean: return lambda * std::log(f.determinant());
    case Law::mooney_rivlin: return q[2] * (f.determinant() - 1);
    case Law::mooney_rivlin_polynomial:
    case Law::ogden: return q[0] * (f.determinant() - 1);
    default: return q[0] / (3 * (1 - 2 * q[1])) * (f.determinant() - 1);
  }
}

/// The Cauchy stress that belongs to it; of the linear law the two are one.
inline Mat3 cauchy_stress(const Material& material, const Mat3& f, double pressure) {
  const Mat3 stress = evaluate(material, f, pressure).stress;
  return material.law == Law::linear ? stress : Mat3(stress * f.transpose() / f.determinant());
}

}  // namespace palpate::test
