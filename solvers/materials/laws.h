// SPDX-License-Identifier: BSD-3-Clause
// Energy, stress and tangent of each law at one point, for a scalar type T that is double or a
// Packet of them; strain and symmetric tensors as in materials/kinematics.h.
//
//   S = ∂W/∂E,  D = ∂S/∂E                       second Piola–Kirchhoff stress and its tangent
//   P = F S,    A = ∂P/∂F: A_iJkL = δ_ik S_JL + F_iM D_MJNL F_kN
//
// The linear law has no S of its own: P = σ(sym H) and a constant A.
//
// W and S are computed in forms without cancellation, so that small displacements keep their
// digits.
#pragma once

#include <cmath>

#include "materials/kinematics.h"
#include "materials/material.h"

namespace palpate::PALPATE_INSTRUCTION_SET {

/// x − log1p(x), to full relative precision near 0.
inline double log1p_remainder(double x) {
  if (std::fabs(x) > 0.05) return x - std::log1p(x);
  double sum = 0;
  for (int n = 13; n >= 2; --n) sum = (n % 2 == 0 ? 1.0 : -1.0) / n + x * sum;
  return x * x * sum;
}

// The laws: evaluate<WithTangent>(kinematics, constants, response) ----------------------------

/// Number of the law's constants, the first of law_constants().
template <Law L>
inline constexpr int kNumConstants = L == Law::mooney_rivlin_polynomial ? 1 + num_polynomial_terms
                                     : L == Law::ogden                  ? 1 + 2 * max_ogden_terms
                                     : L == Law::mooney_rivlin || L == Law::fung ? 3
                                                                                 : 2;

/// Beyond this exponent, which no equilibrium reaches, the exponentials of Fung and Ogden continue
/// as their osculating parabola, so that the energy and its derivatives stay finite in a trial
/// state that is far from equilibrium.
inline constexpr double largest_exponent = 200;

template <Law L>
struct LawOf;

/// St. Venant–Kirchhoff's law with ε = sym H in place of E; s is σ = P, d is ∂σ/∂ε.
template <>
struct LawOf<Law::linear> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, const T (&p)[2], Response<T>& out) {
    T strain[6];
    for (int m = 0; m < 6; ++m)
      strain[m] = 0.5 * (k.h[kRow[m]][kColumn[m]] + k.h[kColumn[m]][kRow[m]]);
    quadratic<WithTangent>(strain, p, out);
  }

  /// λ/2 (tr x)² + μ x:x and its derivatives.
  template <bool WithTangent, class T>
  static void quadratic(const T (&x)[6], const T (&p)[2], Response<T>& out) {
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
  static void evaluate(const Kinematics<T>& k, const T (&p)[2], Response<T>& out) {
    LawOf<Law::linear>::quadratic<WithTangent>(k.e, p, out);
  }
};

/// S = μ(I − C⁻¹) + λ ln J C⁻¹, with I − C⁻¹ = 2 C⁻¹E.
template <>
struct LawOf<Law::neo_hookean> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, const T (&p)[2], Response<T>& out) {
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

/// Ī₁ − 3 and Ī₂ − 3, and the terms that their derivatives share with them.
template <class T>
struct IsochoricInvariants {
  /// J^(−2/3) and its square.
  T a;
  T b;
  /// tr E and E².
  T tr;
  T e2[6];
  /// C⁻¹.
  T ci[6];
  /// Ī₁ − 3.
  T first;
  /// Ī₂ − 3.
  T second;

  [[gnu::always_inline]] explicit IsochoricInvariants(const Kinematics<T>& k) {
    // J^(1/3) − 1 to full relative precision, and a, b.
    const T x_1 = map(k.j, [](double j) { return std::expm1(std::log1p(j) / 3); });
    const T x = 1.0 + x_1;
    a = 1.0 / (x * x);
    b = a * a;
    tr = trace(k.e);
    product(k.e, k.e, e2);
    inverse_c(k, ci);
    // With q = tr E − j and x³ = J the terms of first order in the strain, which cancel in Ī₁ − 3
    // and Ī₂ − 3, are eliminated by hand:
    //   2aj + 3(a − 1) = (x − 1)² (2x + 1)/x²,  4bj + 3(b − 1) = −(x − 1)² (3x² + 2x + 1)/x⁴.
    const T q = k.trace_without_volume();
    const T x_1_squared = x_1 * x_1;
    first = a * (2.0 * q + x_1_squared * (2.0 * x + 1.0));
    second =
        b * (4.0 * q + 2.0 * (tr * tr - trace(e2)) - x_1_squared * (3.0 * x * x + 2.0 * x + 1.0));
  }

  /// ∂Ī₁/∂E = 4 a C⁻¹ dev E.
  void first_gradient(const Kinematics<T>& k, T (&out)[6]) const {
    T y[6];
    for (int m = 0; m < 6; ++m) y[m] = 4.0 * a * k.e[m];
    deviator_times_inverse(y, out);
  }

  /// ∂Ī₂/∂E = 2 b C⁻¹ dev[(2 + 4 tr E) E − 4 E²].
  void second_gradient(const Kinematics<T>& k, T (&out)[6]) const {
    T y[6];
    for (int m = 0; m < 6; ++m) y[m] = 2.0 * b * ((2.0 + 4.0 * tr) * k.e[m] - 4.0 * e2[m]);
    deviator_times_inverse(y, out);
  }

  /// C⁻¹ dev y, dev y = y − ⅓ tr y I.
  void deviator_times_inverse(T (&y)[6], T (&out)[6]) const {
    const T mean = (1.0 / 3) * trace(y);
    for (int m = 0; m < 3; ++m) y[m] -= mean;
    product(ci, y, out);
  }
};

/// Stress and tangent of f₁ Ī₁ + f₂ Ī₂ + κ/2 (J − 1)² with constants f₁, f₂:
///   S = C⁻¹ dev[(4 f₁ a + 2 f₂ b (2 + 4 tr E)) E − 8 f₂ b E²] + κ (J − 1) J C⁻¹.
/// Inlined by force: passed through memory, the invariants would cost Mooney–Rivlin a fifth.
template <bool WithTangent, class T>
[[gnu::always_inline]] inline void respond_linearly(const Kinematics<T>& k,
                                                    const IsochoricInvariants<T>& i, T f_1, T f_2,
                                                    T kappa, Response<T>& out) {
  T y[6];
  const T second_factor = 2.0 * f_2 * i.b;
  for (int m = 0; m < 6; ++m) {
    y[m] = (4.0 * f_1 * i.a + second_factor * (2.0 + 4.0 * i.tr)) * k.e[m] -
           4.0 * second_factor * i.e2[m];
  }
  i.deviator_times_inverse(y, out.s);
  const T pressure = kappa * k.j * (1.0 + k.j);
  for (int m = 0; m < 6; ++m) out.s[m] += pressure * i.ci[m];
  if constexpr (WithTangent) {
    const T i1 = 3.0 + 2.0 * i.tr;
    const T i2 = 3.0 + 4.0 * i.tr + 2.0 * (i.tr * i.tr - trace(i.e2));
    const T first = 2.0 * f_1 * i.a;
    T one[6];
    T m2[6];  // ½ ∂I₂/∂E = I₁ I − C
    for (int m = 0; m < 6; ++m) {
      one[m] = m < 3 ? 1.0 : 0.0;
      m2[m] = one[m] * (i1 - 1.0) - 2.0 * k.e[m];
    }
    for (T& component : out.d) component = 0.0;
    add_symmetric(T((-2.0 / 3) * first), one, i.ci, out.d);
    add_symmetric(T((-4.0 / 3) * second_factor), m2, i.ci, out.d);
    add_square(T(2.0 * second_factor), one, out.d);
    add_identity(T(-2.0 * second_factor), out.d);
    add_square(T((2.0 / 9) * first * i1 + (8.0 / 9) * second_factor * i2 +
                 kappa * (1.0 + 2.0 * k.j) * (1.0 + k.j)),
               i.ci, out.d);
    add_identity_of(T((2.0 / 3) * first * i1 + (4.0 / 3) * second_factor * i2 - 2.0 * pressure),
                    i.ci, out.d);
  }
}

template <>
struct LawOf<Law::mooney_rivlin> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, const T (&p)[3], Response<T>& out) {
    const IsochoricInvariants<T> i(k);
    out.energy = p[0] * i.first + p[1] * i.second + 0.5 * p[2] * k.j * k.j;
    respond_linearly<WithTangent>(k, i, p[0], p[1], p[2], out);
  }
};

/// With x = Ī₁ − 3, y = Ī₂ − 3 and the sum f(x, y): S is that of f_x Ī₁ + f_y Ī₂, and D has in
/// addition f_xx ∂x⊗∂x + f_xy (∂x⊗∂y + ∂y⊗∂x) + f_yy ∂y⊗∂y.
template <>
struct LawOf<Law::mooney_rivlin_polynomial> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, const T (&p)[10], Response<T>& out) {
    const IsochoricInvariants<T> i(k);
    const T& kappa = p[0];
    const T& c10 = p[1];
    const T& c01 = p[2];
    const T& c20 = p[3];
    const T& c11 = p[4];
    const T& c02 = p[5];
    const T& c30 = p[6];
    const T& c21 = p[7];
    const T& c12 = p[8];
    const T& c03 = p[9];
    const T& x = i.first;
    const T& y = i.second;
    out.energy = x * (c10 + x * (c20 + x * c30) + y * (c11 + x * c21 + y * c12)) +
                 y * (c01 + y * (c02 + y * c03)) + 0.5 * kappa * k.j * k.j;
    const T f_x = c10 + x * (2.0 * c20 + 3.0 * c30 * x) + y * (c11 + 2.0 * c21 * x + c12 * y);
    const T f_y = c01 + y * (2.0 * c02 + 3.0 * c03 * y) + x * (c11 + 2.0 * c12 * y + c21 * x);
    respond_linearly<WithTangent>(k, i, f_x, f_y, kappa, out);
    if constexpr (WithTangent) {
      T dx[6];
      T dy[6];
      i.first_gradient(k, dx);
      i.second_gradient(k, dy);
      add_square(T(2.0 * (c20 + 3.0 * c30 * x + c21 * y)), dx, out.d);
      add_symmetric(T(c11 + 2.0 * (c21 * x + c12 * y)), dx, dy, out.d);
      add_square(T(2.0 * (c02 + c12 * x + 3.0 * c03 * y)), dy, out.d);
    }
  }
};

template <>
struct LawOf<Law::fung> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, const T (&p)[3], Response<T>& out) {
    const IsochoricInvariants<T> i(k);
    const T half_mu = 0.5 * p[0];
    const T& b = p[1];
    const T& kappa = p[2];
    const T x = min(i.first, T(largest_exponent / b));
    const T beyond = i.first - x;
    const T power = map(T(b * x), [](double y) { return std::exp(y); });
    // (exp(y) − 1)/y, so that a small b costs no digits.
    const T mean_power = map(T(b * x), [](double y) { return y == 0 ? 1 : std::expm1(y) / y; });
    out.energy = half_mu * (x * mean_power + power * beyond * (1.0 + 0.5 * b * beyond)) +
                 0.5 * kappa * k.j * k.j;
    const T f_x = half_mu * power * (1.0 + b * beyond);
    respond_linearly<WithTangent>(k, i, f_x, T(0.0), kappa, out);
    if constexpr (WithTangent) {
      T dx[6];
      i.first_gradient(k, dx);
      add_square(T(half_mu * b * power), dx, out.d);
    }
  }
};

/// (exp(x) − 1 − x)/x², to full relative precision; beyond largest_exponent that of the parabola.
inline double exp_remainder(double x) {
  if (x > largest_exponent) {
    const double beyond = x - largest_exponent;
    return (std::exp(largest_exponent) * (1 + beyond * (1 + 0.5 * beyond)) - 1 - x) / (x * x);
  }
  if (std::fabs(x) > 1) return (std::expm1(x) - x) / (x * x);
  double sum = 0;
  for (int n = 19; n >= 2; --n) sum = (sum * x + 1) / n;
  return sum;
}

/// The derivative of x² exp_remainder(x), divided by x.
inline double mean_exp(double x) {
  if (x == 0) return 1;
  const double within = x < largest_exponent ? x : largest_exponent;
  return (std::expm1(within) + std::exp(within) * (x - within)) / x;
}

/// The mean of the second derivative of x² exp_remainder(x) between two arguments, which may
/// coincide.
inline double mean_exp_between(double x, double y) {
  const double high = x > y ? x : y;
  const double low = x > y ? y : x;
  if (low >= largest_exponent) return std::exp(largest_exponent);
  const double end = high < largest_exponent ? high : largest_exponent;
  const double half = 0.5 * (end - low);
  const double within = half > 1 ? (std::exp(end) - std::exp(low)) / (2 * half)
                                 : std::exp(low + half) * (half == 0 ? 1 : std::sinh(half) / half);
  if (high <= largest_exponent) return within;
  const double share = (high - largest_exponent) / (high - low);
  return (1 - share) * within + share * std::exp(largest_exponent);
}

/// In the axes of E, with ℓ_a = ln λ_a, ℓ̄_a = ℓ_a − ⅓ ln J and β_a = ∂W/∂ℓ̄_a = Σ_i 2μ_i/α_i
/// (exp(α_i ℓ̄_a) − 1):
///   S_a = τ_a/λ_a², τ = dev β,
///   ∂S_a/∂E_b = ((P γ P)_ab − 2 δ_ab τ_a)/(λ_a² λ_b²), γ_a = ∂β_a/∂ℓ̄_a, P = dev,
///   (S_a − S_b)/(E_a − E_b) = (s Δ coth Δ − τ_a − τ_b)/(λ_a² λ_b²) of the shear,
///   Δ = ℓ_a − ℓ_b, s = (β_a − β_b)/Δ,
/// where the forms used for s and Δ coth Δ are defined for equal stretches, too. As Σ ℓ̄_a = 0, the
/// terms of first order in W are eliminated by hand.
template <>
struct LawOf<Law::ogden> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, const T (&p)[7], Response<T>& out) {
    const Eigen3<T> axes(k.e);
    T l[3];  // ℓ
    logarithms(k, axes, l);
    const T third = (1.0 / 3) * map(k.j, [](double j) { return std::log1p(j); });

    T beta[3];
    T gamma[3];
    const T& kappa = p[0];
    out.energy = 0.5 * kappa * k.j * k.j;
    for (int a = 0; a < 3; ++a) {
      const T isochoric = l[a] - third;
      beta[a] = 0.0;
      gamma[a] = 0.0;
      for (int i = 1; i < 7; i += 2) {
        const T twice_mu = 2.0 * p[i];
        const T x = p[i + 1] * isochoric;
        out.energy +=
            twice_mu * isochoric * isochoric * map(x, [](double y) { return exp_remainder(y); });
        beta[a] += twice_mu * isochoric * map(x, [](double y) { return mean_exp(y); });
        if constexpr (WithTangent) {
          gamma[a] +=
              twice_mu * map(min(x, T(largest_exponent)), [](double y) { return std::exp(y); });
        }
      }
    }
    const T mean = (1.0 / 3) * (beta[0] + beta[1] + beta[2]);

    T ci[6];
    inverse_c(k, ci);
    const T pressure = kappa * k.j * (1.0 + k.j);
    for (int m = 0; m < 6; ++m) out.s[m] = pressure * ci[m];
    T inverse[3];  // 1/λ²
    T square[3][6];
    for (int a = 0; a < 3; ++a) {
      inverse[a] = map(l[a], [](double y) { return std::exp(-2 * y); });
      dyad(axes.vectors[a], axes.vectors[a], square[a]);
      for (int m = 0; m < 6; ++m) out.s[m] += (beta[a] - mean) * inverse[a] * square[a][m];
    }
    if constexpr (WithTangent) {
      for (T& component : out.d) component = 0.0;
      add_square(T(kappa * (1.0 + 2.0 * k.j) * (1.0 + k.j)), ci, out.d);
      add_identity_of(T(-2.0 * pressure), ci, out.d);
      const T mean_gamma = (1.0 / 3) * (gamma[0] + gamma[1] + gamma[2]);
      for (int a = 0; a < 3; ++a) {
        // (P γ P)_ab = γ_a δ_ab − ⅓ (γ_a + γ_b) + ⅑ Σ γ.
        const T own = (1.0 / 3) * (gamma[a] + mean_gamma) - 2.0 * (beta[a] - mean);
        add_square(T(inverse[a] * inverse[a] * own), square[a], out.d);
        for (int b = 0; b < a; ++b) {
          const T both = inverse[a] * inverse[b];
          const T other = (1.0 / 3) * (mean_gamma - gamma[a] - gamma[b]);
          add_symmetric(T(both * other), square[a], square[b], out.d);

          T slope = 0.0;
          for (int i = 1; i < 7; i += 2) {
            const T& alpha = p[i + 1];
            slope +=
                2.0 * p[i] * mean_between(T(alpha * (l[a] - third)), T(alpha * (l[b] - third)));
          }
          const T ratio =
              map(T(l[a] - l[b]), [](double y) { return y == 0 ? 1 : y / std::tanh(y); });
          const T shear = both * (slope * ratio - (beta[a] + beta[b] - 2.0 * mean));
          T mixed[6];
          dyad(axes.vectors[a], axes.vectors[b], mixed);
          add_square(T(2.0 * shear), mixed, out.d);
        }
      }
    }
  }

 private:
  /// ln λ_a. The least of them is corrected so that their sum is ln J: where a cell is nearly flat,
  /// rounding of the eigenvalue leaves it no digits.
  template <class T>
  static void logarithms(const Kinematics<T>& k, const Eigen3<T>& axes, T (&l)[3]) {
    for (int a = 0; a < 3; ++a) {
      l[a] = map(axes.values[a],
                 [](double e) { return 0.5 * std::log1p(e > -0.5 ? 2 * e : 1e-16 - 1); });
    }
    const T least = min(min(l[0], l[1]), l[2]);
    T rest = map(k.j, [](double j) { return std::log1p(j); }) - (l[0] + l[1] + l[2]);
    for (T& one : l) {
      const T here = map(T(one - least), [](double y) { return y == 0 ? 1.0 : 0.0; });
      one += here * rest;
      rest -= here * rest;
    }
  }

  /// The symmetric part of x ⊗ y.
  template <class T>
  static void dyad(const T (&x)[3], const T (&y)[3], T (&out)[6]) {
    for (int m = 0; m < 6; ++m) {
      out[m] = 0.5 * (x[kRow[m]] * y[kColumn[m]] + x[kColumn[m]] * y[kRow[m]]);
    }
  }

  static double mean_between(double x, double y) { return mean_exp_between(x, y); }
  static Packet mean_between(const Packet& x, const Packet& y) {
    Packet result;
    for (int i = 0; i < kPacketSize; ++i) result.values[i] = mean_exp_between(x[i], y[i]);
    return result;
  }
};

// The measure g of the change of volume: energy is g, s is ∂g/∂E, d is ∂²g/∂E² ------------------

template <Law L>
struct VolumeOf {
  /// g = J − 1.
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, Response<T>& out) {
    out.energy = k.j;
    T ci[6];
    inverse_c(k, ci);
    const T j = 1.0 + k.j;
    for (int m = 0; m < 6; ++m) out.s[m] = j * ci[m];
    if constexpr (WithTangent) {
      for (T& component : out.d) component = 0.0;
      add_square(j, ci, out.d);
      add_identity_of(T(-2.0 * j), ci, out.d);
    }
  }
};

/// g = tr ε.
template <>
struct VolumeOf<Law::linear> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, Response<T>& out) {
    of_trace<WithTangent>(T(k.h[0][0] + k.h[1][1] + k.h[2][2]), out);
  }

  template <bool WithTangent, class T>
  static void of_trace(T g, Response<T>& out) {
    out.energy = g;
    for (int m = 0; m < 6; ++m) out.s[m] = m < 3 ? 1.0 : 0.0;
    if constexpr (WithTangent) {
      for (T& component : out.d) component = 0.0;
    }
  }
};

/// g = tr E.
template <>
struct VolumeOf<Law::st_venant_kirchhoff> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, Response<T>& out) {
    VolumeOf<Law::linear>::of_trace<WithTangent>(trace(k.e), out);
  }
};

/// g = ln J.
template <>
struct VolumeOf<Law::neo_hookean> {
  template <bool WithTangent, class T>
  static void evaluate(const Kinematics<T>& k, Response<T>& out) {
    out.energy = map(k.j, [](double j) { return std::log1p(j); });
    inverse_c(k, out.s);
    if constexpr (WithTangent) {
      for (T& component : out.d) component = 0.0;
      add_identity_of(T(-2.0), out.s, out.d);
    }
  }
};

}  // namespace palpate::PALPATE_INSTRUCTION_SET
