// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set, see PALPATE_INSTRUCTION_SET in base/packet.h.
#include "assembly/kernels.h"

#include <limits>

#include "base/packet.h"
#include "materials/laws.h"

namespace palpate::PALPATE_INSTRUCTION_SET {
namespace {

static_assert(kLanes == kPacketSize);

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
  static constexpr int points = 4;
  /// See corner_extrapolation() in elements/tetrahedron.h: (1 − b)/(a − b) and −b/(a − b) with
  /// a = (5 + 3√5)/20, b = (5 − √5)/20.
  static constexpr double corner_own = 1.9270509831248424;
  static constexpr double corner_other = -0.30901699437494745;
};

template <int Order, Law L>
class Group {
  static constexpr int kNodes = Element<Order>::nodes;
  static constexpr int kPoints = Element<Order>::points;
  static constexpr int kPairs = kNodes * (kNodes + 1) / 2;

 public:
  static GroupResult residual(const ElementGroupView& group, const double* u, double* force) {
    return run<false>(group, u, force, nullptr);
  }

  static GroupResult tangent(const ElementGroupView& group, const double* u, double* force,
                             double* values) {
    return run<true>(group, u, force, values);
  }

  static void determinants(const ElementGroupView& group, const double* u, double* minimum_det_f) {
    for (std::int32_t p = 0; p < group.num_packets; ++p) {
      Packet ue[kNodes][3];
      gather(group, p, u, ue);
      Kinematics<Packet> at[kPoints];
      Packet least = std::numeric_limits<double>::max();
      for (int q = 0; q < kPoints; ++q) {
        displacement_gradient(group, p, q, ue, at[q]);
        at[q].update();
        least = min(least, 1.0 + at[q].j);
      }
      if constexpr (Order == 2) {
        for (int corner = 0; corner < 4; ++corner) {
          Kinematics<Packet> k;
          for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
              k.h[i][j] = 0.0;
              for (int q = 0; q < kPoints; ++q) {
                k.h[i][j] += (q == corner ? Element<2>::corner_own : Element<2>::corner_other) *
                             at[q].h[i][j];
              }
            }
          }
          k.update();
          least = min(least, 1.0 + k.j);
        }
      }
      least.store(minimum_det_f + p * kLanes);
    }
  }

 private:
  template <bool WithTangent>
  static GroupResult run(const ElementGroupView& group, const double* u, double* force,
                         double* values) {
    Packet energy = 0.0;
    Packet least = std::numeric_limits<double>::max();
    for (std::int32_t p = 0; p < group.num_packets; ++p) {
      Packet parameters[3];
      for (int i = 0; i < 3; ++i) {
        parameters[i] = group.homogeneous ? Packet(group.parameters[i])
                                          : Packet::load(group.parameters + (p * 3 + i) * kLanes);
      }
      Packet ue[kNodes][3];
      gather(group, p, u, ue);
      Packet fe[kNodes][3];
      for (auto& row : fe) row[0] = row[1] = row[2] = 0.0;
      [[maybe_unused]] Packet ke[WithTangent ? kPairs : 1][9];
      if constexpr (WithTangent) {
        for (auto& block : ke) {
          for (Packet& value : block) value = 0.0;
        }
      }
      for (int q = 0; q < kPoints; ++q) {
        const double* gradients = gradients_at(group, p, q);
        const Packet weight = Packet::load(group.weights + (p * kPoints + q) * kLanes);
        Kinematics<Packet> k;
        displacement_gradient(group, p, q, ue, k);
        k.update();
        if constexpr (L != Law::linear) least = min(least, 1.0 + k.j);
        if constexpr (has_inversion_barrier(L)) {
          // Where the law is not defined the energy is infinite (below); no lane may make a NaN.
          k.j = max(k.j, Packet(std::numeric_limits<double>::epsilon() - 1.0));
        }
        Response<Packet> r;
        LawOf<L>::template evaluate<WithTangent>(k, parameters, r);
        energy += weight * r.energy;
        add_force(k, r, weight, gradients, fe);
        if constexpr (WithTangent) add_tangent(k, r, weight, gradients, ke);
      }
      scatter_force(group, p, fe, force);
      if constexpr (WithTangent) scatter_tangent(group, p, ke, values);
    }
    GroupResult result{0, 1};
    for (int lane = 0; lane < kLanes; ++lane) {
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

  static const double* gradients_at(const ElementGroupView& group, std::int32_t p, int q) {
    return group.gradients + static_cast<std::int64_t>(p * kPoints + q) * kNodes * 3 * kLanes;
  }

  static void gather(const ElementGroupView& group, std::int32_t p, const double* u,
                     Packet (&ue)[kNodes][3]) {
    const std::int32_t* nodes = group.nodes + p * kNodes * kLanes;
    for (int a = 0; a < kNodes; ++a) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const double* at = u + 3 * static_cast<std::int64_t>(nodes[a * kLanes + lane]);
        for (int i = 0; i < 3; ++i) ue[a][i].lanes[lane] = at[i];
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
        const Packet g = Packet::load(gradients + (a * 3 + j) * kLanes);
        for (int i = 0; i < 3; ++i) k.h[i][j] += ue[a][i] * g;
      }
    }
  }

  static Packet f(const Kinematics<Packet>& k, int i, int j) {
    if constexpr (L == Law::linear) return i == j ? 1.0 : 0.0;
    return i == j ? 1.0 + k.h[i][j] : k.h[i][j];
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
          stress[i][j] = weight * (f(k, i, 0) * r.s[kSymmetric[0][j]] +
                                   f(k, i, 1) * r.s[kSymmetric[1][j]] +
                                   f(k, i, 2) * r.s[kSymmetric[2][j]]);
        }
      }
    }
    for (int a = 0; a < kNodes; ++a) {
      for (int j = 0; j < 3; ++j) {
        const Packet g = Packet::load(gradients + (a * 3 + j) * kLanes);
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
      for (int ll = 0; ll < 3; ++ll) gb[ll] = Packet::load(gradients + (b * 3 + ll) * kLanes);
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
          const Packet ga = Packet::load(gradients + (a * 3 + jj) * kLanes);
          for (int i = 0; i < 3; ++i) {
            for (int kk = 0; kk < 3; ++kk) block[3 * i + kk] += ga * ag[jj][i][kk];
          }
        }
      }
    }
  }

  /// Place of the pair a ≤ b in the order 00 01 … 0n 11 ….
  static constexpr int pair(int a, int b) { return a * kNodes - a * (a - 1) / 2 + b - a; }

  static void scatter_force(const ElementGroupView& group, std::int32_t p,
                            const Packet (&fe)[kNodes][3], double* force) {
    const std::int32_t* nodes = group.nodes + p * kNodes * kLanes;
    for (int a = 0; a < kNodes; ++a) {
      for (int lane = 0; lane < kLanes; ++lane) {
        double* at = force + 3 * static_cast<std::int64_t>(nodes[a * kLanes + lane]);
        for (int i = 0; i < 3; ++i) at[i] += fe[a][i][lane];
      }
    }
  }

  static void scatter_tangent(const ElementGroupView& group, std::int32_t p,
                              const Packet (&ke)[kPairs][9], double* values) {
    const BlockTarget* targets = group.targets + static_cast<std::int64_t>(p) * kPairs * kLanes;
    int index = 0;
    for (int a = 0; a < kNodes; ++a) {
      for (int b = a; b < kNodes; ++b, ++index) {
        double block[9][kLanes];
        for (int i = 0; i < 9; ++i) ke[index][i].store(block[i]);
        for (int lane = 0; lane < kLanes; ++lane) {
          const BlockTarget target = targets[index * kLanes + lane];
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
          // Element (r, c) of the stored block; its column c begins where the one before ends,
          // less the diagonal values that are above it.
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

template <int Order, Law L>
constexpr Kernels make(const char* name) {
  return {name, &Group<Order, L>::residual, &Group<Order, L>::tangent,
          &Group<Order, L>::determinants};
}

}  // namespace

#define PALPATE_STRING_(x) #x
#define PALPATE_STRING(x) PALPATE_STRING_(x)

const Kernels& kernels(int order, int law) {
  constexpr const char* name = PALPATE_STRING(PALPATE_INSTRUCTION_SET);
  static const Kernels table[2][num_laws] = {
      {make<1, Law::linear>(name), make<1, Law::st_venant_kirchhoff>(name),
       make<1, Law::neo_hookean>(name), make<1, Law::mooney_rivlin>(name)},
      {make<2, Law::linear>(name), make<2, Law::st_venant_kirchhoff>(name),
       make<2, Law::neo_hookean>(name), make<2, Law::mooney_rivlin>(name)}};
  return table[order - 1][law];
}

}  // namespace palpate::PALPATE_INSTRUCTION_SET
