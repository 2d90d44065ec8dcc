// SPDX-License-Identifier: BSD-3-Clause
#include "base/simd.h"

namespace palpate {

InstructionSet best_instruction_set() {
#ifdef PALPATE_X86_SIMD
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    return InstructionSet::avx512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return InstructionSet::avx2;
#endif
  return InstructionSet::baseline;
}

}  // namespace palpate
