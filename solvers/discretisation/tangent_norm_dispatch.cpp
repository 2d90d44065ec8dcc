// SPDX-License-Identifier: BSD-3-Clause
#include "base/simd.h"
#include "discretisation/tangent_norm.h"

namespace palpate {

namespace baseline {
const TangentNorm& tangent_norm(int law, bool is_mixed);
}  // namespace baseline
#ifdef PALPATE_X86_KERNELS
namespace avx2 {
const TangentNorm& tangent_norm(int law, bool is_mixed);
}  // namespace avx2
namespace avx512 {
const TangentNorm& tangent_norm(int law, bool is_mixed);
}  // namespace avx512
#endif

const TangentNorm& best_tangent_norm(Law law, bool is_mixed) {
  const int number = static_cast<int>(law);
#ifdef PALPATE_X86_KERNELS
  switch (best_instruction_set()) {
    case InstructionSet::avx512: return avx512::tangent_norm(number, is_mixed);
    case InstructionSet::avx2: return avx2::tangent_norm(number, is_mixed);
    case InstructionSet::baseline: break;
  }
#endif
  return baseline::tangent_norm(number, is_mixed);
}

}  // namespace palpate
