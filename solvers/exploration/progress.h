// SPDX-License-Identifier: BSD-3-Clause
// The progress of an exploration, as it is reported to the user.
#pragma once

#include <cstdint>
#include <functional>

namespace palpate {

struct ProgressState {
  /// Configurations that are known, and the expected number of all, as far as is known now.
  std::int64_t num_done = 0;
  std::int64_t num_expected = 0;
  /// Configurations that were solved for in this run.
  std::int64_t num_solved = 0;
  /// Time since the start, and the expected time to the end, s; below zero: it is not known.
  double seconds = 0;
  double seconds_left = -1;

  [[nodiscard]] double share() const {
    return num_expected > 0 ? static_cast<double>(num_done) / static_cast<double>(num_expected) : 0;
  }
};

/// Called now and then on every rank: on rank 0 with the progress of all ranks, elsewhere with that
/// of the rank alone. If it returns false on any rank, the exploration ends, and what was found
/// until then is kept.
using Progress = std::function<bool(const ProgressState&)>;
/// Called as Progress is. If it returns true on any rank, the run pauses on all ranks, once the
/// transitions that are being made are done.
using Until = std::function<bool(const ProgressState&)>;

}  // namespace palpate
