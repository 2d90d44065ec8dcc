// SPDX-License-Identifier: BSD-3-Clause
#include "linear/blas.h"

#include <dlfcn.h>

#include <cstddef>

#include "base/memory_error.h"

namespace palpate {
namespace {

/// Ranks work in parallel already; threads of the BLAS under each rank would compete for the cores.
void keep_to_one_thread() {
  if (void* set_threads = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) {
    reinterpret_cast<void (*)(int)>(set_threads)(1);
  }
}

/// OpenBLAS allocates a buffer at the first product of matrices and keeps it. If memory is short
/// then, it tries again for ever. So it allocates the buffer here, after a check that there is
/// memory.
void take_buffer() {
  void* const allocate = dlsym(RTLD_DEFAULT, "blas_memory_alloc");
  void* const free = dlsym(RTLD_DEFAULT, "blas_memory_free");
  if (allocate == nullptr || free == nullptr) return;
  // At most 128 MiB, of address space only, and some bytes to align it.
  constexpr std::size_t kMostBytes = (std::size_t{128} << 20) + (1 << 16);
  require_memory(kMostBytes, "for the buffer of OpenBLAS, of 134 MB");
  constexpr int kForProduct = 0;
  void* const buffer = reinterpret_cast<void* (*)(int)>(allocate)(kForProduct);
  reinterpret_cast<void (*)(void*)>(free)(buffer);
}

}  // namespace

void prepare_blas() {
  keep_to_one_thread();
  static bool has_buffer = false;
  if (has_buffer) return;
  take_buffer();
  has_buffer = true;
}

}  // namespace palpate
