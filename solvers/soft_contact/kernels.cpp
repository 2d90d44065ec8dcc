// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set, see PALPATE_INSTRUCTION_SET in base/simd.h.
//
// What a point i sees of another one j:
//
//   m = w_j k s,   k = ⟨1 − |r|²/ρ²⟩⁴,   s = s(−n_i · n_j),   g = n_j · r,   r = x_i − x_j
//
// S_i is the sum of m and P_i that of m g. k and s are the same from j.
#include "soft_contact/kernels.h"

#include <cmath>

#include "soft_contact/smooth_step.h"

namespace palpate::PALPATE_INSTRUCTION_SET {
namespace {

constexpr int kBlock = 9;
constexpr unsigned kWholeRow = 0xff;

/// Place of the component (i, j) of a symmetric matrix.
constexpr int kPlace[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};

[[gnu::always_inline]] inline Packet at(const double (&values)[kPacketSize]) {
  return Packet::load(values);
}

template <class F>
[[gnu::always_inline]] inline double fold(const Packet& a, F&& f) {
  const Eight v = a.values;
  const Four four = f(__builtin_shufflevector(v, v, 0, 1, 2, 3),  //
                      __builtin_shufflevector(v, v, 4, 5, 6, 7));
  const Two two =
      f(__builtin_shufflevector(four, four, 0, 1), __builtin_shufflevector(four, four, 2, 3));
  return f(two, __builtin_shufflevector(two, two, 1, 0))[0];
}
[[gnu::always_inline]] inline double sum(const Packet& a) {
  return fold(a, [](auto x, auto y) { return x + y; });
}
[[gnu::always_inline]] inline double least(const Packet& a) {
  return fold(a, [](auto x, auto y) { return x < y ? x : y; });
}
[[gnu::always_inline]] inline double most(const Packet& a) {
  return fold(a, [](auto x, auto y) { return x > y ? x : y; });
}

[[gnu::always_inline]] inline void add_to(double* sum_of, const Packet& value) {
  (Packet::load(sum_of) + value).store(sum_of);
}

/// What the point i of a packet sees of the points of another one.
struct Row {
  Packet r[3];
  /// 1 − |r|²/ρ², not negative.
  Packet t;
  /// −n_i · n_j over kFullyFacing, between 0 and 1.
  Packet facing;
  /// Whether that is 1 for all, so that s is too.
  bool fully;
};

/// 1/ρ² of the points of two packets.
[[gnu::always_inline]] inline double inverse_squared(const PointPacket& here,
                                                     const PointPacket& there, double around) {
  return std::min(here.inverse_reach_squared, there.inverse_reach_squared) / (around * around);
}

/// @param inverse 1/ρ².
/// @returns Whether one is in reach.
[[gnu::always_inline]] inline bool look(const PointPacket& here, int i, const PointPacket& there,
                                        double inverse, Row& row) {
  Packet square = 0.0;
  for (int c = 0; c < 3; ++c) {
    row.r[c] = here.place[c][i] - at(there.place[c]);
    square += row.r[c] * row.r[c];
  }
  const Packet t = 1.0 - inverse * square;
  if (positive_bits(t) == 0) return false;
  Packet facing = 0.0;
  for (int c = 0; c < 3; ++c) facing -= here.normal[c][i] * at(there.normal[c]);
  row.t = max(t, 0.0);
  row.facing = min(max(facing / kFullyFacing, 0.0), 1.0);
  row.fully = positive_bits(1.0 - row.facing) == 0;
  return true;
}

/// A bit for each point of a packet that may have one of the other packet in reach: it is near
/// enough to the box around them.
[[gnu::always_inline]] inline unsigned rows_near(const PointPacket& here, const PointPacket& there,
                                                 double inverse) {
  Packet square = 0.0;
  for (int c = 0; c < 3; ++c) {
    const Packet x = at(here.place[c]);
    const Packet outside = max(max(there.low[c] - x, x - there.high[c]), 0.0);
    square += outside * outside;
  }
  return positive_bits(at(here.area)) & positive_bits(1.0 - inverse * square);
}

/// Calls f with each number of a bit that is set.
template <class F>
[[gnu::always_inline]] inline void for_each_bit(unsigned bits, F&& f) {
  for (; bits != 0; bits &= bits - 1) f(__builtin_ctz(bits));
}

/// The row i of what may touch, of which 1 is yes.
[[gnu::always_inline]] inline unsigned allowed_row(std::uint64_t allowed, int i) {
  return static_cast<unsigned>(allowed >> (kPacketSize * i)) & kWholeRow;
}

/// Removes the points that may not touch.
[[gnu::always_inline]] inline void forbid(unsigned allowed, Packet& weight) {
  if (allowed == kWholeRow) return;
  for (int j = 0; j < kPacketSize; ++j) {
    if ((allowed >> j & 1U) == 0) weight.values[j] = 0;
  }
}

void features(const ContactFacesView& faces, const double* places, PointPacket* points) {
  for (std::int32_t f = 0; f < faces.num_faces; ++f) {
    const std::int32_t* nodes = faces.nodes + f * faces.nodes_per_face;
    const std::int32_t first = faces.first_packet[f];
    for (std::int32_t p = first; p < faces.first_packet[f + 1]; ++p) {
      const ShapePacket& shape = faces.shapes[f][p - first];
      Packet x[3] = {0.0, 0.0, 0.0};
      Packet t1[3] = {0.0, 0.0, 0.0};
      Packet t2[3] = {0.0, 0.0, 0.0};
      for (int a = 0; a < faces.nodes_per_face; ++a) {
        const double* place = places + 3 * std::int64_t{nodes[a]};
        const auto& of_node = shape.of_nodes[a];
        for (int c = 0; c < 3; ++c) {
          x[c] += at(of_node[0]) * place[c];
          t1[c] += at(of_node[1]) * place[c];
          t2[c] += at(of_node[2]) * place[c];
        }
      }
      const Packet across[3] = {t1[1] * t2[2] - t1[2] * t2[1], t1[2] * t2[0] - t1[0] * t2[2],
                                t1[0] * t2[1] - t1[1] * t2[0]};
      const Packet square = across[0] * across[0] + across[1] * across[1] + across[2] * across[2];
      const Packet inverse = 1.0 / map(square, [](double v) { return std::sqrt(v); });
      PointPacket& packet = points[p];
      for (int c = 0; c < 3; ++c) {
        x[c].store(packet.place[c]);
        t1[c].store(packet.tangent_1[c]);
        t2[c].store(packet.tangent_2[c]);
        (inverse * across[c]).store(packet.normal[c]);
        packet.low[c] = least(x[c]);
        packet.high[c] = most(x[c]);
      }
      inverse.store(packet.inverse_norm);
      Packet::load(faces.areas[f] + (p - first) * kPacketSize).store(packet.area);
      packet.inverse_reach_squared = 1 / (faces.reaches[f] * faces.reaches[f]);
    }
  }
}

void sums(const PointPacket* points, const NearPacketsView& near, double around, double* s,
          double* p, unsigned char* rows) {
  for (std::int64_t k = 0; k < std::int64_t{near.num_packets} * kPacketSize; ++k) s[k] = p[k] = 0;
  for (std::int32_t packet = 0; packet < near.num_packets; ++packet) {
    const PointPacket& here = points[packet];
    Packet s_here[kPacketSize];
    Packet p_here[kPacketSize];
    for (int i = 0; i < kPacketSize; ++i) s_here[i] = p_here[i] = 0.0;
    for (std::size_t k = near.first_greater[packet]; k < near.first[packet + 1]; ++k) {
      const std::int32_t other = near.others[k];
      const PointPacket& there = points[other];
      const double inverse = inverse_squared(here, there, around);
      Packet s_there = 0.0;
      Packet p_there = 0.0;
      rows[k] = 0;
      for_each_bit(rows_near(here, there, inverse), [&](int i) {
        const double area = here.area[i];
        Row row;
        if (!look(here, i, there, inverse, row)) return;
        rows[k] = static_cast<unsigned char>(rows[k] | 1U << i);
        const Packet t2 = row.t * row.t;
        Packet weight = inverse * (t2 * t2);
        if (!row.fully) weight *= smooth_step(row.facing).value;
        forbid(allowed_row(near.allowed[k], i), weight);
        Packet from_here = 0.0;
        Packet from_there = 0.0;
        for (int c = 0; c < 3; ++c) {
          from_here += at(there.normal[c]) * row.r[c];
          from_there -= here.normal[c][i] * row.r[c];
        }
        const Packet of_there = at(there.area) * weight;
        s_here[i] += of_there;
        p_here[i] += of_there * from_here;
        s_there += area * weight;
        p_there += area * weight * from_there;
      });
      if (rows[k] == 0) continue;
      add_to(s + std::int64_t{other} * kPacketSize, s_there);
      add_to(p + std::int64_t{other} * kPacketSize, p_there);
    }
    for (int i = 0; i < kPacketSize; ++i) {
      s[std::int64_t{packet} * kPacketSize + i] += sum(s_here[i]);
      p[std::int64_t{packet} * kPacketSize + i] += sum(p_here[i]);
    }
  }
}

/// Whether a point of a packet acts.
[[gnu::always_inline]] inline bool acts(const JetView& jet, std::int32_t packet) {
  return positive_bits(-Packet::load(jet.by_p + std::int64_t{packet} * kPacketSize)) != 0;
}

void gradient(const PointPacket* points, const NearPacketsView& near, const unsigned char* rows,
              const JetView& jet, double* gradient) {
  const std::int64_t size = 6 * kPacketSize;
  for (std::int64_t k = 0; k < near.num_packets * size; ++k) gradient[k] = 0;
  for (std::int32_t packet = 0; packet < near.num_packets; ++packet) {
    const PointPacket& here = points[packet];
    const double* by_s = jet.by_s + std::int64_t{packet} * kPacketSize;
    const double* by_p = jet.by_p + std::int64_t{packet} * kPacketSize;
    const bool acts_here = acts(jet, packet);
    Packet of_here[kPacketSize][6];
    for (auto& of_point : of_here) {
      for (Packet& value : of_point) value = 0.0;
    }
    for (std::size_t k = near.first_greater[packet]; k < near.first[packet + 1]; ++k) {
      const std::int32_t other = near.others[k];
      const bool acts_there = acts(jet, other);
      if (rows[k] == 0 || (!acts_here && !acts_there)) continue;
      const PointPacket& there = points[other];
      const double inverse = inverse_squared(here, there, 1);
      const Packet s_there = Packet::load(jet.by_s + std::int64_t{other} * kPacketSize);
      const Packet p_there = Packet::load(jet.by_p + std::int64_t{other} * kPacketSize);
      Packet of_there[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
      for_each_bit(rows[k], [&](int i) {
        const double area = here.area[i];
        Row row;
        if ((by_p[i] == 0 && !acts_there) || !look(here, i, there, inverse, row)) return;
        const Packet t2 = row.t * row.t;
        Packet kernel = inverse * (t2 * t2);
        Packet by_r = (-8 * inverse * inverse) * (t2 * row.t);
        const unsigned allowed = allowed_row(near.allowed[k], i);
        forbid(allowed, kernel);
        forbid(allowed, by_r);
        Packet from_here = 0.0;
        Packet from_there = 0.0;
        for (int c = 0; c < 3; ++c) {
          from_here += at(there.normal[c]) * row.r[c];
          from_there -= here.normal[c][i] * row.r[c];
        }
        // Of m and of m g together, as j is seen from i and as i is seen from j.
        const Packet all = at(there.area) * (by_s[i] + by_p[i] * from_here) +
                           area * (s_there + p_there * from_there);
        Packet along = all * by_r;
        Packet weight = kernel;
        if (!row.fully) {
          const SmoothStep<Packet> step = smooth_step(row.facing);
          along *= step.value;
          weight *= step.value;
          const Packet turned = (-1 / kFullyFacing) * (all * kernel * step.slope);
          for (int c = 0; c < 3; ++c) {
            of_here[i][3 + c] += turned * at(there.normal[c]);
            of_there[3 + c] += turned * here.normal[c][i];
          }
        }
        const Packet g_here = by_p[i] * at(there.area) * weight;
        const Packet g_there = area * p_there * weight;
        for (int c = 0; c < 3; ++c) {
          const Packet of_place =
              along * row.r[c] + g_here * at(there.normal[c]) - g_there * here.normal[c][i];
          of_here[i][c] += of_place;
          of_there[c] -= of_place;
          of_here[i][3 + c] -= g_there * row.r[c];
          of_there[3 + c] += g_here * row.r[c];
        }
      });
      for (int c = 0; c < 6; ++c) add_to(gradient + other * size + c * kPacketSize, of_there[c]);
    }
    for (int i = 0; i < kPacketSize; ++i) {
      for (int c = 0; c < 6; ++c) {
        gradient[packet * size + c * kPacketSize + i] += sum(of_here[i][c]);
      }
    }
  }
}

void to_nodes(const ContactFacesView& faces, const PointPacket* points, const double* gradient,
              double* of_nodes) {
  for (std::int32_t f = 0; f < faces.num_faces; ++f) {
    const std::int32_t first = faces.first_packet[f];
    Packet of_face[kMostFaceNodes][3];
    for (auto& of_node : of_face) {
      for (Packet& value : of_node) value = 0.0;
    }
    for (std::int32_t p = first; p < faces.first_packet[f + 1]; ++p) {
      const double* values = gradient + std::int64_t{p} * 6 * kPacketSize;
      const PointPacket& packet = points[p];
      const ShapePacket& shape = faces.shapes[f][p - first];
      Packet by_place[3];
      Packet across[3];
      Packet t1[3];
      Packet t2[3];
      Packet along = 0.0;
      for (int c = 0; c < 3; ++c) {
        by_place[c] = Packet::load(values + c * kPacketSize);
        across[c] = Packet::load(values + (3 + c) * kPacketSize);
        t1[c] = at(packet.tangent_1[c]);
        t2[c] = at(packet.tangent_2[c]);
        along += across[c] * at(packet.normal[c]);
      }
      for (int c = 0; c < 3; ++c) {
        across[c] = at(packet.inverse_norm) * (across[c] - along * at(packet.normal[c]));
      }
      for (int c = 0; c < 3; ++c) {
        const int d = (c + 1) % 3;
        const int e = (c + 2) % 3;
        const Packet by_1 = t2[d] * across[e] - t2[e] * across[d];
        const Packet by_2 = across[d] * t1[e] - across[e] * t1[d];
        for (int a = 0; a < faces.nodes_per_face; ++a) {
          const auto& of_node = shape.of_nodes[a];
          of_face[a][c] +=
              at(of_node[0]) * by_place[c] + at(of_node[1]) * by_1 + at(of_node[2]) * by_2;
        }
      }
    }
    for (int a = 0; a < faces.nodes_per_face; ++a) {
      double* of_node = of_nodes + 3 * std::int64_t{faces.nodes[f * faces.nodes_per_face + a]};
      for (int c = 0; c < 3; ++c) of_node[c] += sum(of_face[a][c]);
    }
  }
}

void find_seen(const PointPacket* points, const NearPacketsView& near, double around,
               const char* acts, char* seen) {
  for (std::int32_t packet = 0; packet < near.num_packets; ++packet) {
    for (std::size_t k = near.first[packet]; k < near.first[packet + 1]; ++k) {
      seen[k] = 0;
      const PointPacket& there = points[near.others[k]];
      const double inverse = inverse_squared(points[packet], there, around);
      for_each_bit(rows_near(points[packet], there, inverse), [&](int i) {
        Row row;
        if (seen[k] != 0 || acts[std::int64_t{packet} * kPacketSize + i] == 0 ||
            !look(points[packet], i, there, inverse, row)) {
          return;
        }
        Packet weight = row.t * row.facing * at(there.area);
        forbid(allowed_row(near.allowed[k], i), weight);
        seen[k] = positive_bits(weight) != 0 ? 1 : 0;
      });
    }
  }
}

/// The derivative of the normal by a tangent, rows by normal.
struct NormalSlopes {
  Packet by_1[3][3];
  Packet by_2[3][3];
};

/// (I − n nᵀ)/|a| times −[t₂]× and [t₁]×.
[[gnu::always_inline]] inline NormalSlopes normal_slopes(const PointPacket& point) {
  Packet across[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      across[i][j] = at(point.inverse_norm) *
                     ((i == j ? 1.0 : 0.0) - at(point.normal[i]) * at(point.normal[j]));
    }
  }
  NormalSlopes slopes;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      // The column j of [t]× has t[k] in the row l, and −t[l] in the row k.
      const int k = (j + 2) % 3;
      const int l = (j + 1) % 3;
      slopes.by_1[i][j] =
          across[i][k] * at(point.tangent_2[l]) - across[i][l] * at(point.tangent_2[k]);
      slopes.by_2[i][j] =
          across[i][l] * at(point.tangent_1[k]) - across[i][k] * at(point.tangent_1[l]);
    }
  }
  return slopes;
}

/// Sums for the points of a packet over what they see, but for the place of the points in them.
struct GroupSums {
  /// The derivatives of P and S by place and normal.
  Packet p[kPacketSize][6];
  Packet s[kPacketSize][6];
  Packet curvature[kPacketSize][21];
};

/// The derivatives, by the nodes of a face that is seen, of those by place and normal of a point.
struct Crossed {
  Packet values[6][3];
};

/// Derivatives of P and of S by the nodes of a face.
struct OfSums {
  Packet p[3];
  Packet s[3];
};

/// Adds what a point sees of a packet.
/// @param normal_too Is set if the derivative by the normal of the point is not 0.
[[gnu::always_inline]] inline void add_seen(const PointPacket& here, int i, const JetView& jet,
                                            std::int64_t number, const PointPacket& there,
                                            const NormalSlopes& slopes, const ShapePacket& shape,
                                            double inverse, unsigned allowed, Row& row,
                                            GroupSums& sums, CurvaturePacket& curvature,
                                            Crossed& crossed, OfSums& of_sums, bool& normal_too) {
  const double by_s = jet.by_s[number];
  const double by_p = jet.by_p[number];
  Packet area = inverse * at(there.area);
  forbid(allowed, area);
  const SmoothStep<Packet> step = smooth_step(row.facing);
  const Packet t2 = row.t * row.t;
  const Packet of_kernel = area * t2 * t2;
  const Packet of_facing = area * step.value;
  const Packet by_r = (-8 * inverse) * (t2 * row.t);
  const Packet by_rr = (48 * inverse * inverse) * t2;
  const Packet slope = step.slope / kFullyFacing;
  const bool turns = positive_bits(slope * of_kernel) != 0;
  Packet n_there[3];
  double n_here[3];
  Packet g = 0.0;
  for (int c = 0; c < 3; ++c) {
    n_there[c] = at(there.normal[c]);
    n_here[c] = here.normal[c][i];
    g += n_there[c] * row.r[c];
  }
  const Packet all = by_s + by_p * g;
  const Packet weight = of_kernel * step.value;
  const Packet by_facing = -of_kernel * slope;
  const Packet m_r = of_facing * by_r;
  const Packet all_rr = all * of_facing * by_rr;
  const Packet all_r = all * m_r;

  // By place and normal of i and j, and by place of i and j; the latter has the opposite sign by
  // x_j.
  Packet rr[3][3];
  for (int c = 0; c < 3; ++c) {
    for (int d = c; d < 3; ++d) {
      rr[c][d] = all_rr * row.r[c] * row.r[d] +
                 by_p * m_r * (row.r[c] * n_there[d] + row.r[d] * n_there[c]);
      if (c == d) rr[c][d] += all_r;
      rr[d][c] = rr[c][d];
      sums.curvature[i][kPlace[c][d]] += rr[c][d];
      add_to(curvature.values[kPlace[c][d]], rr[c][d]);
    }
  }
  Packet q[3];
  for (int c = 0; c < 3; ++c) {
    q[c] = by_p * by_facing * n_there[c] - all * area * slope * by_r * row.r[c];
  }
  Packet rj[3][3];
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) {
      rj[c][d] = q[c] * n_here[d] + by_p * m_r * row.r[c] * row.r[d];
      if (c == d) rj[c][d] += by_p * weight;
      add_to(curvature.values[CurvaturePacket::kMixed + 3 * c + d], -rj[c][d]);
    }
  }

  // S and P by place and normal of the two.
  Packet s_normal[3];
  Packet p_normal[3];
  Packet s_place[3];
  Packet p_place[3];
  for (int c = 0; c < 3; ++c) {
    s_place[c] = m_r * row.r[c];
    p_place[c] = g * s_place[c] + weight * n_there[c];
    s_normal[c] = by_facing * n_here[c];
    p_normal[c] = g * s_normal[c] + weight * row.r[c];
    sums.s[i][c] += s_place[c];
    sums.p[i][c] += p_place[c];
  }

  // By the tangents of j in place of its normal. Columns: place, tangent 1, tangent 2.
  double columns[6][3][3][kPacketSize];
  double of_s[3][3][kPacketSize];
  double of_p[3][3][kPacketSize];
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) {
      (-rr[c][d]).store(columns[c][d][0]);
      Packet by_1 = 0.0;
      Packet by_2 = 0.0;
      for (int e = 0; e < 3; ++e) {
        by_1 += rj[c][e] * slopes.by_1[e][d];
        by_2 += rj[c][e] * slopes.by_2[e][d];
      }
      by_1.store(columns[c][d][1]);
      by_2.store(columns[c][d][2]);
    }
    (-s_place[c]).store(of_s[c][0]);
    (-p_place[c]).store(of_p[c][0]);
    Packet s_1 = 0.0;
    Packet s_2 = 0.0;
    Packet p_1 = 0.0;
    Packet p_2 = 0.0;
    for (int e = 0; e < 3; ++e) {
      s_1 += s_normal[e] * slopes.by_1[e][c];
      s_2 += s_normal[e] * slopes.by_2[e][c];
      p_1 += p_normal[e] * slopes.by_1[e][c];
      p_2 += p_normal[e] * slopes.by_2[e][c];
    }
    s_1.store(of_s[c][1]);
    s_2.store(of_s[c][2]);
    p_1.store(of_p[c][1]);
    p_2.store(of_p[c][2]);
  }
  if (turns) {
    normal_too = true;
    const Packet turned = all * of_kernel * step.curvature / (kFullyFacing * kFullyFacing);
    const Packet p_facing = by_p * by_facing;
    for (int c = 0; c < 3; ++c) {
      sums.s[i][3 + c] += by_facing * n_there[c];
      sums.p[i][3 + c] += g * by_facing * n_there[c];
      for (int d = 0; d < 3; ++d) {
        sums.curvature[i][CurvaturePacket::kMixed + 3 * c + d] += q[c] * n_there[d];
        if (d >= c) {
          sums.curvature[i][CurvaturePacket::kNormal + kPlace[c][d]] +=
              turned * n_there[c] * n_there[d];
          add_to(curvature.values[CurvaturePacket::kNormal + kPlace[c][d]],
                 turned * n_here[c] * n_here[d] +
                     p_facing * (n_here[c] * row.r[d] + n_here[d] * row.r[c]));
        }
      }
    }
    for (int c = 0; c < 3; ++c) {
      Packet nn[3];
      for (int d = 0; d < 3; ++d) {
        nn[d] = n_there[c] * (turned * n_here[d] + p_facing * row.r[d]);
        if (c == d) nn[d] += all * by_facing;
      }
      for (int d = 0; d < 3; ++d) {
        (-n_there[c] * q[d]).store(columns[3 + c][d][0]);
        Packet by_1 = 0.0;
        Packet by_2 = 0.0;
        for (int e = 0; e < 3; ++e) {
          by_1 += nn[e] * slopes.by_1[e][d];
          by_2 += nn[e] * slopes.by_2[e][d];
        }
        by_1.store(columns[3 + c][d][1]);
        by_2.store(columns[3 + c][d][2]);
      }
    }
  }

  const int rows = turns ? 6 : 3;
  for (int j = 0; j < kPacketSize; ++j) {
    if (row.t[j] == 0 || area[j] == 0) continue;
    const Packet of_place = at(shape.at_points[j][0]);
    const Packet of_1 = at(shape.at_points[j][1]);
    const Packet of_2 = at(shape.at_points[j][2]);
    for (int c = 0; c < rows; ++c) {
      for (int d = 0; d < 3; ++d) {
        crossed.values[c][d] += columns[c][d][0][j] * of_place + columns[c][d][1][j] * of_1 +
                                columns[c][d][2][j] * of_2;
      }
    }
    for (int d = 0; d < 3; ++d) {
      of_sums.s[d] += of_s[d][0][j] * of_place + of_s[d][1][j] * of_1 + of_s[d][2][j] * of_2;
      of_sums.p[d] += of_p[d][0][j] * of_place + of_p[d][1][j] * of_1 + of_p[d][2][j] * of_2;
    }
  }
}

/// Adds the derivative by the nodes of two faces.
void add_block(const double (&block)[kMostFaceNodes][kBlock][kPacketSize], int nodes_per_face,
               const std::uint16_t* rows, const std::uint16_t* columns, std::int64_t size,
               double* matrix) {
  for (int a = 0; a < nodes_per_face; ++a) {
    for (int b = 0; b < nodes_per_face; ++b) {
      const std::int64_t row = 3 * std::int64_t{rows[a]};
      const std::int64_t column = 3 * std::int64_t{columns[b]};
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) {
          const double value = block[a][3 * c + d][b];
          if (row >= column) matrix[row + c + (column + d) * size] += value;
          if (column >= row) matrix[column + d + (row + c) * size] += value;
        }
      }
    }
  }
}

void couple(const ContactGroupView& group, const PointPacket* points, const JetView& jet,
            CurvaturePacket* curvature, double* room, double* matrix) {
  const auto size = static_cast<std::int64_t>(clique_rows(group.num_nodes));
  const int per_face = group.nodes_per_face;
  const PointPacket& here = points[group.packet];
  const std::int64_t first = std::int64_t{group.packet} * kPacketSize;
  const NormalSlopes slopes_here = normal_slopes(here);
  // Two columns for each point: the derivatives of P and of S by the nodes; then the same, weighed.
  double* of_sums = room;
  double* weighed = room + 2 * kPacketSize * size;
  for (std::int64_t k = 0; k < 2 * kPacketSize * size; ++k) of_sums[k] = 0;
  for (std::int64_t k = 0; k < size * size; ++k) matrix[k] = 0;
  GroupSums sums;
  for (int i = 0; i < kPacketSize; ++i) {
    for (int c = 0; c < 6; ++c) sums.p[i][c] = sums.s[i][c] = 0.0;
    for (Packet& value : sums.curvature[i]) value = 0.0;
  }
  const auto spread = [&](int column, const Packet(&values)[3], const std::uint16_t* places) {
    for (int a = 0; a < per_face; ++a) {
      for (int c = 0; c < 3; ++c) {
        of_sums[column * size + 3 * std::int64_t{places[a]} + c] += values[c][a];
      }
    }
  };

  for (std::int32_t k = 0; k < group.num_seen;) {
    const std::int32_t face = group.face_seen[k];
    const std::uint16_t* places = group.places + std::int64_t{face} * per_face;
    std::int32_t end = k;
    while (end < group.num_seen && group.face_seen[end] == face) ++end;
    double block[kMostFaceNodes][kBlock][kPacketSize] = {};
    for (int i = 0; i < kPacketSize; ++i) {
      if (jet.by_p[first + i] == 0) continue;
      Crossed crossed;
      OfSums seen;
      for (int c = 0; c < 3; ++c) {
        seen.p[c] = seen.s[c] = 0.0;
        for (int d = 0; d < 3; ++d) crossed.values[c][d] = crossed.values[3 + c][d] = 0.0;
      }
      bool normal_too = false;
      bool any = false;
      for (std::int32_t e = k; e < end; ++e) {
        const PointPacket& there = points[group.seen[e]];
        const double inverse = inverse_squared(here, there, 1);
        Row row;
        if (!look(here, i, there, inverse, row)) continue;
        any = true;
        add_seen(here, i, jet, first + i, there, normal_slopes(there), *group.shapes_seen[e],
                 inverse, allowed_row(group.allowed[e], i), row, sums, curvature[group.seen[e]],
                 crossed, seen, normal_too);
      }
      if (!any) continue;
      spread(2 * i, seen.p, places);
      spread(2 * i + 1, seen.s, places);
      Packet by_1[kBlock];
      Packet by_2[kBlock];
      for (int c = 0; c < 3 && normal_too; ++c) {
        for (int d = 0; d < 3; ++d) {
          by_1[3 * c + d] = by_2[3 * c + d] = 0.0;
          for (int e = 0; e < 3; ++e) {
            by_1[3 * c + d] += slopes_here.by_1[e][c][i] * crossed.values[3 + e][d];
            by_2[3 * c + d] += slopes_here.by_2[e][c][i] * crossed.values[3 + e][d];
          }
        }
      }
      for (int a = 0; a < per_face; ++a) {
        const auto& of_node = group.shapes->of_nodes[a];
        for (int c = 0; c < 3; ++c) {
          for (int d = 0; d < 3; ++d) {
            Packet value = of_node[0][i] * crossed.values[c][d];
            if (normal_too) {
              value += of_node[1][i] * by_1[3 * c + d] + of_node[2][i] * by_2[3 * c + d];
            }
            add_to(block[a][3 * c + d], value);
          }
        }
      }
    }
    add_block(block, per_face, group.places, places, size, matrix);
    k = end;
  }

  for (int i = 0; i < kPacketSize; ++i) {
    if (jet.by_p[first + i] == 0) continue;
    for (int c = 0; c < 21; ++c) {
      curvature[group.packet].values[c][i] += sum(sums.curvature[i][c]);
    }
    Packet p[3];
    Packet s[3];
    for (int c = 0; c < 3; ++c) {
      p[c] = sum(sums.p[i][c]) * at(group.shapes->at_points[i][0]);
      s[c] = sum(sums.s[i][c]) * at(group.shapes->at_points[i][0]);
    }
    for (int e = 0; e < 3; ++e) {
      const double p_normal = sum(sums.p[i][3 + e]);
      const double s_normal = sum(sums.s[i][3 + e]);
      for (int c = 0; c < 3; ++c) {
        const Packet slope = slopes_here.by_1[e][c][i] * at(group.shapes->at_points[i][1]) +
                             slopes_here.by_2[e][c][i] * at(group.shapes->at_points[i][2]);
        p[c] += p_normal * slope;
        s[c] += s_normal * slope;
      }
    }
    spread(2 * i, p, group.places);
    spread(2 * i + 1, s, group.places);
  }

  // The points that act, one after the other.
  std::int64_t num_columns = 0;
  for (int i = 0; i < kPacketSize; ++i) {
    if (jet.by_p[first + i] == 0) continue;
    const double pp = jet.by_pp[first + i];
    const double ps = jet.by_ps[first + i];
    const double ss = jet.by_ss[first + i];
    for (std::int64_t row = 0; row < size; row += kPacketSize) {
      const Packet p = Packet::load(of_sums + 2 * i * size + row);
      const Packet s = Packet::load(of_sums + (2 * i + 1) * size + row);
      p.store(of_sums + num_columns * size + row);
      s.store(of_sums + (num_columns + 1) * size + row);
      (pp * p + ps * s).store(weighed + num_columns * size + row);
      (ps * p + ss * s).store(weighed + (num_columns + 1) * size + row);
    }
    num_columns += 2;
  }
  // The lower part, with the whole of the 3 × 3 blocks on the diagonal.
  constexpr int kTile = 4;
  for (std::int64_t column = 0; column < size; column += kTile) {
    const std::int64_t first_row = column / 3 * 3 / kPacketSize * kPacketSize;
    for (std::int64_t row = first_row; row < size; row += kPacketSize) {
      Packet tile[kTile] = {0.0, 0.0, 0.0, 0.0};
      for (std::int64_t k = 0; k < num_columns; ++k) {
        const Packet of_rows = Packet::load(weighed + k * size + row);
        for (int t = 0; t < kTile; ++t) tile[t] += of_sums[k * size + column + t] * of_rows;
      }
      for (int t = 0; t < kTile; ++t) add_to(matrix + (column + t) * size + row, tile[t]);
    }
  }
}

void of_face(std::int32_t num_packets, const ShapePacket* shapes, const PointPacket* points,
             const CurvaturePacket* curvature, const double* gradient, double* matrix) {
  Packet block[kMostFaceNodes][kBlock];
  for (auto& of_node : block) {
    for (Packet& value : of_node) value = 0.0;
  }
  for (std::int32_t p = 0; p < num_packets; ++p) {
    const PointPacket& point = points[p];
    const auto& of_point = curvature[p].values;
    Packet normal[3];
    Packet by_normal[3];
    Packet along = 0.0;
    for (int c = 0; c < 3; ++c) {
      normal[c] = at(point.normal[c]);
      by_normal[c] = Packet::load(gradient + (std::int64_t{p} * 6 + 3 + c) * kPacketSize);
      along += normal[c] * by_normal[c];
    }
    const Packet inverse = at(point.inverse_norm);
    Packet across[3][3];
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) {
        across[c][d] = inverse * ((c == d ? 1.0 : 0.0) - normal[c] * normal[d]);
      }
    }
    // By a = t₁ × t₂: what follows from the normal's first derivative, and γ D²(a/|a|).
    Packet by_a[3][3];
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) {
        Packet value = inverse * inverse *
                       (3.0 * along * normal[c] * normal[d] - (c == d ? along : Packet(0.0)) -
                        by_normal[c] * normal[d] - normal[c] * by_normal[d]);
        for (int e = 0; e < 3; ++e) {
          for (int f = 0; f < 3; ++f) {
            value +=
                across[c][e] * at(of_point[CurvaturePacket::kNormal + kPlace[e][f]]) * across[f][d];
          }
        }
        by_a[c][d] = value;
      }
    }
    Packet mixed[3][3];
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) {
        mixed[c][d] = 0.0;
        for (int e = 0; e < 3; ++e) {
          mixed[c][d] += at(of_point[CurvaturePacket::kMixed + 3 * c + e]) * across[e][d];
        }
      }
    }
    // Columns of a by t₁ and t₂: −[t₂]× and [t₁]×.
    const auto times_tangents = [&point](const Packet(&m)[3][3], Packet(&by_1)[3][3],
                                         Packet(&by_2)[3][3]) {
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) {
          const int k = (d + 2) % 3;
          const int l = (d + 1) % 3;
          by_1[c][d] = m[c][k] * at(point.tangent_2[l]) - m[c][l] * at(point.tangent_2[k]);
          by_2[c][d] = m[c][l] * at(point.tangent_1[k]) - m[c][k] * at(point.tangent_1[l]);
        }
      }
    };
    Packet x1[3][3];
    Packet x2[3][3];
    times_tangents(mixed, x1, x2);
    Packet a1[3][3];
    Packet a2[3][3];
    times_tangents(by_a, a1, a2);
    Packet t1a[3][3];
    Packet t2a[3][3];
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) {
        t1a[d][c] = a1[c][d];
        t2a[d][c] = a2[c][d];
      }
    }
    Packet m11[3][3];
    Packet m12[3][3];
    Packet m21[3][3];
    Packet m22[3][3];
    times_tangents(t1a, m11, m12);
    times_tangents(t2a, m21, m22);
    // −[γ Dn]×, of t₁ with t₂.
    Packet turn[3];
    for (int c = 0; c < 3; ++c) turn[c] = inverse * (by_normal[c] - along * normal[c]);
    for (int c = 0; c < 3; ++c) {
      const int d = (c + 1) % 3;
      const int e = (c + 2) % 3;
      m12[d][e] += turn[c];
      m12[e][d] -= turn[c];
    }
    double blocks[3][3][kBlock][kPacketSize];
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) {
        at(of_point[kPlace[c][d]]).store(blocks[0][0][3 * c + d]);
        x1[c][d].store(blocks[0][1][3 * c + d]);
        x2[c][d].store(blocks[0][2][3 * c + d]);
        x1[d][c].store(blocks[1][0][3 * c + d]);
        x2[d][c].store(blocks[2][0][3 * c + d]);
        m11[c][d].store(blocks[1][1][3 * c + d]);
        m12[c][d].store(blocks[1][2][3 * c + d]);
        m12[d][c].store(blocks[2][1][3 * c + d]);
        m22[c][d].store(blocks[2][2][3 * c + d]);
      }
    }
    for (int i = 0; i < kPacketSize; ++i) {
      if (point.area[i] == 0) continue;
      const auto& shape = shapes[p].at_points[i];
      Packet half[3][kBlock];
      for (int v = 0; v < 3; ++v) {
        for (int m = 0; m < kBlock; ++m) {
          half[v][m] = at(shape[0]) * blocks[0][v][m][i] + at(shape[1]) * blocks[1][v][m][i] +
                       at(shape[2]) * blocks[2][v][m][i];
        }
      }
      for (int b = 0; b < kMostFaceNodes; ++b) {
        const auto& of_node = shapes[p].of_nodes[b];
        for (int m = 0; m < kBlock; ++m) {
          block[b][m] +=
              of_node[0][i] * half[0][m] + of_node[1][i] * half[1][m] + of_node[2][i] * half[2][m];
        }
      }
    }
  }
  constexpr int kSize = 3 * kMostFaceNodes;
  for (int a = 0; a < kMostFaceNodes; ++a) {
    for (int b = 0; b < kMostFaceNodes; ++b) {
      for (int m = 0; m < kBlock; ++m) {
        matrix[3 * a + m / 3 + (3 * b + m % 3) * kSize] = block[b][m][a];
      }
    }
  }
}

constexpr ContactKernels kKernels{features, sums, gradient, to_nodes, find_seen, couple, of_face};

}  // namespace

const ContactKernels& contact_kernels();
const ContactKernels& contact_kernels() { return kKernels; }

}  // namespace palpate::PALPATE_INSTRUCTION_SET
