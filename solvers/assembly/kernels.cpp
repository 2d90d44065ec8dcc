// SPDX-License-Identifier: BSD-3-Clause
// This file is compiled once for each instruction set, see PALPATE_INSTRUCTION_SET in base/simd.h.
#include "assembly/kernels.h"

#include <limits>
#include <utility>

#include "base/simd.h"
#include "materials/laws.h"

namespace palpate::PALPATE_INSTRUCTION_SET {
namespace {

template <int Order>
struct Element;

template <>
struct Element<1> {
  static constexpr int nodes = 4;
  static constexpr int points = 1;
};

template <>
struct Element<2> {
  static constexpr int nodes = 10;
  /// The number of points of the usual rule.
  static constexpr int points = 4;
};

/// Whether elements may have a rule with another number of points than the usual one.
enum class Rule { usual, any };

constexpr Rule rule_of(int order, Formulation form) {
  return order == 2 && is_mixed(form) ? Rule::any : Rule::usual;
}

/// Mixed elements have a continuous, linear pressure. For Tet10 this is stable (Taylor & Hood
/// 1973). For Tet4 it is not by itself: the difference of p from its mean over the element gets an
/// additional compliance 1/(2μ) (Dohrmann & Bochev 2004), which keeps the energy a function with a
/// stationary point and the tangent symmetric:
///
///   Π = ∫ W_rest + p g − p²/(2κ̂) dV − ∫ (p − p̄)²/(4μ) dV  (the last one for Tet4 alone)
template <int Order, Law L, Formulation Form, Rule R = rule_of(Order, Form)>
class Group {
  static constexpr bool kMixed = is_mixed(Form);
  static constexpr int kConstants = kNumConstants<L>;
  static constexpr int kParameters = kConstants + (kMixed ? 3 : 0);
  static constexpr int kCornerPairs = 10;

 protected:
  static constexpr int kNodes = Element<Order>::nodes;
  static std::int32_t num_points(const ElementGroupView& group) {
    return R == Rule::any ? group.points : Element<Order>::points;
  }
  static constexpr int kPairs = kNodes * (kNodes + 1) / 2;

 public:
  static GroupResult residual(const ElementGroupView& group, const double* state, double* force) {
    return run<false>(group, state, force, nullptr);
  }

  static GroupResult tangent(const ElementGroupView& group, const double* state, double* force,
                             double* values) {
    return run<true>(group, state, force, values);
  }

  static void determinants(const ElementGroupView& group, const double* state,
                           double* minimum_det_f) {
    const std::int32_t points = num_points(group);
    for (std::int32_t p = group.first_packet; p < group.last_packet; ++p) {
      Packet ue[kNodes][3];
      gather(group, p, state, ue);
      Packet least = std::numeric_limits<double>::max();
      for (int q = 0; q < points; ++q) {
        Kinematics<Packet> k;
        displacement_gradient(group, p, q, ue, k);
        k.update();
        least = min(least, 1.0 + k.j);
      }
      least.store(minimum_det_f + p * kPacketSize);
    }
  }

  static void stress(const ElementGroupView& group, const double* state, double* sums) {
    const std::int32_t points = num_points(group);
    for (std::int32_t p = group.first_packet; p < group.last_packet; ++p) {
      Packet parameters[kParameters];
      Packet constants[kConstants];
      load_parameters(group, p, parameters, constants);
      Packet ue[kNodes][3];
      gather(group, p, state, ue);
      [[maybe_unused]] Pressures<kMixed, false> pressures;
      if constexpr (kMixed) gather_pressures(group, p, state, pressures);
      Packet sum[StressSum::count];
      for (Packet& value : sum) value = 0.0;
      Packet least = L == Law::linear ? 1.0 : std::numeric_limits<double>::max();
      for (int q = 0; q < points; ++q) {
        const Packet weight = Packet::load(group.weights + (p * points + q) * kPacketSize);
        Kinematics<Packet> k;
        displacement_gradient(group, p, q, ue, k);
        k.update();
        Response<Packet> r;
        LawOf<L>::template evaluate<false>(k, constants, r);
        if constexpr (kMixed) {
          Response<Packet> volume;
          VolumeOf<L>::template evaluate<false>(k, volume);
          add_volume(parameters[kConstants + 2], group.corner_shares + 4 * q, k, volume, weight,
                     gradients_at(group, p, q), pressures, r);
        }
        Packet fs[3][3];
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            fs[i][j] = f(k, i, 0) * r.s[kSymmetric[0][j]] + f(k, i, 1) * r.s[kSymmetric[1][j]] +
                       f(k, i, 2) * r.s[kSymmetric[2][j]];
            sum[StressSum::displacement_gradient + 3 * i + j] += weight * k.h[i][j];
          }
        }
        for (int m = 0; m < 6; ++m) {
          const int i = kRow[m];
          const int j = kColumn[m];
          sum[StressSum::cauchy + m] +=
              weight * (fs[i][0] * f(k, j, 0) + fs[i][1] * f(k, j, 1) + fs[i][2] * f(k, j, 2));
        }
        sum[StressSum::volume] += weight;
        if constexpr (L == Law::linear) {
          sum[StressSum::deformed_volume] += weight;
        } else {
          sum[StressSum::deformed_volume] += weight * (1.0 + k.j);
          least = min(least, 1.0 + k.j);
        }
      }
      sum[StressSum::minimum_det_f] = least;
      for (int i = 0; i < StressSum::count; ++i) {
        sum[i].store(sums + (static_cast<std::int64_t>(p) * StressSum::count + i) * kPacketSize);
      }
    }
  }

  static void point_stress(const ElementGroupView& group, const double* state, double* stress) {
    const std::int32_t points = num_points(group);
    for (std::int32_t p = group.first_packet; p < group.last_packet; ++p) {
      Packet parameters[kParameters];
      Packet constants[kConstants];
      load_parameters(group, p, parameters, constants);
      Packet ue[kNodes][3];
      gather(group, p, state, ue);
      for (int q = 0; q < points; ++q) {
        Kinematics<Packet> k;
        displacement_gradient(group, p, q, ue, k);
        k.update();
        Response<Packet> r;
        LawOf<L>::template evaluate<false>(k, constants, r);
        store_symmetric(group, p, q, r.s, stress);
      }
    }
  }

 private:
  template <bool WithTangent>
  static GroupResult run(const ElementGroupView& group, const double* state, double* force,
                         double* values) {
    const std::int32_t points = num_points(group);
    Packet energy = 0.0;
    Packet least = std::numeric_limits<double>::max();
    for (std::int32_t p = group.first_packet; p < group.last_packet; ++p) {
      Packet parameters[kParameters];
      Packet constants[kConstants];
      load_parameters(group, p, parameters, constants);
      Packet ue[kNodes][3];
      gather(group, p, state, ue);
      Packet fe[kNodes][3];
      for (auto& row : fe) row[0] = row[1] = row[2] = 0.0;
      [[maybe_unused]] Packet ke[WithTangent ? kPairs : 1][9];
      if constexpr (WithTangent) {
        for (auto& block : ke) {
          for (Packet& value : block) value = 0.0;
        }
      }
      [[maybe_unused]] Pressures<kMixed, WithTangent> pressures;
      if constexpr (kMixed) gather_pressures(group, p, state, pressures);
      for (int q = 0; q < points; ++q) {
        const double* gradients = gradients_at(group, p, q);
        const Packet weight = Packet::load(group.weights + (p * points + q) * kPacketSize);
        Kinematics<Packet> k;
        displacement_gradient(group, p, q, ue, k);
        k.update();
        if constexpr (L != Law::linear) least = min(least, 1.0 + k.j);
        if constexpr (has_inversion_barrier(L)) {
          // If the law is not defined, the energy is infinite (below); no lane may produce a NaN.
          k.j = max(k.j, Packet(std::numeric_limits<double>::epsilon() - 1.0));
        }
        Response<Packet> r;
        LawOf<L>::template evaluate<WithTangent>(k, constants, r);
        if constexpr (kMixed) {
          Response<Packet> volume;
          VolumeOf<L>::template evaluate<WithTangent>(k, volume);
          add_volume(parameters[kConstants + 2], group.corner_shares + 4 * q, k, volume, weight,
                     gradients, pressures, r);
        }
        energy += weight * r.energy;
        add_force(k, r, weight, gradients, fe);
        if constexpr (WithTangent) add_tangent(k, r, weight, gradients, ke);
      }
      scatter_force(group, p, fe, force);
      if constexpr (WithTangent) scatter_tangent(group, p, ke, values);
      if constexpr (kMixed) {
        energy += add_compliance(group, p, parameters, pressures);
        scatter_pressures(group, p, pressures, force, values);
      }
    }
    GroupResult result{0, 1};
    for (int lane = 0; lane < kPacketSize; ++lane) {
      result.energy += energy[lane];
      if (L != Law::linear) {
        result.minimum_det_f = lane == 0 ? least[0] : min(result.minimum_det_f, least[lane]);
      }
    }
    if (has_inversion_barrier(L) && result.minimum_det_f <= 0) {
      result.energy = std::numeric_limits<double>::infinity();
    }
    return result;
  }

  static void load_parameters(const ElementGroupView& group, std::int32_t p,
                              Packet (&parameters)[kParameters], Packet (&constants)[kConstants]) {
    for (int i = 0; i < kParameters; ++i) {
      parameters[i] = group.homogeneous
                          ? Packet(group.parameters[i])
                          : Packet::load(group.parameters + (p * kParameters + i) * kPacketSize);
    }
    for (int i = 0; i < kConstants; ++i) constants[i] = parameters[i];
  }

 protected:
  /// Stores a symmetric tensor of a quadrature point in `out` [packets × points × 6 × 8].
  static void store_symmetric(const ElementGroupView& group, std::int32_t p, int q,
                              const Packet (&tensor)[6], double* out) {
    double* at = out + (static_cast<std::int64_t>(p) * num_points(group) + q) * 6 * kPacketSize;
    for (int m = 0; m < 6; ++m) tensor[m].store(at + m * kPacketSize);
  }

  static const double* gradients_at(const ElementGroupView& group, std::int32_t p, int q) {
    const std::int64_t at = static_cast<std::int64_t>(p) * num_points(group) + q;
    return group.gradients + at * kNodes * 3 * kPacketSize;
  }

  static void gather(const ElementGroupView& group, std::int32_t p, const double* state,
                     Packet (&ue)[kNodes][3]) {
    const std::int32_t* nodes = group.nodes + p * kNodes * kPacketSize;
    for (int a = 0; a < kNodes; ++a) {
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const double* at = state + 3 * static_cast<std::int64_t>(nodes[a * kPacketSize + lane]);
        for (int i = 0; i < 3; ++i) ue[a][i].values[lane] = at[i];
      }
    }
  }

  /// H = Σ u_a ⊗ ∇N_a.
  static void displacement_gradient(const ElementGroupView& group, std::int32_t p, int q,
                                    const Packet (&ue)[kNodes][3], Kinematics<Packet>& k) {
    const double* gradients = gradients_at(group, p, q);
    for (auto& row : k.h) row[0] = row[1] = row[2] = 0.0;
    for (int a = 0; a < kNodes; ++a) {
      for (int j = 0; j < 3; ++j) {
        const Packet g = Packet::load(gradients + (a * 3 + j) * kPacketSize);
        for (int i = 0; i < 3; ++i) k.h[i][j] += ue[a][i] * g;
      }
    }
  }

  static Packet f(const Kinematics<Packet>& k, int i, int j) {
    if constexpr (L == Law::linear) return i == j ? 1.0 : 0.0;
    return i == j ? 1.0 + k.h[i][j] : k.h[i][j];
  }

  /// The pressures p̂ at the corners of the elements of a packet, with the derivatives of Π.
  template <bool Mixed, bool WithTangent>
  struct Pressures {};

  template <bool WithTangent>
  struct Pressures<true, WithTangent> {
    Packet p[4];
    /// ∂Π/∂p̂_b.
    Packet force[4];
    /// ∂²Π/∂u_a∂p̂_b.
    Packet coupling[WithTangent ? kNodes : 1][4][3];
    /// ∂²Π/∂p̂_a∂p̂_b.
    Packet block[WithTangent ? kCornerPairs : 1];
  };

  template <bool WithTangent>
  static void gather_pressures(const ElementGroupView& group, std::int32_t p, const double* state,
                               Pressures<true, WithTangent>& out) {
    const std::int32_t* at = group.pressures + static_cast<std::int64_t>(p) * 4 * kPacketSize;
    for (int b = 0; b < 4; ++b) {
      double of_packet[kPacketSize];
      for (int lane = 0; lane < kPacketSize; ++lane)
        of_packet[lane] = state[at[b * kPacketSize + lane]];
      out.p[b] = Packet::load(of_packet);
      out.force[b] = 0.0;
    }
    for (auto& row : out.coupling) {
      for (auto& vector : row) vector[0] = vector[1] = vector[2] = 0.0;
    }
  }

  /// The term p g at a quadrature point with these barycentric coordinates. It contributes to the
  /// response, to the force on the pressures and to the coupling.
  template <bool WithTangent>
  static void add_volume(Packet scale, const double* shares, const Kinematics<Packet>& k,
                         const Response<Packet>& volume, Packet weight, const double* gradients,
                         Pressures<true, WithTangent>& pressures, Response<Packet>& r) {
    Packet pressure = 0.0;
    for (int b = 0; b < 4; ++b) {
      pressure += shares[b] * pressures.p[b];
      pressures.force[b] += shares[b] * scale * weight * volume.energy;
    }
    pressure *= scale;
    r.energy += pressure * volume.energy;
    for (int m = 0; m < 6; ++m) r.s[m] += pressure * volume.s[m];
    if constexpr (WithTangent) {
      for (int m = 0; m < 21; ++m) r.d[m] += pressure * volume.d[m];
      Packet change[3][3];  // s w ∂g/∂F
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          change[i][j] =
              scale * weight *
              (f(k, i, 0) * volume.s[kSymmetric[0][j]] + f(k, i, 1) * volume.s[kSymmetric[1][j]] +
               f(k, i, 2) * volume.s[kSymmetric[2][j]]);
        }
      }
      for (int a = 0; a < kNodes; ++a) {
        Packet g[3];
        for (int j = 0; j < 3; ++j) g[j] = Packet::load(gradients + (a * 3 + j) * kPacketSize);
        for (int i = 0; i < 3; ++i) {
          const Packet at_node = change[i][0] * g[0] + change[i][1] * g[1] + change[i][2] * g[2];
          for (int b = 0; b < 4; ++b) {
            pressures.coupling[a][b][i] += shares[b] * at_node;
          }
        }
      }
    }
  }

  /// The terms of second order in p, which do not depend on u. The linear pressures of an element
  /// have the mass V (1 + δ_ab)/20, and their means V/16.
  template <bool WithTangent>
  static Packet add_compliance(const ElementGroupView& group, std::int32_t p,
                               const Packet (&parameters)[kParameters],
                               Pressures<true, WithTangent>& pressures) {
    const std::int32_t points = num_points(group);
    const Packet compliance = parameters[kConstants];
    const Packet stabilisation = parameters[kConstants + 1];
    const Packet scale = parameters[kConstants + 2];
    Packet volume = 0.0;
    for (int q = 0; q < points; ++q) {
      volume += Packet::load(group.weights + (p * points + q) * kPacketSize);
    }
    volume *= scale * scale;
    const Packet mass = Order == 1 ? compliance + stabilisation : compliance;
    const Packet mean = Order == 1 ? stabilisation : Packet(0.0);
    const Packet off_diagonal = volume * ((1.0 / 20) * mass - (1.0 / 16) * mean);
    const Packet diagonal = volume * ((2.0 / 20) * mass - (1.0 / 16) * mean);
    Packet energy = 0.0;
    for (int a = 0; a < 4; ++a) {
      Packet sum = 0.0;
      for (int b = 0; b < 4; ++b) {
        sum += (a == b ? diagonal : off_diagonal) * pressures.p[b];
        if constexpr (WithTangent) {
          if (a <= b) pressures.block[corner_pair(a, b)] = -(a == b ? diagonal : off_diagonal);
        }
      }
      pressures.force[a] -= sum;
      energy -= 0.5 * pressures.p[a] * sum;
    }
    return energy;
  }

  static constexpr int corner_pair(int a, int b) { return a * 4 - a * (a - 1) / 2 + b - a; }

  template <bool WithTangent>
  static void scatter_pressures(const ElementGroupView& group, std::int32_t p,
                                const Pressures<true, WithTangent>& pressures, double* force,
                                [[maybe_unused]] double* values) {
    const std::int64_t packet = p;
    const std::int32_t* at = group.pressures + packet * 4 * kPacketSize;
    for (int b = 0; b < 4; ++b) {
      for (int lane = 0; lane < kPacketSize; ++lane) {
        force[at[b * kPacketSize + lane]] += pressures.force[b][lane];
      }
    }
    if constexpr (WithTangent) {
      const BlockTarget* targets = group.coupling_targets + packet * kNodes * 4 * kPacketSize;
      for (int a = 0; a < kNodes; ++a) {
        for (int b = 0; b < 4; ++b) {
          for (int lane = 0; lane < kPacketSize; ++lane) {
            const BlockTarget target = targets[(a * 4 + b) * kPacketSize + lane];
            if (target.first < 0) continue;
            double* value = values + target.first;
            for (int c = 0; c < 3; ++c) {
              *value += pressures.coupling[a][b][c][lane];
              value += target.column_length - 1 - c;
            }
          }
        }
      }
      const std::int32_t* positions = group.pressure_targets + packet * kCornerPairs * kPacketSize;
      for (int pair_of = 0; pair_of < kCornerPairs; ++pair_of) {
        for (int lane = 0; lane < kPacketSize; ++lane) {
          const std::int32_t position = positions[pair_of * kPacketSize + lane];
          if (position >= 0) values[position] += pressures.block[pair_of][lane];
        }
      }
    }
  }

  /// f_a += w P ∇N_a.
  static void add_force(const Kinematics<Packet>& k, const Response<Packet>& r, Packet weight,
                        const double* gradients, Packet (&fe)[kNodes][3]) {
    Packet stress[3][3];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if constexpr (L == Law::linear) {
          stress[i][j] = weight * r.s[kSymmetric[i][j]];
        } else {
          stress[i][j] =
              weight * (f(k, i, 0) * r.s[kSymmetric[0][j]] + f(k, i, 1) * r.s[kSymmetric[1][j]] +
                        f(k, i, 2) * r.s[kSymmetric[2][j]]);
        }
      }
    }
    for (int a = 0; a < kNodes; ++a) {
      for (int j = 0; j < 3; ++j) {
        const Packet g = Packet::load(gradients + (a * 3 + j) * kPacketSize);
        for (int i = 0; i < 3; ++i) fe[a][i] += stress[i][j] * g;
      }
    }
  }

  /// K_ab += w ∇N_a · A · ∇N_b.
  static void add_tangent(const Kinematics<Packet>& k, const Response<Packet>& r, Packet weight,
                          const double* gradients, Packet (&ke)[kPairs][9]) {
    // a_tensor[J][L][i][k] = A_iJkL.
    Packet a_tensor[3][3][3][3];
    for (int jj = 0; jj < 3; ++jj) {
      for (int ll = 0; ll <= jj; ++ll) {
        Packet fd[3][3];  // F_iM D_MJNL
        for (int i = 0; i < 3; ++i) {
          for (int n = 0; n < 3; ++n) {
            fd[i][n] = 0.0;
            for (int m = 0; m < 3; ++m) {
              fd[i][n] += f(k, i, m) * r.d[lower(kSymmetric[m][jj], kSymmetric[n][ll])];
            }
          }
        }
        for (int i = 0; i < 3; ++i) {
          for (int kk = 0; kk < 3; ++kk) {
            Packet value = fd[i][0] * f(k, kk, 0) + fd[i][1] * f(k, kk, 1) + fd[i][2] * f(k, kk, 2);
            if (L != Law::linear && i == kk) value += r.s[kSymmetric[jj][ll]];
            value *= weight;
            a_tensor[jj][ll][i][kk] = value;
            if (ll != jj) a_tensor[ll][jj][kk][i] = value;
          }
        }
      }
    }
    for (int b = 0; b < kNodes; ++b) {
      Packet gb[3];
      for (int ll = 0; ll < 3; ++ll) gb[ll] = Packet::load(gradients + (b * 3 + ll) * kPacketSize);
      Packet ag[3][3][3];  // A_iJkL ∂N_b/∂X_L as [J][i][k]
      for (int jj = 0; jj < 3; ++jj) {
        for (int i = 0; i < 3; ++i) {
          for (int kk = 0; kk < 3; ++kk) {
            ag[jj][i][kk] = a_tensor[jj][0][i][kk] * gb[0] + a_tensor[jj][1][i][kk] * gb[1] +
                            a_tensor[jj][2][i][kk] * gb[2];
          }
        }
      }
      for (int a = 0; a <= b; ++a) {
        Packet* block = ke[pair(a, b)];
        for (int jj = 0; jj < 3; ++jj) {
          const Packet ga = Packet::load(gradients + (a * 3 + jj) * kPacketSize);
          for (int i = 0; i < 3; ++i) {
            for (int kk = 0; kk < 3; ++kk) block[3 * i + kk] += ga * ag[jj][i][kk];
          }
        }
      }
    }
  }

  /// Index of the pair a ≤ b in the order 00 01 … 0n 11 ….
  static constexpr int pair(int a, int b) { return a * kNodes - a * (a - 1) / 2 + b - a; }

  static void scatter_force(const ElementGroupView& group, std::int32_t p,
                            const Packet (&fe)[kNodes][3], double* force) {
    const std::int32_t* nodes = group.nodes + p * kNodes * kPacketSize;
    for (int a = 0; a < kNodes; ++a) {
      for (int lane = 0; lane < kPacketSize; ++lane) {
        double* at = force + 3 * static_cast<std::int64_t>(nodes[a * kPacketSize + lane]);
        for (int i = 0; i < 3; ++i) at[i] += fe[a][i][lane];
      }
    }
  }

  static void scatter_tangent(const ElementGroupView& group, std::int32_t p,
                              const Packet (&ke)[kPairs][9], double* values) {
    const BlockTarget* targets =
        group.targets + static_cast<std::int64_t>(p) * kPairs * kPacketSize;
    int index = 0;
    for (int a = 0; a < kNodes; ++a) {
      for (int b = a; b < kNodes; ++b, ++index) {
        double block[9][kPacketSize];
        for (int i = 0; i < 9; ++i) ke[index][i].store(block[i]);
        for (int lane = 0; lane < kPacketSize; ++lane) {
          const BlockTarget target = targets[index * kPacketSize + lane];
          if (target.first < 0) continue;
          double* column = values + target.first;
          const bool transposed = target.column_length < 0;
          const std::int32_t length = transposed ? -target.column_length : target.column_length;
          if (a == b) {
            column[0] += block[0][lane];
            column[1] += block[3][lane];
            column[2] += block[6][lane];
            column[length] += block[4][lane];
            column[length + 1] += block[7][lane];
            column[2 * length - 1] += block[8][lane];
            continue;
          }
          // Element (r, c) of the stored block. Its column c begins where the one before ends,
          // without the diagonal values above it.
          for (int c = 0; c < 3; ++c) {
            for (int row = 0; row < 3; ++row) {
              column[row] += block[transposed ? 3 * c + row : 3 * row + c][lane];
            }
            column += length - 1 - c;
          }
        }
      }
    }
  }
};

/// The potential of the memory, for elements of any formulation. It is evaluated as a law with a
/// quadratic energy, and H is added.
template <int Order, Law L>
using MemoryGroup = Group<Order, L, Formulation::displacement, rule_of(Order, Formulation::mixed)>;

template <int Order, Law L>
class Memory : MemoryGroup<Order, L> {
  using Base = MemoryGroup<Order, L>;
  using Base::kNodes;
  using Base::kPairs;

 public:
  static void strain(const ElementGroupView& group, const double* state, double* strain) {
    const std::int32_t points = Base::num_points(group);
    for (std::int32_t p = group.first_packet; p < group.last_packet; ++p) {
      Packet ue[kNodes][3];
      Base::gather(group, p, state, ue);
      for (int q = 0; q < points; ++q) {
        Kinematics<Packet> k;
        Base::displacement_gradient(group, p, q, ue, k);
        Packet e[6];
        strain_of(k, e);
        Base::store_symmetric(group, p, q, e, strain);
      }
    }
  }

  static double residual(const ElementGroupView& group, const MemoryView& memory,
                         const double* state, double* force) {
    return run<false>(group, memory, state, force, nullptr);
  }

  static double tangent(const ElementGroupView& group, const MemoryView& memory,
                        const double* state, double* force, double* values) {
    return run<true>(group, memory, state, force, values);
  }

 private:
  static void strain_of(Kinematics<Packet>& k, Packet (&e)[6]) {
    if constexpr (L != Law::linear) k.update();
    for (int m = 0; m < 6; ++m) {
      e[m] =
          L == Law::linear ? 0.5 * (k.h[kRow[m]][kColumn[m]] + k.h[kColumn[m]][kRow[m]]) : k.e[m];
    }
  }

  template <bool WithTangent>
  static double run(const ElementGroupView& group, const MemoryView& memory, const double* state,
                    double* force, double* values) {
    const std::int32_t points = Base::num_points(group);
    Packet energy = 0.0;
    for (std::int32_t p = group.first_packet; p < group.last_packet; ++p) {
      Packet moduli[2];
      for (int i = 0; i < 2; ++i) {
        moduli[i] = Packet::load(memory.moduli + (std::int64_t{2} * p + i) * kPacketSize);
      }
      Packet ue[kNodes][3];
      Base::gather(group, p, state, ue);
      Packet fe[kNodes][3];
      for (auto& row : fe) row[0] = row[1] = row[2] = 0.0;
      [[maybe_unused]] Packet ke[WithTangent ? kPairs : 1][9];
      if constexpr (WithTangent) {
        for (auto& block : ke) {
          for (Packet& value : block) value = 0.0;
        }
      }
      for (int q = 0; q < points; ++q) {
        const double* gradients = Base::gradients_at(group, p, q);
        const std::int64_t at = static_cast<std::int64_t>(p) * points + q;
        const Packet weight = Packet::load(group.weights + at * kPacketSize);
        Kinematics<Packet> k;
        Base::displacement_gradient(group, p, q, ue, k);
        Packet e[6];
        strain_of(k, e);
        Response<Packet> r;
        LawOf<L>::template evaluate<WithTangent>(k, moduli, r);
        for (int m = 0; m < 6; ++m) {
          const Packet h = Packet::load(memory.stress + (6 * at + m) * kPacketSize);
          r.s[m] += h;
          r.energy += (m < 3 ? 1.0 : 2.0) * h * e[m];
        }
        energy += weight * r.energy;
        Base::add_force(k, r, weight, gradients, fe);
        if constexpr (WithTangent) Base::add_tangent(k, r, weight, gradients, ke);
      }
      Base::scatter_force(group, p, fe, force);
      if constexpr (WithTangent) Base::scatter_tangent(group, p, ke, values);
    }
    double sum = 0;
    for (int lane = 0; lane < kPacketSize; ++lane) sum += energy[lane];
    return sum;
  }
};

template <int Order, Law L>
constexpr MemoryKernels make_memory() {
  using M = Memory<Order, L>;
  return {&M::strain, &M::residual, &M::tangent};
}

template <int Order, Law L, Formulation Form>
constexpr Kernels make(const char* name) {
  using G = Group<Order, L, Form>;
  return {name,       kNumConstants<L>, &G::residual, &G::tangent, &G::determinants,
          &G::stress, &G::point_stress};
}

/// [mixed or not][law]; entries of laws that use the formulas of another law are empty.
struct Table {
  Kernels entries[2][num_laws];
};

template <int Order, Formulation Form, Law L>
void fill(Kernels (&row)[num_laws], const char* name) {
  if constexpr (law_of_energy(L) == L) row[static_cast<int>(L)] = make<Order, L, Form>(name);
}

template <int Order, int... Laws>
Table make_table(const char* name, std::integer_sequence<int, Laws...> /*laws*/) {
  Table table{};
  (fill<Order, Formulation::displacement, static_cast<Law>(Laws)>(table.entries[0], name), ...);
  (fill<Order, Formulation::mixed, static_cast<Law>(Laws)>(table.entries[1], name), ...);
  return table;
}

}  // namespace

#define PALPATE_STRING_(x) #x
#define PALPATE_STRING(x) PALPATE_STRING_(x)

const Kernels& kernels(int order, int law, bool is_mixed) {
  constexpr const char* name = PALPATE_STRING(PALPATE_INSTRUCTION_SET);
  constexpr auto laws = std::make_integer_sequence<int, num_laws>();
  static const Table linear = make_table<1>(name, laws);
  static const Table quadratic = make_table<2>(name, laws);
  return (order == 1 ? linear : quadratic).entries[is_mixed ? 1 : 0][law];
}

const MemoryKernels& memory_kernels(int order, bool is_linear) {
  static const MemoryKernels table[2][2] = {
      {make_memory<1, Law::st_venant_kirchhoff>(), make_memory<1, Law::linear>()},
      {make_memory<2, Law::st_venant_kirchhoff>(), make_memory<2, Law::linear>()}};
  return table[order - 1][is_linear ? 1 : 0];
}

}  // namespace palpate::PALPATE_INSTRUCTION_SET
