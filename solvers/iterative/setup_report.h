// SPDX-License-Identifier: BSD-3-Clause
// Whether a matrix could be prepared for.
#pragma once

#include <string>

#include "base/types.h"

namespace palpate {

enum class SetupStatus {
  ok,
  /// A value is no number.
  not_finite,
  /// The 3 × 3 blocks of some nodes are not positive definite: there the body has a negative
  /// stiffness by itself, the matrix is indefinite, and a smoother that divides by these blocks
  /// would diverge.
  indefinite_block,
  /// The matrix is indefinite on fields that a coarser level knows, and so it is itself.
  indefinite,
  /// A part of the body can move freely.
  singular,
};

struct SetupReport {
  SetupStatus status = SetupStatus::ok;
  /// The first node whose block is not positive definite, −1: there is none; and their number.
  Index node = -1;
  Index num_indefinite_blocks = 0;
  /// The matrix has at least so many negative eigenvalues: those that were counted on a coarser
  /// level (Cauchy's interlacing, up to rounding), or 1 where a block is indefinite.
  int negative_at_least = 0;
};

/// "3 nodes have an indefinite block, the first is node 17", …
[[nodiscard]] std::string to_string(const SetupReport& report);

}  // namespace palpate
