// SPDX-License-Identifier: BSD-3-Clause
#include "base/memory_error.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace palpate {
namespace {

constexpr double kMegabyte = 1e6;

/// The largest address space that this process has had, MB, which is what its limit bounds; 0 where
/// it is not known.
double peak_mb() noexcept {
  const int file = open("/proc/self/status", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  char text[4096] = {};
  const ssize_t length = read(file, text, sizeof text - 1);
  close(file);
  constexpr char kName[] = "VmPeak:";
  const char* const peak = length > 0 ? std::strstr(text, kName) : nullptr;
  constexpr double kUnit = 1024;  // bytes
  return peak != nullptr ? std::strtod(peak + sizeof kName - 1, nullptr) * kUnit / kMegabyte : 0;
}

}  // namespace

void describe_memory(const char* purpose, char (&text)[kMemoryTextBytes]) noexcept {
  char limit[120] = "";
  rlimit most{};
  if (getrlimit(RLIMIT_AS, &most) == 0 && most.rlim_cur != RLIM_INFINITY) {
    std::snprintf(limit, sizeof limit, " of the %.0f MB that its limit (ulimit -v) allows",
                  static_cast<double>(most.rlim_cur) / kMegabyte);
  }
  std::snprintf(text, sizeof text,
                "There is not enough memory%s%.200s. This process has taken up to %.0f MB%s. Use a "
                "coarser mesh or linear tetrahedra, fewer ranks on this machine, or one that has "
                "more memory.",
                purpose != nullptr ? " " : "", purpose != nullptr ? purpose : "", peak_mb(), limit);
}

std::string not_enough_memory(const char* purpose) {
  char text[kMemoryTextBytes];
  describe_memory(purpose, text);
  return text;
}

void require_memory(std::size_t bytes, const char* purpose) {
  if (bytes == 0) return;
  void* const place =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (place == MAP_FAILED) throw MemoryError(not_enough_memory(purpose));
  munmap(place, bytes);
}

}  // namespace palpate
