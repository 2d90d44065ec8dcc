// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/allocations.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PALPATE_COUNTS_ALLOCATIONS true
#else
#define PALPATE_COUNTS_ALLOCATIONS false
#endif

namespace {
std::atomic<long> number{0};
}  // namespace

#if PALPATE_COUNTS_ALLOCATIONS
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* __libc_calloc(std::size_t number, std::size_t size);
extern "C" void* __libc_realloc(void* memory, std::size_t size);
extern "C" void* __libc_memalign(std::size_t alignment, std::size_t size);
extern "C" void __libc_free(void* memory);
extern "C" void* malloc(std::size_t size) noexcept {
  ++number;
  return __libc_malloc(size);
}
extern "C" void* calloc(std::size_t count, std::size_t size) noexcept {
  ++number;
  return __libc_calloc(count, size);
}
extern "C" void* realloc(void* memory, std::size_t size) noexcept {
  ++number;
  return __libc_realloc(memory, size);
}
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++number;
  return __libc_memalign(alignment, size);
}
extern "C" int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  *memory = aligned_alloc(alignment, size);
  return *memory != nullptr ? 0 : ENOMEM;
}
extern "C" void free(void* memory) noexcept {
  if (memory != nullptr) ++number;
  __libc_free(memory);
}
#endif

namespace palpate::test {

const bool kCountsAllocations = PALPATE_COUNTS_ALLOCATIONS;

long num_allocations() { return number; }

}  // namespace palpate::test
