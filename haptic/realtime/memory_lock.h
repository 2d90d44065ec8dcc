// SPDX-License-Identifier: BSD-3-Clause
// A lock keeps pages of memory from being paged out while it lives.
//
// It locks only what it is given. mlockall() would lock all that the program has and will have:
// inside ParaView also the data sets that are shown, which may be larger than the memory.
//
// The system does not count locks: one munlock() of a page undoes every mlock() of it. Objects of
// the heap share pages, so locks are counted here, a page at a time, for the whole process.
#pragma once

#include <cstdint>
#include <vector>

#include "base/memory_ranges.h"

namespace palpate {

class MemoryLock {
 public:
  /// Locks the pages that hold the ranges, as far as the system permits (RLIMIT_MEMLOCK).
  explicit MemoryLock(const MemoryRanges& ranges);
  /// Unlocks the pages that no other lock has.
  ~MemoryLock();
  MemoryLock(const MemoryLock&) = delete;
  MemoryLock& operator=(const MemoryLock&) = delete;

  /// Whether all of the pages are locked.
  [[nodiscard]] bool complete() const { return complete_; }

 private:
  /// The numbers of the pages, ascending.
  std::vector<std::uintptr_t> pages_;
  bool complete_ = true;
};

}  // namespace palpate
