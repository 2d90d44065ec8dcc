// SPDX-License-Identifier: BSD-3-Clause
// Strain at a point from H = ∇u, the response of a law to it, and operations on symmetric tensors.
// The scalar type T is double or a Packet of them.
//
//   F = I + H,  J = det F,  E = ½(H + Hᵀ + HᵀH),  C = I + 2E
//
// E and J − 1 are computed from H, never as differences of numbers near one, so that small
// displacements keep their digits.
//
// Symmetric tensors are six components in the order xx yy zz yz xz xy. D is stored as the lower
// triangle of the 6 × 6 matrix ∂S_m/∂E_n of tensor components (no factor 2 on shear).
#pragma once

#include <cmath>

#include "base/simd.h"

namespace palpate::PALPATE_INSTRUCTION_SET {

/// Component of a symmetric tensor at row i, column j.
inline constexpr int kSymmetric[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
/// Row and column of each component.
inline constexpr int kRow[6] = {0, 1, 2, 1, 0, 0};
inline constexpr int kColumn[6] = {0, 1, 2, 2, 2, 1};

/// Place of (m, n), m ≥ n, in the lower triangle of a 6 × 6 matrix.
constexpr int lower(int m, int n) { return m >= n ? m * (m + 1) / 2 + n : n * (n + 1) / 2 + m; }

template <class T>
struct Kinematics {
  T h[3][3];
  /// Green–Lagrange strain.
  T e[6];
  /// J − 1.
  T j;

  void update() {
    for (int m = 0; m < 6; ++m) {
      const int r = kRow[m];
      const int c = kColumn[m];
      e[m] = 0.5 * (h[r][c] + h[c][r] + h[0][r] * h[0][c] + h[1][r] * h[1][c] + h[2][r] * h[2][c]);
    }
    const T minor_xy = h[0][0] * h[1][1] - h[0][1] * h[1][0];
    const T minor_xz = h[0][0] * h[2][2] - h[0][2] * h[2][0];
    const T minor_yz = h[1][1] * h[2][2] - h[1][2] * h[2][1];
    const T third = h[0][0] * minor_yz - h[0][1] * (h[1][0] * h[2][2] - h[1][2] * h[2][0]) +
                    h[0][2] * (h[1][0] * h[2][1] - h[1][1] * h[2][0]);
    j = h[0][0] + h[1][1] + h[2][2] + minor_xy + minor_xz + minor_yz + third;
  }

  /// tr E − (J − 1), which is of second order in the strain, computed from terms of that order:
  /// with the invariants of E, (1 + j)² = det(I + 2E) = 1 + 2 I + 4 II + 8 III. A rotation
  /// contributes nothing to it.
  [[nodiscard]] T trace_without_volume() const {
    const T minors =
        e[0] * e[1] - e[5] * e[5] + e[0] * e[2] - e[4] * e[4] + e[1] * e[2] - e[3] * e[3];
    const T det = e[0] * (e[1] * e[2] - e[3] * e[3]) - e[5] * (e[5] * e[2] - e[3] * e[4]) +
                  e[4] * (e[5] * e[3] - e[1] * e[4]);
    return 0.5 * j * j - 2.0 * minors - 4.0 * det;
  }
};

template <class T>
struct Response {
  /// J/m³.
  T energy;
  /// Pa.
  T s[6];
  /// Pa; lower triangle of 6 × 6.
  T d[21];
};

/// C⁻¹ from E and J − 1; det C = J².
template <class T>
void inverse_c(const Kinematics<T>& k, T (&ci)[6]) {
  T c[6];
  for (int m = 0; m < 6; ++m) c[m] = 2.0 * k.e[m] + (m < 3 ? 1.0 : 0.0);
  const T det = (1.0 + k.j) * (1.0 + k.j);
  const T scale = 1.0 / det;
  ci[0] = scale * (c[1] * c[2] - c[3] * c[3]);
  ci[1] = scale * (c[0] * c[2] - c[4] * c[4]);
  ci[2] = scale * (c[0] * c[1] - c[5] * c[5]);
  ci[3] = scale * (c[4] * c[5] - c[0] * c[3]);
  ci[4] = scale * (c[3] * c[5] - c[1] * c[4]);
  ci[5] = scale * (c[3] * c[4] - c[2] * c[5]);
}

/// Eigenvalues and orthonormal eigenvectors of a symmetric tensor, unsorted, by Jacobi's rotations:
/// x = Σ values[a] vectors[a] ⊗ vectors[a] to the rounding of its largest component.
template <class T>
struct Eigen3 {
  T values[3];
  /// The components of each eigenvector.
  T vectors[3][3];

  explicit Eigen3(const T (&x)[6]) {
    T a[6];
    for (int m = 0; m < 6; ++m) a[m] = x[m];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) vectors[i][j] = i == j ? 1.0 : 0.0;
    }
    // From the second sweep on the off-diagonal components converge quadratically.
    constexpr int num_sweeps = 5;
    for (int sweep = 0; sweep < num_sweeps; ++sweep) {
      rotate(0, 1, a);
      rotate(0, 2, a);
      rotate(1, 2, a);
    }
    for (int i = 0; i < 3; ++i) values[i] = a[i];
  }

 private:
  /// Rotates in the plane of the axes p and q so that a_pq becomes 0.
  void rotate(int p, int q, T (&a)[6]) {
    T& off = a[kSymmetric[p][q]];
    const T half = 0.5 * (a[q] - a[p]);
    const T sign = map(half, [](double y) { return std::copysign(1.0, y); });
    const T root = map(T(half * half + off * off), [](double y) { return std::sqrt(y); });
    // It avoids 0/0 where both terms are 0 and no rotation is needed.
    constexpr double least = 1e-300;
    const T tangent = off * sign / (half * sign + root + least);
    const T cosine = map(tangent, [](double t) { return 1 / std::sqrt(1 + t * t); });
    const T sine = tangent * cosine;
    a[p] -= tangent * off;
    a[q] += tangent * off;
    off = 0.0;
    const int r = 3 - p - q;
    turn(a[kSymmetric[p][r]], a[kSymmetric[q][r]], cosine, sine);
    for (int i = 0; i < 3; ++i) turn(vectors[p][i], vectors[q][i], cosine, sine);
  }

  static void turn(T& x, T& y, const T& cosine, const T& sine) {
    const T before = x;
    x = cosine * before - sine * y;
    y = sine * before + cosine * y;
  }
};

/// x y for commuting symmetric x, y (the product is symmetric).
template <class T>
void product(const T (&x)[6], const T (&y)[6], T (&out)[6]) {
  for (int m = 0; m < 6; ++m) {
    const int r = kRow[m];
    const int c = kColumn[m];
    out[m] = x[kSymmetric[r][0]] * y[kSymmetric[0][c]] + x[kSymmetric[r][1]] * y[kSymmetric[1][c]] +
             x[kSymmetric[r][2]] * y[kSymmetric[2][c]];
  }
}

template <class T>
T trace(const T (&x)[6]) {
  return x[0] + x[1] + x[2];
}

/// d += a x⊗x.
template <class T>
void add_square(T a, const T (&x)[6], T (&d)[21]) {
  for (int m = 0; m < 6; ++m) {
    const T ax = a * x[m];
    for (int n = 0; n <= m; ++n) d[lower(m, n)] += ax * x[n];
  }
}

/// d += a (x⊗y + y⊗x).
template <class T>
void add_symmetric(T a, const T (&x)[6], const T (&y)[6], T (&d)[21]) {
  for (int m = 0; m < 6; ++m) {
    for (int n = 0; n <= m; ++n) d[lower(m, n)] += a * (x[m] * y[n] + y[m] * x[n]);
  }
}

/// d += a 𝕀_x with (𝕀_x)_IJKL = ½(x_IK x_JL + x_IL x_JK); −2 𝕀_{C⁻¹} is ∂C⁻¹/∂E.
template <class T>
void add_identity_of(T a, const T (&x)[6], T (&d)[21]) {
  const T half = 0.5 * a;
  for (int m = 0; m < 6; ++m) {
    const int i = kRow[m];
    const int j = kColumn[m];
    for (int n = 0; n <= m; ++n) {
      const int k = kRow[n];
      const int l = kColumn[n];
      d[lower(m, n)] += half * (x[kSymmetric[i][k]] * x[kSymmetric[j][l]] +
                                x[kSymmetric[i][l]] * x[kSymmetric[j][k]]);
    }
  }
}

/// d += a 𝕀, the identity on symmetric tensors: 1 on the normal, ½ on the shear components.
template <class T>
void add_identity(T a, T (&d)[21]) {
  for (int m = 0; m < 6; ++m) d[lower(m, m)] += m < 3 ? a : 0.5 * a;
}

}  // namespace palpate::PALPATE_INSTRUCTION_SET
