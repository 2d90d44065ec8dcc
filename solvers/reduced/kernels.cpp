// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set, see PALPATE_INSTRUCTION_SET in base/simd.h.
#include "reduced/kernels.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "base/simd.h"
#include "materials/laws.h"

namespace palpate::PALPATE_INSTRUCTION_SET {
namespace {

constexpr std::int64_t kRows = 9 * kPacketSize;
constexpr int kTangentSize = 45;

/// The type for the tangent, which only leads the iteration and so is in single precision.
using SixteenFloats = float __attribute__((vector_size(64)));
/// The number of columns that are processed at a time: as many products as fit the registers.
#ifdef __AVX512F__
constexpr int kTile = 4;
#else
constexpr int kTile = 2;
#endif

template <Law L, bool WithTangent>
void add_memory(const Kinematics<Packet>& k, const Packet (&strain)[6],
                const ReducedPointsView& points, std::int64_t packet, Response<Packet>& r) {
  // The memory is evaluated as a law with a quadratic energy, and H is added.
  constexpr Law quadratic = L == Law::linear ? Law::linear : Law::st_venant_kirchhoff;
  Packet moduli[2];
  for (int i = 0; i < 2; ++i) {
    moduli[i] = Packet::load(points.moduli + (2 * packet + i) * kPacketSize);
  }
  Response<Packet> of_memory;
  LawOf<quadratic>::template evaluate<WithTangent>(k, moduli, of_memory);
  r.energy += of_memory.energy;
  for (int m = 0; m < 6; ++m) {
    const Packet h = Packet::load(points.memory + (6 * packet + m) * kPacketSize);
    r.s[m] += of_memory.s[m] + h;
    r.energy += (m < 3 ? 1.0 : 2.0) * h * strain[m];
  }
  if constexpr (WithTangent) {
    for (int m = 0; m < 21; ++m) r.d[m] += of_memory.d[m];
  }
}

template <Law L>
Packet deformation_gradient(const Kinematics<Packet>& k, int i, int j) {
  if constexpr (L == Law::linear) return i == j ? 1.0 : 0.0;
  return i == j ? 1.0 + k.h[i][j] : k.h[i][j];
}

/// w P.
template <Law L>
void store_stress(const Kinematics<Packet>& k, const Response<Packet>& r, Packet weight,
                  double* out) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      Packet p = r.s[kSymmetric[i][j]];
      if constexpr (L != Law::linear) {
        p = 0.0;
        for (int m = 0; m < 3; ++m) p += deformation_gradient<L>(k, i, m) * r.s[kSymmetric[m][j]];
      }
      (weight * p).store(out + (3 * i + j) * kPacketSize);
    }
  }
}

/// w A_iJkL = w (δ_ik S_JL + F_iM D_MJNL F_kN), the lower triangle in 3 i + J and 3 k + L.
template <Law L>
void store_tangent(const Kinematics<Packet>& k, const Response<Packet>& r, Packet weight,
                   float* out) {
  for (int jj = 0; jj < 3; ++jj) {
    for (int ll = 0; ll < 3; ++ll) {
      Packet fd[3][3];  // F_iM D_MJNL
      for (int i = 0; i < 3; ++i) {
        for (int n = 0; n < 3; ++n) {
          fd[i][n] = 0.0;
          for (int m = 0; m < 3; ++m) {
            fd[i][n] +=
                deformation_gradient<L>(k, i, m) * r.d[lower(kSymmetric[m][jj], kSymmetric[n][ll])];
          }
        }
      }
      for (int i = 0; i < 3; ++i) {
        for (int kk = 0; kk <= i; ++kk) {
          if (3 * i + jj < 3 * kk + ll) continue;
          Packet value = 0.0;
          for (int n = 0; n < 3; ++n) value += fd[i][n] * deformation_gradient<L>(k, kk, n);
          if (L != Law::linear && i == kk) value += r.s[kSymmetric[jj][ll]];
          const Packet weighted = weight * value;
          store(__builtin_convertvector(weighted.values, EightFloats),
                out + lower(3 * i + jj, 3 * kk + ll) * kPacketSize);
        }
      }
    }
  }
}

template <Law L, bool WithTangent>
ReducedSums evaluate(const ReducedPointsView& points, const ReducedPointFields& fields) {
  constexpr int num_constants = kNumConstants<L>;
  Packet potential = 0.0;
  Packet elastic = 0.0;
  Packet least = L == Law::linear ? 1.0 : std::numeric_limits<double>::max();
  for (std::int64_t packet = points.first_packet; packet < points.last_packet; ++packet) {
    Packet constants[num_constants];
    for (int i = 0; i < num_constants; ++i) {
      const std::int64_t at = (packet - points.first_packet) * num_constants + i;
      constants[i] = Packet::load(points.constants + at * kPacketSize);
    }
    Kinematics<Packet> k;
    for (int i = 0; i < 9; ++i) {
      k.h[i / 3][i % 3] = Packet::load(points.gradients + packet * kRows + i * kPacketSize);
    }
    k.update();
    if constexpr (L != Law::linear) least = min(least, 1.0 + k.j);
    if constexpr (has_inversion_barrier(L)) {
      // If the law is not defined, the energy is infinite (below); no point may produce a NaN.
      k.j = max(k.j, Packet(std::numeric_limits<double>::epsilon() - 1.0));
    }
    Response<Packet> r;
    LawOf<L>::template evaluate<WithTangent>(k, constants, r);
    const Packet weight = Packet::load(points.weights + packet * kPacketSize);
    elastic += weight * r.energy;
    Packet strain[6];
    for (int m = 0; m < 6; ++m) {
      strain[m] =
          L == Law::linear ? 0.5 * (k.h[kRow[m]][kColumn[m]] + k.h[kColumn[m]][kRow[m]]) : k.e[m];
      strain[m].store(fields.strain + (6 * packet + m) * kPacketSize);
      r.s[m].store(fields.law_stress + (6 * packet + m) * kPacketSize);
    }
    if (points.factors != nullptr) {
      const Packet factor = Packet::load(points.factors + packet * kPacketSize);
      r.energy *= factor;
      for (Packet& s : r.s) s *= factor;
      if constexpr (WithTangent) {
        for (Packet& d : r.d) d *= factor;
      }
    }
    if (points.memory != nullptr) add_memory<L, WithTangent>(k, strain, points, packet, r);
    potential += weight * r.energy;
    store_stress<L>(k, r, weight, fields.stress + packet * kRows);
    if constexpr (WithTangent) {
      store_tangent<L>(k, r, weight, fields.tangent + packet * kTangentSize * kPacketSize);
    }
  }
  ReducedSums sums{0, 0, std::numeric_limits<double>::max()};
  for (int lane = 0; lane < kPacketSize; ++lane) {
    sums.potential += potential[lane];
    sums.elastic += elastic[lane];
    sums.minimum_det_f = min(sums.minimum_det_f, least[lane]);
  }
  if (has_inversion_barrier(L) && !(sums.minimum_det_f > 0)) {
    sums.potential = sums.elastic = std::numeric_limits<double>::infinity();
  }
  return sums;
}

/// Calls the instance of the template for the law with this number.
template <int... Laws>
ReducedSums evaluate_law(int law, const ReducedPointsView& points, const ReducedPointFields& fields,
                         std::integer_sequence<int, Laws...> /*laws*/) {
  ReducedSums sums{};
  const auto try_law = [&](auto number) {
    constexpr auto tried = static_cast<Law>(decltype(number)::value);
    if constexpr (law_of_energy(tried) == tried) {
      if (law != static_cast<int>(tried)) return;
      sums = fields.tangent != nullptr ? evaluate<tried, true>(points, fields)
                                       : evaluate<tried, false>(points, fields);
    }
  };
  (try_law(std::integral_constant<int, Laws>()), ...);
  return sums;
}

ReducedSums evaluate_any(int law, const ReducedPointsView& points,
                         const ReducedPointFields& fields) {
  return evaluate_law(law, points, fields, std::make_integer_sequence<int, num_laws>());
}

void gradients(const double* g, std::int64_t num_packets, std::int64_t num_coordinates,
               const double* y, double* h) {
  const std::int64_t num_rows = num_packets * kRows;
  for (std::int64_t row = 0; row < num_rows; row += kRows) {
    Packet sum[9];
    for (Packet& s : sum) s = 0.0;
    for (std::int64_t c = 0; c < num_coordinates; ++c) {
      const double* column = g + c * num_rows + row;
      const Packet factor = y[c];
      for (int i = 0; i < 9; ++i) sum[i] += factor * Packet::load(column + i * kPacketSize);
    }
    for (int i = 0; i < 9; ++i) sum[i].store(h + row + i * kPacketSize);
  }
}

double sum_of(const Packet& packet) {
  double sum = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) sum += packet[lane];
  return sum;
}

void force(const double* g, std::int64_t num_packets, std::int64_t num_coordinates,
           const double* stress, double* f) {
  const std::int64_t num_rows = num_packets * kRows;
  for (std::int64_t c = 0; c < num_coordinates; ++c) {
    const double* column = g + c * num_rows;
    Packet sum[3] = {0.0, 0.0, 0.0};
    for (std::int64_t row = 0; row < num_rows; row += 3 * kPacketSize) {
      for (int i = 0; i < 3; ++i) {
        const std::int64_t at = row + i * kPacketSize;
        sum[i] += Packet::load(stress + at) * Packet::load(column + at);
      }
    }
    f[c] = sum_of(sum[0] + sum[1] + sum[2]);
  }
}

/// b = A g for one packet and one coordinate.
void times_tangent(const float* tangent, const float* g, float* b) {
  EightFloats of_g[9];
  for (int i = 0; i < 9; ++i) load(g + i * kPacketSize, of_g[i]);
  for (int i = 0; i < 9; ++i) {
    EightFloats sum{};
    for (int j = 0; j < 9; ++j) {
      EightFloats a;
      load(tangent + lower(i, j) * kPacketSize, a);
      sum += a * of_g[j];
    }
    store(sum, b + i * kPacketSize);
  }
}

template <class V>
[[gnu::always_inline]] inline double sum_of_floats(const V& v) {
  float sum = 0;
  for (std::size_t lane = 0; lane < sizeof(V) / sizeof(float); ++lane) sum += v[lane];
  return sum;
}

/// Adds the scalar products of Rows columns of a with Columns columns of b to a block of k. The
/// loops over the columns are unrolled, so that the sums stay in registers.
/// @param length A multiple of the number of values in a V.
template <class V, int Rows, int Columns>
void add_products(const float* a, std::int64_t a_rows, const float* b, std::int64_t b_rows,
                  std::int64_t length, double* k, std::int64_t leading) {
  constexpr auto step = static_cast<std::int64_t>(sizeof(V) / sizeof(float));
  V sum[Rows][Columns]{};
  for (std::int64_t at = 0; at < length; at += step) {
    V of_b[Columns];
#pragma GCC unroll 4
    for (int c = 0; c < Columns; ++c) load(b + c * b_rows + at, of_b[c]);
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      V of_a;
      load(a + r * a_rows + at, of_a);
#pragma GCC unroll 4
      for (int c = 0; c < Columns; ++c) sum[r][c] += of_a * of_b[c];
    }
  }
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 4
    for (int c = 0; c < Columns; ++c) k[c * leading + r] += sum_of_floats(sum[r][c]);
  }
}

/// Adds these products for each column of b with the columns from it on: the lower triangle.
template <class V>
void add_lower_triangle(const float* g, std::int64_t num_rows, const float* b, std::int64_t b_rows,
                        std::int64_t length, std::int64_t n, double* k) {
  std::int64_t c = 0;
  for (; c + kTile <= n; c += kTile) {
    std::int64_t r = c;
    for (; r + kTile <= n; r += kTile) {
      add_products<V, kTile, kTile>(g + r * num_rows, num_rows, b + c * b_rows, b_rows, length,
                                    k + c * n + r, n);
    }
    for (; r < n; ++r) {
      add_products<V, 1, kTile>(g + r * num_rows, num_rows, b + c * b_rows, b_rows, length,
                                k + c * n + r, n);
    }
  }
  for (; c < n; ++c) {
    for (std::int64_t r = c; r < n; ++r) {
      add_products<V, 1, 1>(g + r * num_rows, num_rows, b + c * b_rows, b_rows, length,
                            k + c * n + r, n);
    }
  }
}

void tangent(const float* g, std::int64_t num_packets, std::int64_t num_coordinates,
             const float* of_points, float* room, double* k) {
  const std::int64_t n = num_coordinates;
  const std::int64_t num_rows = num_packets * kRows;
  std::memset(k, 0, static_cast<std::size_t>(n * n) * sizeof(double));
  for (std::int64_t first = 0; first < num_packets; first += kTangentPackets) {
    const std::int64_t left = num_packets - first;
    const std::int64_t count = left < kTangentPackets ? left : kTangentPackets;
    const std::int64_t length = count * kRows;
    for (std::int64_t c = 0; c < n; ++c) {
      for (std::int64_t p = 0; p < count; ++p) {
        times_tangent(of_points + (first + p) * kTangentSize * kPacketSize,
                      g + c * num_rows + (first + p) * kRows, room + c * length + p * kRows);
      }
    }
    // The rows of an even number of packets fill whole vectors.
    const std::int64_t even = count / 2 * 2 * kRows;
    const float* of_g = g + first * kRows;
    add_lower_triangle<SixteenFloats>(of_g, num_rows, room, length, even, n, k);
    if (even < length) {
      add_lower_triangle<EightFloats>(of_g + even, num_rows, room + even, length, length - even, n,
                                      k);
    }
  }
}

bool factorise(std::int64_t size, std::int64_t leading, double* matrix) {
  for (std::int64_t j = 0; j < size; ++j) {
    double* column = matrix + j * leading;
    if (!(column[j] > 0)) return false;
    const double root = std::sqrt(column[j]);
    column[j] = root;
    for (std::int64_t i = j + 1; i < size; ++i) column[i] /= root;
    for (std::int64_t k = j + 1; k < size; ++k) {
      double* other = matrix + k * leading;
      const double factor = column[k];
      for (std::int64_t i = k; i < size; ++i) other[i] -= factor * column[i];
    }
  }
  return std::isfinite(size == 0 ? 1.0 : matrix[(size - 1) * leading + size - 1]);
}

}  // namespace

const ReducedKernels& reduced_kernels() {
  static constexpr ReducedKernels table = {&gradients, &evaluate_any, &force, &tangent, &factorise};
  return table;
}

}  // namespace palpate::PALPATE_INSTRUCTION_SET
