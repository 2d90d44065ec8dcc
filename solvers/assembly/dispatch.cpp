// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/kernels.h"
#include "base/simd.h"

namespace palpate {

namespace baseline {
const Kernels& kernels(int order, int law, bool is_mixed);
const MemoryKernels& memory_kernels(int order, bool is_linear);
}  // namespace baseline
#ifdef PALPATE_X86_KERNELS
namespace avx2 {
const Kernels& kernels(int order, int law, bool is_mixed);
const MemoryKernels& memory_kernels(int order, bool is_linear);
}  // namespace avx2
namespace avx512 {
const Kernels& kernels(int order, int law, bool is_mixed);
const MemoryKernels& memory_kernels(int order, bool is_linear);
}  // namespace avx512
#endif

const Kernels& best_kernels(int order, int law, bool is_mixed) {
#ifdef PALPATE_X86_KERNELS
  switch (best_instruction_set()) {
    case InstructionSet::avx512: return avx512::kernels(order, law, is_mixed);
    case InstructionSet::avx2: return avx2::kernels(order, law, is_mixed);
    case InstructionSet::baseline: break;
  }
#endif
  return baseline::kernels(order, law, is_mixed);
}

const MemoryKernels& best_memory_kernels(int order, bool is_linear) {
#ifdef PALPATE_X86_KERNELS
  switch (best_instruction_set()) {
    case InstructionSet::avx512: return avx512::memory_kernels(order, is_linear);
    case InstructionSet::avx2: return avx2::memory_kernels(order, is_linear);
    case InstructionSet::baseline: break;
  }
#endif
  return baseline::memory_kernels(order, is_linear);
}

}  // namespace palpate
