// SPDX-License-Identifier: BSD-3-Clause
// The modes of a basis as they are stored in a file: each number as a whole number n of the step of
// its mode, which the bound of the basis makes small for most modes.
//
// n is written as 2 n, or −2 n − 1 where it is negative, in 4 bytes, lowest first; where a mode has
// no step, its numbers are written as they are, float32. First come the lowest bytes of all
// numbers, then the next ones: most of these are zero. All is deflated by zlib.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fields/reduced_fields.h"

namespace palpate {

struct PackedBasis : BasisHead {
  std::int64_t num_modes = 0;
  std::int64_t num_pressure_modes = 0;
  /// The length of a pressure mode.
  std::int64_t num_pressures = 0;
  /// See FieldBasis [num_modes + num_pressure_modes].
  Eigen::VectorXf steps;
  /// The numbers of the modes [num_modes × 3 kept points], then those of the pressure modes
  /// [num_pressure_modes × num_pressures], deflated.
  std::vector<std::byte> numbers;
};

/// A reduction as it is stored in a file. The coefficients are in the order of the configurations.
struct PackedReduction {
  PackedBasis basis;
  std::vector<ReducedFields> fields;
};

[[nodiscard]] PackedBasis pack(const FieldBasis& basis);

/// The largest size of the numbers and steps of a basis with so many modes, bytes.
/// @param num_points The number of kept points.
[[nodiscard]] std::int64_t most_bytes(const PackedBasis& head, std::int64_t num_points);

/// Reads the modes of a basis.
/// @param num_points The number of kept points.
/// @returns Nothing: the numbers are not those of so many modes, or not finite. No memory is taken
///   for modes that are not there.
[[nodiscard]] std::optional<FieldBasis> unpack(const PackedBasis& packed, std::int64_t num_points);

}  // namespace palpate
