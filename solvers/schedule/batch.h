// SPDX-License-Identifier: BSD-3-Clause
// A batch of opaque, independent tasks, shared out among the ranks. The scheduler knows nothing of
// what the tasks do.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "schedule/communicator.h"

namespace palpate {

/// Runs `execute(i)` once for each task i = 0 … owners.size() − 1, on the rank owners[i], and gives
/// every rank the results of all, by task. An error on one rank is thrown on all.
/// @note Collective; `owners` is the same on every rank.
[[nodiscard]] std::vector<Bytes> run_batch(Communicator& communicator,
                                           const std::vector<int>& owners,
                                           const std::function<Bytes(std::int64_t)>& execute);

}  // namespace palpate
