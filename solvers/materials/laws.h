// SPDX-License-Identifier: BSD-3-Clause
// Energy, stress and tangent of each law at one point, for a scalar type T that is double or a
// Packet of them.
//
//   H = ∇u,  F = I + H,  J = det F,  E = ½(H + Hᵀ + HᵀH),  C = I + 2E
//   S = ∂W/∂E,  D = ∂S/∂E                       second Piola–Kirchhoff stress and its tangent
//   P = F S,    A = ∂P/∂F: A_iJkL = δ_ik S_JL + F_iM D_MJNL F_kN
//
// The linear law has no S of its own: P = σ(sym H) and a constant A.
//
// E and J − 1 are computed from H, never as differences of numbers near one, and W and S in forms
// without cancellation, so that small displacements keep their digits.
//
// Symmetric tensors are six components in the order xx yy zz yz xz xy. D is stored as the lower
// triangle of the 6 × 6 matrix ∂S_m/∂E_n of tensor components (no factor 2 on shear).
#pragma once

#include "base/packet.h"
#include "materials/material.h"

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

  /// tr E − (J − 1), which is of second order in the strain, from terms that are: with the
  /// invariants of E, (1 + j)² = det(I + 2E) = 1 + 2 I + 4 II + 8 III. A rotation has no part in it.
  [[nodiscard]] T trace_without_volume() const {
    const T minors = e[0] * e[1] - e[5] * e[5] + e[0] * e[2] - e[4] * e[4] + e[1] * e[2] - e[3] * e[3];
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

/// x − log1p(x), to full relative precision near 0.
inline double log1p_remainder(double x) {
  if (std::fabs(x) > 0.05) return x - std::log1p(x);
  double sum = 0;
  for (int n = 13; n >= 2; --n) sum = (n % 2 == 0 ? 1.0 : -1.0) / n + x * sum;
  return x * x * sum;
}

// Symmetric tensors ----------------------------------------------------------------------------

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

// The laws: evaluate<WithTangent>(kinematics, parameters, response) ---------------------------

template <Law L>
struct LawOf;

/// As St. Venant–Kirchhoff, but of ε = sym H in place of E; s is σ = P, d is ∂σ/∂ε.
template <>
struct LawOf<Law::linear> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, const T (&p)[3], Response<T>& out) {
    T strain[6];
    for (int m = 0; m < 6; ++m) strain[m] = 0.5 * (k.h[kRow[m]][kColumn[m]] + k.h[kColumn[m]][kRow[m]]);
    quadratic<WithTangent>(strain, p, out);
  }

  /// λ/2 (tr x)² + μ x:x and its derivatives.
  template <bool WithTangent, class T>
  static void quadratic(const T (&x)[6], const T (&p)[3], Response<T>& out) {
    const T tr = trace(x);
    T norm = 0.0;
    for (int m = 0; m < 6; ++m) {
      norm += (m < 3 ? 1.0 : 2.0) * x[m] * x[m];
      out.s[m] = 2.0 * p[1] * x[m];
      if (m < 3) out.s[m] += p[0] * tr;
    }
    out.energy = 0.5 * p[0] * tr * tr + p[1] * norm;
    if constexpr (WithTangent) {
      for (T& component : out.d) component = 0.0;
      for (int m = 0; m < 3; ++m) {
        for (int n = 0; n <= m; ++n) out.d[lower(m, n)] = p[0];
      }
      add_identity(2.0 * p[1], out.d);
    }
  }
};

template <>
struct LawOf<Law::st_venant_kirchhoff> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, const T (&p)[3], Response<T>& out) {
    LawOf<Law::linear>::quadratic<WithTangent>(k.e, p, out);
  }
};

/// S = μ(I − C⁻¹) + λ ln J C⁻¹, with I − C⁻¹ = 2 C⁻¹E.
template <>
struct LawOf<Law::neo_hookean> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, const T (&p)[3], Response<T>& out) {
    const T lambda = p[0];
    const T mu = p[1];
    const T log_j = map(k.j, [](double j) { return std::log1p(j); });
    // ½(I₁ − 3) − ln J = (tr E − j) + (j − ln(1 + j)).
    const T remainder = map(k.j, [](double j) { return log1p_remainder(j); });
    out.energy = mu * (k.trace_without_volume() + remainder) + 0.5 * lambda * log_j * log_j;
    T ci[6];
    T ci_e[6];
    inverse_c(k, ci);
    product(ci, k.e, ci_e);
    for (int m = 0; m < 6; ++m) out.s[m] = 2.0 * mu * ci_e[m] + lambda * log_j * ci[m];
    if constexpr (WithTangent) {
      for (T& component : out.d) component = 0.0;
      add_square(lambda, ci, out.d);
      add_identity_of(T(2.0 * (mu - lambda * log_j)), ci, out.d);
    }
  }
};

/// With a = J^(−2/3), b = a², dev X = X − ⅓ tr X I and e = tr E:
///   S = 4 C₁₀ a C⁻¹ dev E + 2 C₀₁ b C⁻¹ dev[(2 + 4e) E − 4E²] + κ (J − 1) J C⁻¹.
template <>
struct LawOf<Law::mooney_rivlin> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, const T (&p)[3], Response<T>& out) {
    const T c10 = p[0];
    const T c01 = p[1];
    const T kappa = p[2];
    // J^(1/3) − 1 to full relative precision, and a, b.
    const T x_1 = map(k.j, [](double j) { return std::expm1(std::log1p(j) / 3); });
    const T x = 1.0 + x_1;
    const T a = 1.0 / (x * x);
    const T b = a * a;
    const T tr = trace(k.e);
    T e2[6];
    product(k.e, k.e, e2);
    const T i1_3 = 2.0 * tr;                                // I₁ − 3
    const T i2_3 = 4.0 * tr + 2.0 * (tr * tr - trace(e2));  // I₂ − 3
    // The terms of first order in the strain cancel in Ī₁ − 3 and Ī₂ − 3. With
    // q = tr E − j and x³ = J they are gone before they are computed:
    //   2aj + 3(a − 1) = (x − 1)² (2x + 1)/x²,  4bj + 3(b − 1) = −(x − 1)² (3x² + 2x + 1)/x⁴.
    const T q = k.trace_without_volume();
    const T x_1_squared = x_1 * x_1;
    const T first_invariant = a * (2.0 * q + x_1_squared * (2.0 * x + 1.0));
    const T second_invariant = b * (4.0 * q + 2.0 * (tr * tr - trace(e2)) -
                                    x_1_squared * (3.0 * x * x + 2.0 * x + 1.0));
    out.energy = c10 * first_invariant + c01 * second_invariant + 0.5 * kappa * k.j * k.j;
    T ci[6];
    inverse_c(k, ci);
    T y[6];
    const T second_factor = 2.0 * c01 * b;
    for (int m = 0; m < 6; ++m) {
      y[m] = (4.0 * c10 * a + second_factor * (2.0 + 4.0 * tr)) * k.e[m] -
             4.0 * second_factor * e2[m];
    }
    const T mean = (1.0 / 3) * trace(y);
    for (int m = 0; m < 3; ++m) y[m] -= mean;
    product(ci, y, out.s);
    const T pressure = kappa * k.j * (1.0 + k.j);
    for (int m = 0; m < 6; ++m) out.s[m] += pressure * ci[m];
    if constexpr (WithTangent) {
      const T i1 = 3.0 + i1_3;
      const T i2 = 3.0 + i2_3;
      const T first = 2.0 * c10 * a;
      T one[6];
      T m2[6];  // ½ ∂I₂/∂E = I₁ I − C
      for (int m = 0; m < 6; ++m) {
        one[m] = m < 3 ? 1.0 : 0.0;
        m2[m] = one[m] * (i1 - 1.0) - 2.0 * k.e[m];
      }
      for (T& component : out.d) component = 0.0;
      add_symmetric(T((-2.0 / 3) * first), one, ci, out.d);
      add_symmetric(T((-4.0 / 3) * second_factor), m2, ci, out.d);
      add_square(T(2.0 * second_factor), one, out.d);
      add_identity(T(-2.0 * second_factor), out.d);
      add_square(T((2.0 / 9) * first * i1 + (8.0 / 9) * second_factor * i2 +
                   kappa * (1.0 + 2.0 * k.j) * (1.0 + k.j)),
                 ci, out.d);
      add_identity_of(T((2.0 / 3) * first * i1 + (4.0 / 3) * second_factor * i2 - 2.0 * pressure),
                      ci, out.d);
    }
  }
};

}  // namespace palpate::PALPATE_INSTRUCTION_SET
