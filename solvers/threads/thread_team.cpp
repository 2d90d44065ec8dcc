// SPDX-License-Identifier: BSD-3-Clause
#include "threads/thread_team.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <thread>
#include <vector>

namespace palpate {
namespace {

/// The other threads wait at the end of a parallel region while its first thread works, and execute
/// tasks there. A loop waits only for threads that have started a part of it, so that on a busy
/// machine a thread without a core delays nothing.
class ThreadTeam final : public Team {
 public:
  explicit ThreadTeam(int threads) : threads_(threads) {}

  void serve(DoWork do_work, void* work) override {
    std::exception_ptr error;
#pragma omp parallel num_threads(threads_)
#pragma omp master
    try {
      do_work(work);
    } catch (...) {
      error = std::current_exception();
    }
    if (error) std::rethrow_exception(error);
  }

  void run(Index num_parts, RunPart run_part, void* loop) override {
    std::atomic<Index> next{0};
    std::atomic<bool> has_failed{false};
    std::exception_ptr error;
    const auto take_parts = [&] {
      for (Index part = next++; part < num_parts && !has_failed; part = next++) {
        try {
          run_part(loop, part);
        } catch (...) {
          if (!has_failed.exchange(true)) error = std::current_exception();
        }
      }
    };
    const Index num_tasks = std::min<Index>(threads_, num_parts);
    for (Index task = 1; task < num_tasks; ++task) {
#pragma omp task default(shared)
      take_parts();
    }
    take_parts();
#pragma omp taskwait
    if (error) std::rethrow_exception(error);
  }

 private:
  int threads_;
};

/// Whether that many threads can be started beside this one, each with memory of its own. OpenMP
/// ends the process if it cannot start one.
bool can_start(int wanted) {
  std::mutex mutex;
  std::condition_variable end;
  bool is_over = false;
  std::atomic<bool> have_memory{true};
  std::vector<std::thread> threads;
  try {
    threads.reserve(static_cast<std::size_t>(wanted));
    while (static_cast<int>(threads.size()) < wanted) {
      threads.emplace_back([&] {
        const std::unique_ptr<int> memory(new (std::nothrow) int);
        if (memory == nullptr) have_memory = false;
        std::unique_lock lock(mutex);
        end.wait(lock, [&] { return is_over; });
      });
    }
  } catch (const std::exception&) {  // there are no more
    have_memory = false;
  }
  {
    const std::lock_guard lock(mutex);
    is_over = true;
  }
  end.notify_all();
  for (std::thread& thread : threads) thread.join();
  return have_memory;
}

}  // namespace

int automatic_threads(int num_cores) {
  return std::max(1, std::min({num_cores, omp_get_max_threads(), kMostThreads}));
}

std::unique_ptr<Team> make_thread_team(int threads) {
  if (threads == 0) threads = automatic_threads();
  threads = std::min(threads, omp_get_thread_limit());
  if (threads <= 1 || !can_start(threads - 1)) return nullptr;
  auto team = std::make_unique<ThreadTeam>(threads);
  // OpenMP starts its threads now, and reuses them.
  with_team(team.get(), [] {});
  return team;
}

}  // namespace palpate
