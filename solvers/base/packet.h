// SPDX-License-Identifier: BSD-3-Clause
// Eight doubles that are computed with as one: a lane an element of the mesh.
//
// Written with the vector extension of GCC and Clang, so that one source serves SSE2, AVX2 and
// AVX-512. A source that is compiled for more than the baseline sets PALPATE_INSTRUCTION_SET to a
// name of its own: it becomes part of every symbol, so that the linker cannot merge, say, an
// AVX-512 instance into the code of a machine that lacks it.
#pragma once

#include <cmath>

#ifndef PALPATE_INSTRUCTION_SET
#define PALPATE_INSTRUCTION_SET baseline
#endif

namespace palpate::PALPATE_INSTRUCTION_SET {

inline constexpr int kLanes = 8;

struct Packet {
  using Lanes = double __attribute__((vector_size(8 * kLanes)));
  Lanes lanes;

  Packet() = default;
  Packet(Lanes l) : lanes(l) {}             // NOLINT: a packet is its lanes
  Packet(double x) : lanes(x - Lanes{}) {}  // NOLINT: scalars mix freely with packets

  [[nodiscard]] static Packet load(const double* p) {
    Packet result;
    __builtin_memcpy(&result.lanes, p, sizeof(Lanes));
    return result;
  }
  void store(double* p) const { __builtin_memcpy(p, &lanes, sizeof(Lanes)); }
  [[nodiscard]] double operator[](int lane) const { return lanes[lane]; }

  Packet& operator+=(Packet other) { lanes += other.lanes; return *this; }
  Packet& operator-=(Packet other) { lanes -= other.lanes; return *this; }
  Packet& operator*=(Packet other) { lanes *= other.lanes; return *this; }
  friend Packet operator+(Packet a, Packet b) { return a.lanes + b.lanes; }
  friend Packet operator-(Packet a, Packet b) { return a.lanes - b.lanes; }
  friend Packet operator*(Packet a, Packet b) { return a.lanes * b.lanes; }
  friend Packet operator/(Packet a, Packet b) { return a.lanes / b.lanes; }
  friend Packet operator-(Packet a) { return -a.lanes; }
};

inline Packet min(Packet a, Packet b) { return a.lanes < b.lanes ? a.lanes : b.lanes; }
inline Packet max(Packet a, Packet b) { return a.lanes > b.lanes ? a.lanes : b.lanes; }

/// f of every lane.
template <class F>
Packet map(Packet a, F&& f) {
  Packet result;
  for (int lane = 0; lane < kLanes; ++lane) result.lanes[lane] = f(a.lanes[lane]);
  return result;
}

inline double min(double a, double b) { return a < b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }
template <class F>
double map(double a, F&& f) {
  return f(a);
}

}  // namespace palpate::PALPATE_INSTRUCTION_SET
