// SPDX-License-Identifier: BSD-3-Clause
// Whether a preconditioner could be made for a matrix.
#pragma once

#include <string>

#include "base/types.h"

namespace palpate {

enum class SetupStatus {
  ok,
  /// A value is not finite.
  not_finite,
  /// The 3 × 3 blocks of some nodes are not positive definite: the body has a negative stiffness
  /// there, the matrix is indefinite, and a smoother that divides by these blocks would diverge.
  indefinite_block,
  /// The matrix is indefinite on the fields of a coarser level, and so it is indefinite itself.
  indefinite,
  /// A part of the body can move freely.
  singular,
};

struct SetupReport {
  SetupStatus status = SetupStatus::ok;
  /// The first node whose block is not positive definite (−1: there is none), and the number of
  /// such nodes.
  Index node = -1;
  Index num_indefinite_blocks = 0;
  /// A lower bound for the number of negative eigenvalues: the number on a coarser level (Cauchy's
  /// interlacing, up to rounding), or 1 if a block is indefinite.
  int negative_at_least = 0;
};

/// "3 nodes have an indefinite block, the first is node 17", …
[[nodiscard]] std::string to_string(const SetupReport& report);

}  // namespace palpate
