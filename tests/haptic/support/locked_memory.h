// SPDX-License-Identifier: BSD-3-Clause
// What of this process the system keeps in memory.
#pragma once

#include <cstddef>
#include <fstream>
#include <string>

// With these mlock() does nothing.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PALPATE_LOCKS_MEMORY
#endif

namespace palpate::test {

/// Bytes.
inline std::size_t locked_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::size_t kilobytes = 0;
    if (word == "VmLck:" && status >> kilobytes) return kilobytes << 10;
  }
  return 0;
}

}  // namespace palpate::test
