// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/kernels.h"

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
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
    return avx512::kernels(order, law, formulation);
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return avx2::kernels(order, law, formulation);
  }
#endif
  return baseline::kernels(order, law, formulation);
}

}  // namespace palpate
