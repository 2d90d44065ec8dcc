// SPDX-License-Identifier: BSD-3-Clause
// A law at one point as a function of H = ∇u, by the formulas of materials/laws.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <type_traits>

#include "base/types.h"
#include "materials/laws.h"

namespace palpate::test {

using baseline::Kinematics;
using baseline::LawOf;
using baseline::Packet;
using baseline::Response;

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat9 = Eigen::Matrix<double, 9, 9>;
using Vec9 = Eigen::Matrix<double, 9, 1>;

/// Calls f with the law as a std::integral_constant.
template <class F>
auto with_law(Law law, F&& f) {
  switch (law) {
    case Law::linear: return f(std::integral_constant<Law, Law::linear>{});
    case Law::st_venant_kirchhoff: return f(std::integral_constant<Law, Law::st_venant_kirchhoff>{});
    case Law::neo_hookean: return f(std::integral_constant<Law, Law::neo_hookean>{});
    default: return f(std::integral_constant<Law, Law::mooney_rivlin>{});
  }
}

/// `constants` as law_constants() gives them.
inline Response<double> respond(Law which, const std::array<double, 3>& constants, const Mat3& h) {
  Kinematics<double> k;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) k.h[i][j] = h(i, j);
  }
  k.update();
  const double p[3] = {constants[0], constants[1], constants[2]};
  Response<double> r;
  with_law(which,
           [&](auto law) { LawOf<decltype(law)::value>::template evaluate<true>(k, p, r); });
  return r;
}

inline Response<double> respond(const Material& material, const Mat3& h) {
  return respond(material.law, law_constants(material), h);
}

/// S, or σ of the linear law.
inline Mat3 stress(const Response<double>& r) {
  Mat3 s;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) s(i, j) = r.s[baseline::kSymmetric[i][j]];
  }
  return s;
}

/// ∂S_m/∂E_n.
inline Mat6 tangent(const Response<double>& r) {
  Mat6 d;
  for (int m = 0; m < 6; ++m) {
    for (int n = 0; n < 6; ++n) d(m, n) = r.d[baseline::lower(m, n)];
  }
  return d;
}

/// First Piola–Kirchhoff stress P = F S; σ for the linear law.
inline Mat3 first_piola(const Material& material, const Mat3& h) {
  const Mat3 s = stress(respond(material, h));
  return material.law == Law::linear ? s : Mat3((Mat3::Identity() + h) * s);
}

/// ∂P_iJ/∂H_kL as a matrix, columns of the tensors one below the other.
inline Mat9 first_piola_tangent(const Material& material, const Mat3& h) {
  const Response<double> r = respond(material, h);
  const bool linear = material.law == Law::linear;
  const Mat3 f = linear ? Mat3::Identity() : Mat3(Mat3::Identity() + h);
  Mat9 a;
  for (int i = 0; i < 3; ++i) {
    for (int jj = 0; jj < 3; ++jj) {
      for (int k = 0; k < 3; ++k) {
        for (int ll = 0; ll < 3; ++ll) {
          double value = !linear && i == k ? r.s[baseline::kSymmetric[jj][ll]] : 0;
          for (int m = 0; m < 3; ++m) {
            for (int n = 0; n < 3; ++n) {
              value += f(i, m) * f(k, n) *
                       r.d[baseline::lower(baseline::kSymmetric[m][jj], baseline::kSymmetric[n][ll])];
            }
          }
          a(i + 3 * jj, k + 3 * ll) = value;
        }
      }
    }
  }
  return a;
}

}  // namespace palpate::test
