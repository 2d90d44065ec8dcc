// SPDX-License-Identifier: BSD-3-Clause
// A hyperelastic material as the user gives it: a law and its parameters.
//
//   linear                 W = λ/2 (tr ε)² + μ ε:ε,   ε = sym ∇u
//   St. Venant–Kirchhoff   W = λ/2 (tr E)² + μ E:E                         [P06, 2.4]
//   neo-Hookean            W = μ/2 (I₁ − 3) − μ ln J + λ/2 ln² J
//   Mooney–Rivlin          W = C₁₀(Ī₁ − 3) + C₀₁(Ī₂ − 3) + κ/2 (J − 1)²    [P06, 2.5]
//
// with E = ½(C − I), C = FᵀF, Ī₁ = J^(−2/3) I₁, Ī₂ = J^(−4/3) I₂; W in J/m³ at rest.
// [P06] I. Peterlík, Haptic Interaction with Deformable Objects, Masaryk University 2006.
#pragma once

#include <array>
#include <string>

namespace palpate {

/// The numbers are stored in files and data arrays: keep them.
enum class Law : int { linear = 0, st_venant_kirchhoff = 1, neo_hookean = 2, mooney_rivlin = 3 };

inline constexpr int num_laws = 4;

/// 'Linear', 'St. Venant-Kirchhoff', 'Neo-Hookean', 'Mooney-Rivlin'.
[[nodiscard]] std::string to_string(Law law);

/// True where W is not defined for det F ≤ 0 and its energy counts as infinite there, so that no
/// equilibrium is inverted at a quadrature point.
[[nodiscard]] constexpr bool has_inversion_barrier(Law law) {
  return law == Law::neo_hookean || law == Law::mooney_rivlin;
}

struct Material {
  Law law = Law::st_venant_kirchhoff;
  /// As the user gave them: (Young's modulus Pa, Poisson's ratio, –) or for Mooney–Rivlin
  /// (C₁₀, C₀₁, κ), Pa.
  std::array<double, 3> parameters{};

  bool operator==(const Material& other) const {
    return law == other.law && parameters == other.parameters;
  }
};

/// Linear, St. Venant–Kirchhoff or neo-Hookean from Young's modulus (Pa) and Poisson's ratio.
/// @throws InputError a modulus that is not positive, a ratio outside (−1, 0.5).
[[nodiscard]] Material make_isotropic(Law law, double youngs_modulus, double poissons_ratio);

/// @throws InputError C₁₀ + C₀₁ or κ not positive, or a value that is not finite.
[[nodiscard]] Material make_mooney_rivlin(double c10, double c01, double bulk_modulus);

/// The constants of the law's energy: (λ, μ, –) or for Mooney–Rivlin (C₁₀, C₀₁, κ), Pa.
[[nodiscard]] std::array<double, 3> law_constants(const Material& material);

/// Shear modulus at rest, Pa.
[[nodiscard]] double shear_modulus(const Material& material);
/// Bulk modulus at rest, Pa.
[[nodiscard]] double bulk_modulus(const Material& material);

}  // namespace palpate
