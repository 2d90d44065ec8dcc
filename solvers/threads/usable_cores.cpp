// SPDX-License-Identifier: BSD-3-Clause
#include "threads/usable_cores.h"

#include <sched.h>

#include <algorithm>
#include <thread>

namespace palpate {
namespace {

constexpr int kMostCores = 1 << 14;

}  // namespace

std::vector<char> usable_cores() {
  std::vector<char> usable;
  if (cpu_set_t* set = CPU_ALLOC(kMostCores)) {
    const std::size_t size = CPU_ALLOC_SIZE(kMostCores);
    if (sched_getaffinity(0, size, set) == 0) {
      for (int core = 0; core < kMostCores; ++core) {
        if (!CPU_ISSET_S(core, size, set)) continue;
        usable.resize(static_cast<std::size_t>(core) + 1, 0);
        usable.back() = 1;
      }
    }
    CPU_FREE(set);
  }
  if (usable.empty()) usable.assign(std::max(1U, std::thread::hardware_concurrency()), 1);
  return usable;
}

int num_usable_cores() {
  const std::vector<char> usable = usable_cores();
  return static_cast<int>(std::count(usable.begin(), usable.end(), 1));
}

int share_of_cores(const std::vector<std::vector<char>>& all, std::size_t own) {
  double share = 0;
  for (std::size_t core = 0; core < all[own].size(); ++core) {
    if (all[own][core] == 0) continue;
    const auto users = std::count_if(all.begin(), all.end(), [core](const auto& cores) {
      return core < cores.size() && cores[core] != 0;
    });
    share += 1.0 / static_cast<double>(users);
  }
  constexpr double kRounding = 1e-9;
  return std::max(1, static_cast<int>(share + kRounding));
}

}  // namespace palpate
