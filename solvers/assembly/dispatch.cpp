// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/kernels.h"

namespace palpate {

namespace baseline {
const Kernels& kernels(int order, int law);
}
#ifdef PALPATE_X86_KERNELS
namespace avx2 {
const Kernels& kernels(int order, int law);
}
namespace avx512 {
const Kernels& kernels(int order, int law);
}
#endif

const Kernels& best_kernels(int order, int law) {
#ifdef PALPATE_X86_KERNELS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
    return avx512::kernels(order, law);
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return avx2::kernels(order, law);
  }
#endif
  return baseline::kernels(order, law);
}

}  // namespace palpate
