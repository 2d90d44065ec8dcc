// SPDX-License-Identifier: BSD-3-Clause
// How a solve ended. Every solve ends with an Outcome and Flags, so that nothing downstream uses a
// bad configuration unknowingly. The numbers are stored in files and shown in data arrays: do not
// change them.
#pragma once

#include <cstdint>
#include <string>

namespace palpate {

enum class Outcome : std::int32_t {
  converged = 0,
  not_converged = 1,
  tangent_not_factorised = 2,
  budget_used_up = 3,
  aborted = 4,
  invalid_scene = 5,
  /// Conjugate gradients did not converge for the tangent, which had no factor.
  tangent_not_solved = 6,
  /// A rigid tool has passed through the surface into the body: the pressure on it there is no
  /// longer that of a contact, or is absent.
  tool_inside = 7,
};

/// Properties of a configuration, as bits.
namespace flags {
using Flags = std::int32_t;
/// det F ≤ 0 somewhere in a cell: at a quadrature point, at a corner, or between them.
inline constexpr Flags inverted = 1;
/// The tangent at the solution has negative pivots.
inline constexpr Flags unstable = 2;
/// |h| exceeds the force limit; the configuration is stored, but not expanded.
inline constexpr Flags beyond_force_limit = 4;
inline constexpr Flags near_fold = 8;
/// The number of negative pivots is not known (a neighbour's factor was used).
inline constexpr Flags inertia_not_computed = 16;
/// An equilibrium to rounding whose displacement is less accurate than was asked for, or a time
/// step that would have to be shorter than permitted to meet its tolerance.
inline constexpr Flags inaccurate = 32;
/// The tool touches nothing: the body is at rest, and force, stiffness and energy are exactly zero.
inline constexpr Flags touches_nothing = 64;
/// Every flag there is.
inline constexpr Flags all = 2 * touches_nothing - 1;
}  // namespace flags
using flags::Flags;

/// "converged", "not converged", …
[[nodiscard]] std::string to_string(Outcome outcome);

/// "inverted, unstable"; empty when no bit is set.
[[nodiscard]] std::string flags_to_string(Flags flags);

}  // namespace palpate
