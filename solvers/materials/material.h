// SPDX-License-Identifier: BSD-3-Clause
// A hyperelastic material as the user gives it: a law and its parameters.
//
//   linear                      W = λ/2 (tr ε)² + μ ε:ε,   ε = sym ∇u
//   St. Venant–Kirchhoff        W = λ/2 (tr E)² + μ E:E                         [P06, 2.4]
//   neo-Hookean                 W = μ/2 (I₁ − 3) − μ ln J + λ/2 ln² J
//   Mooney–Rivlin               W = C₁₀(Ī₁ − 3) + C₀₁(Ī₂ − 3) + κ/2 (J − 1)²    [P06, 2.5]
//   Mooney–Rivlin polynomial    W = Σ C_rs (Ī₁ − 3)^r (Ī₂ − 3)^s + κ/2 (J − 1)², 1 ≤ r + s ≤ 3
//   Fung–Demiray                W = μ/(2b) (exp(b(Ī₁ − 3)) − 1) + κ/2 (J − 1)²
//   incompressible              the first two terms of Mooney–Rivlin, J = 1
//   Ogden                       W = Σ_i 2μ_i/α_i² (λ̄₁^α_i + λ̄₂^α_i + λ̄₃^α_i − 3) + κ/2 (J − 1)²
//
// with E = ½(C − I), C = FᵀF, Ī₁ = J^(−2/3) I₁, Ī₂ = J^(−4/3) I₂, λ̄_a = J^(−1/3) λ_a of the
// principal stretches λ_a; W in J/m³ at rest.
//
// Every law is W = W_rest + κ̂/2 g² with a volumetric modulus κ̂ and a measure g of the change of
// volume: g = tr ε, tr E, ln J or J − 1. The displacement formulation takes W as it stands and
// locks where κ̂ is large beside the shear modulus. The mixed formulation has the pressure-like p =
// κ̂ g as an unknown of its own: W_rest + p g − p²/(2κ̂), where κ̂ may be infinite.
//
// [P06] I. Peterlík, Haptic Interaction with Deformable Objects, Masaryk University 2006.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace palpate {

/// The law of a material. The numbers are stored in files and data arrays: do not change them.
enum class Law : int {
  linear = 0,
  st_venant_kirchhoff = 1,
  neo_hookean = 2,
  mooney_rivlin = 3,
  mooney_rivlin_polynomial = 4,
  fung = 5,
  neo_hookean_incompressible = 6,
  mooney_rivlin_incompressible = 7,
  ogden = 8,
};

inline constexpr int num_laws = 9;

/// How the material resists a change of volume. The numbers are stored, as those of `Law` are.
enum class Formulation : int {
  /// By the displacement alone.
  displacement = 0,
  /// Through a pressure unknown: free of volumetric locking.
  mixed = 1,
  /// Mixed, with a finer quadrature rule: a Tet10 has 15 points instead of 4, so that the inversion
  /// barrier acts at more places. A Tet4, whose strain is constant, has one point in either rule.
  mixed_fine = 2,
};

inline constexpr int num_formulations = 3;

[[nodiscard]] constexpr bool is_mixed(Formulation formulation) {
  return formulation != Formulation::displacement;
}

/// The name of a law: 'Linear', 'St. Venant-Kirchhoff', 'Neo-Hookean', 'Mooney-Rivlin',
/// 'Mooney-Rivlin polynomial', 'Fung', 'Neo-Hookean incompressible', 'Mooney-Rivlin incompressible'
/// or 'Ogden'.
[[nodiscard]] std::string to_string(Law law);

[[nodiscard]] constexpr bool is_incompressible(Law law) {
  return law == Law::neo_hookean_incompressible || law == Law::mooney_rivlin_incompressible;
}

/// The law whose formulas serve this one: Mooney–Rivlin for the incompressible ones, else itself.
[[nodiscard]] constexpr Law law_of_energy(Law law) {
  return is_incompressible(law) ? Law::mooney_rivlin : law;
}

/// Whether W is undefined for det F ≤ 0, where its energy counts as infinite, so that no
/// equilibrium is inverted at a quadrature point.
[[nodiscard]] constexpr bool has_inversion_barrier(Law law) {
  return law != Law::linear && law != Law::st_venant_kirchhoff;
}

/// Powers (r, s) of the coefficients of the polynomial, in the order in which they are stored.
inline constexpr int num_polynomial_terms = 9;
inline constexpr std::array<std::array<int, 2>, num_polynomial_terms> polynomial_powers{
    {{1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3}}};

/// The largest number of terms of Ogden's energy.
inline constexpr int max_ogden_terms = 3;

inline constexpr int max_parameters = 1 + num_polynomial_terms;

/// The names of the parameters of a law in the order of Material::parameters, as many as it has:
/// 'YoungsModulus', 'PoissonsRatio', 'Exponent', 'C10', 'C01', 'C20', …, 'C03', 'BulkModulus',
/// 'OgdenModulus1', 'OgdenExponent1', …, 'OgdenExponent3'.
[[nodiscard]] const std::vector<std::string>& parameter_names(Law law);

struct Material {
  Law law = Law::st_venant_kirchhoff;
  /// The parameters as the user gave them, Pa or without unit, followed by zeros:
  ///   linear, St. Venant–Kirchhoff, neo-Hookean   Young's modulus, Poisson's ratio
  ///   Mooney–Rivlin                               C₁₀, C₀₁, κ
  ///   polynomial                                  κ, C₁₀, C₀₁, C₂₀, C₁₁, C₀₂, C₃₀, C₂₁, C₁₂, C₀₃
  ///   Fung                                        Young's modulus, Poisson's ratio, exponent b
  ///   neo-Hookean incompressible                  Young's modulus
  ///   Mooney–Rivlin incompressible                C₁₀, C₀₁
  ///   Ogden                                       κ, μ₁, α₁, μ₂, α₂, μ₃, α₃; α_i is 0 where μ_i is
  std::array<double, max_parameters> parameters{};
  Formulation formulation = Formulation::displacement;

  bool operator==(const Material& other) const {
    return law == other.law && parameters == other.parameters && formulation == other.formulation;
  }
};

/// A material with the formulation that suits it: mixed where it is incompressible or Poisson's
/// ratio at rest is above 0.45.
/// @param parameters In the order of Material::parameters.
/// @throws InputError a parameter is out of its range; the message names it.
[[nodiscard]] Material make_material(Law law, const std::array<double, max_parameters>& parameters);

/// The material in another formulation than the one that suits it.
/// @throws InputError the formulation is displacement and the law incompressible, or the
///   formulation is mixed and κ̂ is not positive.
[[nodiscard]] Material with_formulation(Material material, Formulation formulation);

/// A linear, St. Venant–Kirchhoff or neo-Hookean material from Young's modulus (Pa) and Poisson's
/// ratio.
[[nodiscard]] Material make_isotropic(Law law, double youngs_modulus, double poissons_ratio);
[[nodiscard]] Material make_mooney_rivlin(double c10, double c01, double bulk_modulus);

/// The constants of the law's energy: (λ, μ) of linear, St. Venant–Kirchhoff and neo-Hookean, (C₁₀,
/// C₀₁, κ) of Mooney–Rivlin (κ = 0 where it is incompressible), (κ, C₁₀, …, C₀₃) of the polynomial,
/// (μ, b, κ) of Fung, and (κ, μ₁, α₁, …, α₃) of Ogden. For a mixed material they are those of
/// W_rest: λ or κ is 0.
[[nodiscard]] std::array<double, max_parameters> law_constants(const Material& material);

/// 1/κ̂, 1/Pa: the inverse of λ or κ; 0 where the law is incompressible.
[[nodiscard]] double volumetric_compliance(const Material& material);

/// Shear modulus at rest, Pa.
[[nodiscard]] double shear_modulus(const Material& material);
/// Bulk modulus at rest, Pa; infinite where the law is incompressible.
[[nodiscard]] double bulk_modulus(const Material& material);
/// Young's modulus at rest, Pa.
[[nodiscard]] double youngs_modulus(const Material& material);
/// Poisson's ratio at rest.
[[nodiscard]] double poissons_ratio(const Material& material);

}  // namespace palpate
