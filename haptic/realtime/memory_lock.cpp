// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/realtime/memory_lock.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <unordered_map>

namespace palpate {
namespace {

std::uintptr_t page_size() {
  static const auto size = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  return size;
}

/// The number of locks on each page of the process.
struct Counts {
  std::mutex mutex;
  std::unordered_map<std::uintptr_t, int> of_page;
};

/// The counts are never destroyed, because a thread may unlock after the static objects are gone.
Counts& counts() {
  static auto* const counts = new Counts;
  return *counts;
}

/// Calls call(address, bytes) for each run of neighbouring pages for which is_wanted() is true.
template <class IsWanted, class Call>
void for_each_row(const std::vector<std::uintptr_t>& pages, IsWanted is_wanted, Call call) {
  std::uintptr_t first = 0;
  std::uintptr_t number = 0;
  const auto end_row = [&] {
    if (number > 0) call(reinterpret_cast<void*>(first * page_size()), number * page_size());
    number = 0;
  };
  for (const std::uintptr_t page : pages) {
    if (!is_wanted(page)) continue;
    if (number > 0 && page != first + number) end_row();
    if (number == 0) first = page;
    ++number;
  }
  end_row();
}

}  // namespace

MemoryLock::MemoryLock(const MemoryRanges& ranges) {
  for (const MemoryRange& range : ranges) {
    if (range.bytes == 0) continue;
    const auto begin = reinterpret_cast<std::uintptr_t>(range.begin);
    const std::uintptr_t last = (begin + range.bytes - 1) / page_size();
    for (std::uintptr_t page = begin / page_size(); page <= last; ++page) pages_.push_back(page);
  }
  std::sort(pages_.begin(), pages_.end());
  pages_.erase(std::unique(pages_.begin(), pages_.end()), pages_.end());

  const std::lock_guard lock(counts().mutex);
  for_each_row(
      pages_, [](std::uintptr_t page) { return ++counts().of_page[page] == 1; },
      [this](void* begin, std::size_t bytes) {
        if (mlock(begin, bytes) != 0) complete_ = false;
      });
}

MemoryLock::~MemoryLock() {
  const auto is_last = [](std::uintptr_t page) {
    const auto count = counts().of_page.find(page);
    if (--count->second > 0) return false;
    counts().of_page.erase(count);
    return true;
  };
  const std::lock_guard lock(counts().mutex);
  for_each_row(pages_, is_last, [](void* begin, std::size_t bytes) { munlock(begin, bytes); });
}

}  // namespace palpate
