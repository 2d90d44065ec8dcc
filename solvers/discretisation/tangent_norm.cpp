// SPDX-License-Identifier: BSD-3-Clause
// This file is compiled once for each instruction set, see PALPATE_INSTRUCTION_SET in base/simd.h.
#include "discretisation/tangent_norm.h"

#include <cstddef>
#include <limits>
#include <utility>

#include "base/simd.h"
#include "materials/laws.h"

namespace palpate::PALPATE_INSTRUCTION_SET {
namespace {

/// ½ D : A : D with A from the response at F, in which s and d are those of one law:
/// D_iJ A_iJkL D_kL = D_iJ S_JL D_iL + X : D : X with X = sym FᵀD.
/// @param x Set to X.
template <Law L>
Packet half_square(const Kinematics<Packet>& k, const Response<Packet>& r, const Packet (&d)[3][3],
                   Packet (&x)[6]) {
  Packet sum = 0.0;
  for (int m = 0; m < 6; ++m) {
    const int i = kRow[m];
    const int j = kColumn[m];
    x[m] = 0.5 * (d[i][j] + d[j][i]);
    if constexpr (L != Law::linear) {
      for (int c = 0; c < 3; ++c) x[m] += 0.5 * (k.h[c][i] * d[c][j] + k.h[c][j] * d[c][i]);
      const Packet square = d[0][i] * d[0][j] + d[1][i] * d[1][j] + d[2][i] * d[2][j];
      sum += (m < 3 ? 1.0 : 2.0) * r.s[m] * square;
    }
  }
  for (int m = 0; m < 6; ++m) {
    const double of_row = m < 3 ? 1.0 : 2.0;
    sum += of_row * of_row * r.d[lower(m, m)] * x[m] * x[m];
    for (int n = 0; n < m; ++n) {
      sum += 2.0 * of_row * (n < 3 ? 1.0 : 2.0) * r.d[lower(m, n)] * x[m] * x[n];
    }
  }
  return 0.5 * sum;
}

void load(const double* from, Packet (&to)[3][3]) {
  for (int i = 0; i < 9; ++i) to[i / 3][i % 3] = Packet::load(from + i * kPacketSize);
}

template <Law L, bool Mixed>
void evaluate(int num_packets, const double* constants, const double* h, const double* d,
              const double* pressure, double* norm) {
  constexpr int kTensor = 9 * kPacketSize;
  for (int p = 0; p < num_packets; ++p) {
    Packet of_law[kNumConstants<L>];
    for (int i = 0; i < kNumConstants<L>; ++i) {
      of_law[i] = Packet::load(constants + (p * kNumConstants<L> + i) * kPacketSize);
    }
    Kinematics<Packet> k;
    load(h + static_cast<std::ptrdiff_t>(p) * kTensor, k.h);
    k.update();
    [[maybe_unused]] const Packet determinant = 1.0 + k.j;
    if constexpr (has_inversion_barrier(L)) {
      // Where the law is not defined, the norm is no number (below); no other lane may become one.
      k.j = max(k.j, Packet(std::numeric_limits<double>::epsilon() - 1.0));
    }
    Response<Packet> r;
    LawOf<L>::template evaluate<true>(k, of_law, r);
    [[maybe_unused]] Response<Packet> volume;
    if constexpr (Mixed) {
      VolumeOf<L>::template evaluate<true>(k, volume);
      const Packet at = Packet::load(pressure + 3 * p * kPacketSize);
      for (int m = 0; m < 6; ++m) r.s[m] += at * volume.s[m];
      for (int m = 0; m < 21; ++m) r.d[m] += at * volume.d[m];
    }
    Packet change[3][3];
    load(d + static_cast<std::ptrdiff_t>(p) * kTensor, change);
    Packet x[6];
    Packet sum = half_square<L>(k, r, change, x);
    if constexpr (Mixed) {
      const Packet of_pressure = Packet::load(pressure + (3 * p + 1) * kPacketSize);
      const Packet compliance = Packet::load(pressure + (3 * p + 2) * kPacketSize);
      Packet of_volume = 0.0;
      for (int m = 0; m < 6; ++m) of_volume += (m < 3 ? 1.0 : 2.0) * volume.s[m] * x[m];
      sum += of_pressure * of_volume - 0.5 * compliance * of_pressure * of_pressure;
    }
    sum.store(norm + p * kPacketSize);
    if constexpr (has_inversion_barrier(L)) {
      for (int lane = 0; lane < kPacketSize; ++lane) {
        if (determinant[lane] > 0) continue;
        norm[p * kPacketSize + lane] = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
}

/// [mixed or not][law]; entries of laws that use the formulas of another law are empty.
struct Table {
  TangentNorm entries[2][num_laws];
};

template <Law L>
void fill(Table& table) {
  if constexpr (law_of_energy(L) == L) {
    table.entries[0][static_cast<int>(L)] = {kNumConstants<L>, &evaluate<L, false>};
    table.entries[1][static_cast<int>(L)] = {kNumConstants<L>, &evaluate<L, true>};
  }
}

template <int... Laws>
Table make_table(std::integer_sequence<int, Laws...> /*laws*/) {
  Table table{};
  (fill<static_cast<Law>(Laws)>(table), ...);
  return table;
}

}  // namespace

const TangentNorm& tangent_norm(int law, bool is_mixed) {
  static const Table table = make_table(std::make_integer_sequence<int, num_laws>());
  return table.entries[is_mixed ? 1 : 0][law];
}

}  // namespace palpate::PALPATE_INSTRUCTION_SET
