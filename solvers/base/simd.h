// SPDX-License-Identifier: BSD-3-Clause
// Several numbers that are computed with as one, and the instruction sets for this.
//
// This is written with the vector extension of GCC and Clang, so that one source serves SSE2, AVX2
// and AVX-512. Code is compiled for more than the baseline in one of two ways.
//
//   A function has the attribute `target`, and all that it calls is always inlined: then nothing
//   else of the source is compiled for more than the baseline.
//
//   A source is compiled once for each instruction set, and sets PALPATE_INSTRUCTION_SET to a name
//   of its own. That name becomes part of every symbol, so that the linker cannot merge, say, an
//   AVX-512 instance into the code of a machine that lacks it.
//
// The instruction set is chosen at run time: see best_instruction_set().
#pragma once

#include <cmath>

#ifndef PALPATE_INSTRUCTION_SET
#define PALPATE_INSTRUCTION_SET baseline
#endif

#if defined(__x86_64__) && defined(__GNUC__)
#define PALPATE_X86_SIMD
#endif

namespace palpate {

enum class InstructionSet { baseline, avx2, avx512 };

/// The best instruction set that the processor supports.
[[nodiscard]] InstructionSet best_instruction_set();

using Two = double __attribute__((vector_size(16)));
using Four = double __attribute__((vector_size(32)));
using Eight = double __attribute__((vector_size(64)));
using FourFloats = float __attribute__((vector_size(16)));
using EightFloats = float __attribute__((vector_size(32)));

template <class V>
inline constexpr int kSizeOf = sizeof(V) / sizeof(double);

template <class T, class V>
[[gnu::always_inline]] inline void load(const T* from, V& v) {
  __builtin_memcpy(&v, from, sizeof v);
}

template <class T, class V>
[[gnu::always_inline]] inline void store(const V& v, T* to) {
  __builtin_memcpy(to, &v, sizeof v);
}

/// The number of values in a packet.
inline constexpr int kPacketSize = kSizeOf<Eight>;

namespace PALPATE_INSTRUCTION_SET {

/// Eight numbers in one value, which can be combined with scalars in any expression.
struct Packet {
  Eight values;

  Packet() = default;
  Packet(Eight v) : values(v) {}             // NOLINT: a packet is its values
  Packet(double x) : values(x - Eight{}) {}  // NOLINT: scalars mix freely with packets

  [[nodiscard]] static Packet load(const double* p) {
    Packet result;
    palpate::load(p, result.values);
    return result;
  }
  void store(double* p) const { palpate::store(values, p); }
  [[nodiscard]] double operator[](int i) const { return values[i]; }

  Packet& operator+=(Packet other) {
    values += other.values;
    return *this;
  }
  Packet& operator-=(Packet other) {
    values -= other.values;
    return *this;
  }
  Packet& operator*=(Packet other) {
    values *= other.values;
    return *this;
  }
  friend Packet operator+(Packet a, Packet b) { return a.values + b.values; }
  friend Packet operator-(Packet a, Packet b) { return a.values - b.values; }
  friend Packet operator*(Packet a, Packet b) { return a.values * b.values; }
  friend Packet operator/(Packet a, Packet b) { return a.values / b.values; }
  friend Packet operator-(Packet a) { return -a.values; }
};

inline Packet min(Packet a, Packet b) { return a.values < b.values ? a.values : b.values; }
inline Packet max(Packet a, Packet b) { return a.values > b.values ? a.values : b.values; }

/// A bit for each number that is positive, that of the first one the lowest.
inline unsigned positive_bits(Packet a) {
  const auto is_positive = a.values > Eight{};
#if defined(__AVX512DQ__)
  long long __attribute__((vector_size(64))) mask;
  __builtin_memcpy(&mask, &is_positive, sizeof mask);
  return __builtin_ia32_cvtq2mask512(mask);
#else
  unsigned bits = 0;
#if defined(__AVX__)
  Four parts[2];
  __builtin_memcpy(parts, &is_positive, sizeof parts);
  for (unsigned i = 0; i < 2; ++i) {
    bits |= static_cast<unsigned>(__builtin_ia32_movmskpd256(parts[i])) << (4 * i);
  }
#elif defined(__SSE2__)
  Two parts[4];
  __builtin_memcpy(parts, &is_positive, sizeof parts);
  for (unsigned i = 0; i < 4; ++i) {
    bits |= static_cast<unsigned>(__builtin_ia32_movmskpd(parts[i])) << (2 * i);
  }
#else
  for (unsigned i = 0; i < kPacketSize; ++i) bits |= (is_positive[i] != 0 ? 1U : 0U) << i;
#endif
  return bits;
#endif
}

/// Applies f to each number.
template <class F>
Packet map(Packet a, F&& f) {
  Packet result;
  for (int i = 0; i < kPacketSize; ++i) result.values[i] = f(a.values[i]);
  return result;
}

inline double min(double a, double b) { return a < b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }
template <class F>
double map(double a, F&& f) {
  return f(a);
}

}  // namespace PALPATE_INSTRUCTION_SET
}  // namespace palpate
