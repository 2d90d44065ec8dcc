// SPDX-License-Identifier: BSD-3-Clause
// Threads for the loops of base/parallel.h: those of the compiler's OpenMP, or none where the
// project is built without it.
#pragma once

#include <memory>

#include "base/parallel.h"
#include "threads/usable_cores.h"

namespace palpate {

/// The largest number of threads that may be asked for.
inline constexpr int kMostThreads = 1024;

/// As many threads as this process can make use of: the cores that it may run on, or less where
/// OMP_NUM_THREADS says so. 1 without OpenMP.
/// @param num_cores Those that fall to it where it shares the machine with others.
[[nodiscard]] int automatic_threads(int num_cores = num_usable_cores());

/// A team of so many threads, the one that works among them. Null: of one thread no team is needed;
/// or the system does not grant as many, as where memory is limited.
/// @param threads 0: automatic_threads().
[[nodiscard]] std::unique_ptr<Team> make_thread_team(int threads);

}  // namespace palpate
