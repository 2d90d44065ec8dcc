// SPDX-License-Identifier: BSD-3-Clause
// Doubles that are computed with as one, and which of the instruction sets the processor has.
//
// Written with the vector extension of GCC and Clang. A kernel is always inlined, and has an
// instance for each instruction set: a function with the attribute `target`, so that nothing else
// of the source is compiled for more than the baseline. The constructor of an interpolator picks.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__)
#define PALPATE_X86_LANES
#endif

namespace palpate {

using Two = double __attribute__((vector_size(16)));
using Four = double __attribute__((vector_size(32)));
using Eight = double __attribute__((vector_size(64)));

template <class V>
inline constexpr int kLanesOf = sizeof(V) / sizeof(double);

template <class V>
[[gnu::always_inline]] inline void load(const double* from, V& v) {
  __builtin_memcpy(&v, from, sizeof v);
}

template <class V>
[[gnu::always_inline]] inline void store(const V& v, double* to) {
  __builtin_memcpy(to, &v, sizeof v);
}

enum class InstructionSet { baseline, avx2, avx512 };

[[nodiscard]] inline InstructionSet best_instruction_set() {
#ifdef PALPATE_X86_LANES
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    return InstructionSet::avx512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return InstructionSet::avx2;
#endif
  return InstructionSet::baseline;
}

}  // namespace palpate
