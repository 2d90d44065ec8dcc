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

/// The default number of threads: the cores that this process may run on, or fewer if
/// OMP_NUM_THREADS says so; 1 without OpenMP.
/// @param num_cores This process's share of the cores where it shares the machine with others.
[[nodiscard]] int automatic_threads(int num_cores = num_usable_cores());

/// Makes a team of that many threads, the calling thread included. Null for one thread, which needs
/// no team, or where the system does not grant that many, for example because memory is limited.
/// @param threads 0 means automatic_threads().
[[nodiscard]] std::unique_ptr<Team> make_thread_team(int threads);

}  // namespace palpate
