// SPDX-License-Identifier: BSD-3-Clause
#include "base/simd.h"
#include "soft_contact/kernels.h"

namespace palpate {

namespace baseline {
const ContactKernels& contact_kernels();
}  // namespace baseline
#ifdef PALPATE_X86_KERNELS
namespace avx2 {
const ContactKernels& contact_kernels();
}  // namespace avx2
namespace avx512 {
const ContactKernels& contact_kernels();
}  // namespace avx512
#endif

const ContactKernels& best_contact_kernels() {
#ifdef PALPATE_X86_KERNELS
  switch (best_instruction_set()) {
    case InstructionSet::avx512: return avx512::contact_kernels();
    case InstructionSet::avx2: return avx2::contact_kernels();
    case InstructionSet::baseline: break;
  }
#endif
  return baseline::contact_kernels();
}

}  // namespace palpate
