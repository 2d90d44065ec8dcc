// SPDX-License-Identifier: BSD-3-Clause
// The properties of a material besides its elasticity: inertia, and two kinds of viscosity, added
// up.
//
//   S(t) = S_∞(E(t)) + Σ_j g_j ∫₀ᵗ exp(−(t − s)/τ_j) d/ds S_∞(E(s)) ds + τ C₀ : Ė(t)
//
// S_∞ is the stress of the hyperelastic law, to which the material relaxes, and C₀ = ∂S_∞/∂E at
// rest. The sum is quasi-linear viscoelasticity with a Prony series [Fung], in the reference
// configuration: right after a sudden strain the material is 1 + Σ g_j times as stiff as after it
// has relaxed. The last term is Kelvin–Voigt viscosity.
//
// [Fung] Y. C. Fung, Biomechanics: Mechanical Properties of Living Tissues, 2nd ed., 7.6.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "materials/material.h"

namespace palpate {

inline constexpr int max_prony_terms = 4;

struct Rheology {
  /// ρ at rest, kg/m³; 0 means no inertia.
  double density = 0;
  /// τ, s.
  double viscous_time = 0;
  /// g_j, without unit, and τ_j, s. A term with g_j = 0 is absent, and its τ_j is 0.
  std::array<double, max_prony_terms> prony_moduli{};
  std::array<double, max_prony_terms> prony_times{};

  [[nodiscard]] bool is_viscous() const;
  bool operator==(const Rheology& other) const {
    return density == other.density && viscous_time == other.viscous_time &&
           prony_moduli == other.prony_moduli && prony_times == other.prony_times;
  }
};

/// @throws InputError a number is negative or not finite, a term's time is not positive, or the
///   times do not ascend from term to term; the message names the number.
void validate(const Rheology& rheology);

/// Whether any of the materials has inertia.
[[nodiscard]] bool has_density(const std::vector<Rheology>& rheologies);

/// The numbers of a Rheology one by one, as they are stored.
inline constexpr int num_rheology_values = 2 + 2 * max_prony_terms;
using RheologyValues = std::array<double, num_rheology_values>;

/// The name of each: 'Density', 'ViscousTime', 'PronyModulus1', 'PronyTime1', …, 'PronyTime4'.
[[nodiscard]] const std::array<std::string, num_rheology_values>& rheology_names();
/// @throws InputError as validate().
[[nodiscard]] Rheology make_rheology(const RheologyValues& values);
[[nodiscard]] RheologyValues values_of(const Rheology& rheology);

/// The material whose energy is the given material's energy times a factor.
[[nodiscard]] Material scaled(Material material, double factor);

}  // namespace palpate
