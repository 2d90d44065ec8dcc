// SPDX-License-Identifier: BSD-3-Clause
// Tensor operations for the recursions of a viscous material (materials/rheology.h) at one point.
//
// Symmetric tensors are six components in the order xx yy zz yz xz xy; in an array they are
// kPacketSize apart, see base/simd.h.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "base/simd.h"

namespace palpate {

using Tensor6 = std::array<double, 6>;

inline Tensor6 load_tensor(const double* from) {
  Tensor6 tensor;
  for (std::size_t m = 0; m < 6; ++m) tensor[m] = from[m * kPacketSize];
  return tensor;
}

inline void store_tensor(const Tensor6& tensor, double* to) {
  for (std::size_t m = 0; m < 6; ++m) to[m * kPacketSize] = tensor[m];
}

inline void add(double factor, const Tensor6& other, Tensor6& tensor) {
  for (std::size_t m = 0; m < 6; ++m) tensor[m] += factor * other[m];
}

/// λ tr(x) I + 2μ x.
inline Tensor6 isotropic(double lambda, double mu, const Tensor6& x) {
  const double trace = x[0] + x[1] + x[2];
  Tensor6 result;
  for (std::size_t m = 0; m < 6; ++m) result[m] = 2 * mu * x[m] + (m < 3 ? lambda * trace : 0);
  return result;
}

inline double contract(const Tensor6& a, const Tensor6& b) {
  double sum = 0;
  for (std::size_t m = 0; m < 6; ++m) sum += (m < 3 ? 1 : 2) * a[m] * b[m];
  return sum;
}

/// s : C⁻¹ : s of an isotropic C.
inline double compliance_energy(double lambda, double mu, const Tensor6& s) {
  const double trace = s[0] + s[1] + s[2];
  const double bulk = 3 * lambda + 2 * mu;
  const double of_volume = bulk > 0 ? trace * trace / (3 * bulk) : 0;
  return (contract(s, s) - trace * trace / 3) / (2 * mu) + of_volume;
}

/// (1 − exp(−x)) / x: the mean of exp(−t) over a step of length x.
inline double mean_decay(double x) { return x == 0 ? 1 : -std::expm1(-x) / x; }

}  // namespace palpate
