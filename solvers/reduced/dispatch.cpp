// SPDX-License-Identifier: BSD-3-Clause
#include "base/simd.h"
#include "reduced/kernels.h"

namespace palpate {

namespace baseline {
const ReducedKernels& reduced_kernels();
}  // namespace baseline
#ifdef PALPATE_X86_KERNELS
namespace avx2 {
const ReducedKernels& reduced_kernels();
}  // namespace avx2
namespace avx512 {
const ReducedKernels& reduced_kernels();
}  // namespace avx512
#endif

const ReducedKernels& best_reduced_kernels() {
#ifdef PALPATE_X86_KERNELS
  switch (best_instruction_set()) {
    case InstructionSet::avx512: return avx512::reduced_kernels();
    case InstructionSet::avx2: return avx2::reduced_kernels();
    case InstructionSet::baseline: break;
  }
#endif
  return baseline::reduced_kernels();
}

}  // namespace palpate
