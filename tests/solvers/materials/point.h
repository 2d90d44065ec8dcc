// SPDX-License-Identifier: BSD-3-Clause
// A law at one point as a function of H = ∇u, by the formulas of materials/laws.h.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <type_traits>

#include "base/types.h"
#include "materials/laws.h"

namespace palpate::test {

using baseline::Kinematics;
using baseline::kNumConstants;
using baseline::LawOf;
using baseline::Packet;
using baseline::Response;
using baseline::VolumeOf;

using Constants = std::array<double, max_parameters>;

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat9 = Eigen::Matrix<double, 9, 9>;
using Vec9 = Eigen::Matrix<double, 9, 1>;

/// Calls f with the law of the energy as a std::integral_constant.
template <class F>
auto with_law(Law law, F&& f) {
  switch (law_of_energy(law)) {
    case Law::linear: return f(std::integral_constant<Law, Law::linear>{});
    case Law::st_venant_kirchhoff:
      return f(std::integral_constant<Law, Law::st_venant_kirchhoff>{});
    case Law::neo_hookean: return f(std::integral_constant<Law, Law::neo_hookean>{});
    case Law::mooney_rivlin_polynomial:
      return f(std::integral_constant<Law, Law::mooney_rivlin_polynomial>{});
    case Law::fung: return f(std::integral_constant<Law, Law::fung>{});
    case Law::ogden: return f(std::integral_constant<Law, Law::ogden>{});
    default: return f(std::integral_constant<Law, Law::mooney_rivlin>{});
  }
}

inline Kinematics<double> kinematics(const Mat3& h) {
  Kinematics<double> k;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) k.h[i][j] = h(i, j);
  }
  k.update();
  return k;
}

/// `constants` as law_constants() gives them.
template <bool WithTangent = true>
Response<double> respond(Law which, const Constants& constants, const Mat3& h) {
  Response<double> r;
  with_law(which, [&](auto law) {
    constexpr Law kLaw = decltype(law)::value;
    double p[kNumConstants<kLaw>];
    std::copy_n(constants.begin(), kNumConstants<kLaw>, p);
    LawOf<kLaw>::template evaluate<WithTangent>(kinematics(h), p, r);
  });
  return r;
}

inline Response<double> respond(const Material& material, const Mat3& h) {
  return respond(material.law, law_constants(material), h);
}

/// The law's measure g of the change of volume, ∂g/∂E and ∂²g/∂E² as a response.
inline Response<double> volume_response(Law which, const Mat3& h) {
  Response<double> r;
  with_law(which, [&](auto law) {
    VolumeOf<decltype(law)::value>::template evaluate<true>(kinematics(h), r);
  });
  return r;
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
inline Mat3 first_piola(Law law, const Response<double>& r, const Mat3& h) {
  return law == Law::linear ? stress(r) : Mat3((Mat3::Identity() + h) * stress(r));
}

inline Mat3 first_piola(const Material& material, const Mat3& h) {
  return first_piola(material.law, respond(material, h), h);
}

/// ∂P_iJ/∂H_kL as a matrix, columns of the tensors one below the other.
inline Mat9 first_piola_tangent(Law law, const Response<double>& r, const Mat3& h) {
  const bool linear = law == Law::linear;
  const Mat3 f = linear ? Mat3::Identity() : Mat3(Mat3::Identity() + h);
  Mat9 a;
  for (int i = 0; i < 3; ++i) {
    for (int jj = 0; jj < 3; ++jj) {
      for (int k = 0; k < 3; ++k) {
        for (int ll = 0; ll < 3; ++ll) {
          double value = !linear && i == k ? r.s[baseline::kSymmetric[jj][ll]] : 0;
          for (int m = 0; m < 3; ++m) {
            for (int n = 0; n < 3; ++n) {
              value +=
                  f(i, m) * f(k, n) *
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

inline Mat9 first_piola_tangent(const Material& material, const Mat3& h) {
  return first_piola_tangent(material.law, respond(material, h), h);
}

}  // namespace palpate::test
