// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/kernels.h"
#include "base/simd.h"

namespace palpate {

namespace baseline {
const Kernels& kernels(int order, int law, int formulation);
}
#ifdef PALPATE_X86_KERNELS
namespace avx2 {
const Kernels& kernels(int order, int law, int formulation);
}
namespace avx512 {
const Kernels& kernels(int order, int law, int formulation);
}
#endif

const Kernels& best_kernels(int order, int law, int formulation) {
#ifdef PALPATE_X86_KERNELS
  switch (best_instruction_set()) {
    case InstructionSet::avx512: return avx512::kernels(order, law, formulation);
    case InstructionSet::avx2: return avx2::kernels(order, law, formulation);
    case InstructionSet::baseline: break;
  }
#endif
  return baseline::kernels(order, law, formulation);
}

}  // namespace palpate
