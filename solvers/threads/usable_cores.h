// SPDX-License-Identifier: BSD-3-Clause
// The cores that a process may run on, and its share of them beside other processes.
#pragma once

#include <vector>

namespace palpate {

/// 1 for each core of the machine that this process may run on, else 0.
[[nodiscard]] std::vector<char> usable_cores();
[[nodiscard]] int num_usable_cores();

/// The number of cores for each process if several share their cores evenly, at least 1.
/// @param all The usable cores of each process on the machine.
/// @param own The place in `all` of the process in question.
[[nodiscard]] int share_of_cores(const std::vector<std::vector<char>>& all, std::size_t own);

}  // namespace palpate
