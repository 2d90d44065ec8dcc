// SPDX-License-Identifier: BSD-3-Clause
// The cores that a process may run on, and those of them that are left to it by others.
#pragma once

#include <vector>

namespace palpate {

/// 1 for each core of the machine that this process may run on, else 0.
[[nodiscard]] std::vector<char> usable_cores();
[[nodiscard]] int num_usable_cores();

/// How many cores fall to a process where several share theirs evenly, at least 1.
/// @param all The usable cores of each process on the machine.
/// @param own Of which of them.
[[nodiscard]] int share_of_cores(const std::vector<std::vector<char>>& all, std::size_t own);

}  // namespace palpate
