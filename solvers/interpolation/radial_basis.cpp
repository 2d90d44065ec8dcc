// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/radial_basis.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/simd.h"
#include "interpolation/nodal_stiffness.h"

namespace palpate {
namespace {

/// Centres nearer to each other than this, in spacings, are the same.
constexpr double kSamePlace = 1e-6;

/// A system is not singular if its largest residual at the centres is at most this share of the
/// largest value. With few centres in a plane, the polynomial is not determined.
constexpr double kResidual = 1e-8;

/// The components of the force, and the energy.
constexpr int kValues = 4;
/// The coefficients of 1, x, y and z.
constexpr int kPolynomial = 4;

/// The number of centres whose coordinates and weights are stored next to each other.
constexpr int kGroup = 8;

struct alignas(64) Group {
  double x[3][kGroup];
  double weights[kValues][kGroup];
};

/// The values and slopes along x, y and z of the force, and the value of the energy.
struct Sums {
  double value[kValues] = {};
  double slope[3][3] = {};
};

template <bool cubic>
double phi(double r) {
  return cubic ? r * r * r : r;
}

template <class V>
[[gnu::always_inline]] inline V root(const V& v) {
  V result;
#pragma GCC unroll 8
  for (int i = 0; i < kSizeOf<V>; ++i) result[i] = __builtin_sqrt(v[i]);
  return result;
}

template <class V>
[[gnu::always_inline]] inline double sum_of(const V& v) {
  double sum = 0;
  for (int i = 0; i < kSizeOf<V>; ++i) sum += v[i];
  return sum;
}

template <class V, bool cubic>
[[gnu::always_inline]] inline void sum_up(const Group* groups, std::size_t num_groups,
                                          const Vec3& x, Sums& sums) {
  V value[kValues] = {};
  V slope[3][3] = {};
  for (std::size_t g = 0; g < num_groups; ++g) {
    for (int first = 0; first < kGroup; first += kSizeOf<V>) {
      V d[3];
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        load(groups[g].x[k] + first, d[k]);
        d[k] = x[k] - d[k];
      }
      const V r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      const V r = root(r2);
      V phi_of_r = r;
      V slope_per_r;
      if constexpr (cubic) {
        phi_of_r = r2 * r;
        slope_per_r = 3 * r;
      } else {
        slope_per_r = r > 0 ? 1 / r : V{};
      }
#pragma GCC unroll 4
      for (int i = 0; i < kValues; ++i) {
        V w;
        load(groups[g].weights[i] + first, w);
        value[i] += w * phi_of_r;
        if (i == 3) continue;
        w *= slope_per_r;
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) slope[i][k] += w * d[k];
      }
    }
  }
  for (int i = 0; i < kValues; ++i) sums.value[i] += sum_of(value[i]);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) sums.slope[i][k] += sum_of(slope[i][k]);
  }
}

using Kernel = void (*)(const Group* groups, std::size_t num_groups, const Vec3& x, Sums& sums);

template <bool cubic>
void sum_up_baseline(const Group* groups, std::size_t num_groups, const Vec3& x, Sums& sums) {
  sum_up<Two, cubic>(groups, num_groups, x, sums);
}

#ifdef PALPATE_X86_SIMD
template <bool cubic>
[[gnu::target("avx2,fma")]] void sum_up_avx2(const Group* groups, std::size_t num_groups,
                                             const Vec3& x, Sums& sums) {
  sum_up<Four, cubic>(groups, num_groups, x, sums);
}

template <bool cubic>
[[gnu::target("avx512f,avx512dq,avx512vl,fma")]] void sum_up_avx512(const Group* groups,
                                                                    std::size_t num_groups,
                                                                    const Vec3& x, Sums& sums) {
  sum_up<Eight, cubic>(groups, num_groups, x, sums);
}
#endif

template <bool cubic>
Kernel best_kernel() {
#ifdef PALPATE_X86_SIMD
  switch (best_instruction_set()) {
    case InstructionSet::avx512: return sum_up_avx512<cubic>;
    case InstructionSet::avx2: return sum_up_avx2<cubic>;
    case InstructionSet::baseline: break;
  }
#endif
  return sum_up_baseline<cubic>;
}

/// Places [num × 3], in spacings, and values [num × 4].
struct Centres {
  std::vector<Vec3> places;
  std::vector<Eigen::Vector4d> values;
};

Centres find_centres(const TouchToolSpace& tool_space, const CheckPointGrid& grid,
                     const InterpolationOptions& options) {
  Centres centres;
  const Vec3& origin = tool_space.setup.grid.origin;
  const auto add = [&](const Vec3& t, const Vec3& force, double energy) {
    centres.places.push_back((t - origin) / grid.spacing());
    centres.values.emplace_back() << force, energy;
  };
  for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
    if (!grid.usable(n)) continue;
    const ConfigurationSummary& c = tool_space.configurations[grid.configuration(n)];
    add(c.t, c.force, c.energy);
  }
  if (!options.intermediate_states || !grid.any_usable()) return centres;
  for (const IntermediateState& state : tool_space.intermediate_states) {
    if (!state.usable() || !state.t.allFinite() || !state.force.allFinite() ||
        !std::isfinite(state.energy)) {
      continue;
    }
    const Vec3 place = (state.t - origin) / grid.spacing();
    const bool is_new = std::none_of(
        centres.places.begin(), centres.places.end(),
        [&](const Vec3& other) { return (place - other).squaredNorm() < kSamePlace * kSamePlace; });
    if (is_new) add(state.t, state.force, state.energy);
  }
  return centres;
}

template <bool cubic>
class RadialBasis final : public Interpolator {
 public:
  RadialBasis(const TouchToolSpace& tool_space, const InterpolationOptions& options)
      : Interpolator(tool_space),
        stiffness_(grid(), tool_space.configurations, options.third_derivatives),
        kernel_(best_kernel<cubic>()) {
    const Centres centres = find_centres(tool_space, grid(), options);
    if (centres.places.empty()) return;
    set_num_samples(centres.places.size());
    fill(centres, weights_of(centres, options.linear_polynomial));
  }

 private:
  /// The weights [number of centres, plus 4 with a polynomial; 4].
  [[nodiscard]] static Eigen::MatrixXd weights_of(const Centres& centres, bool with_polynomial) {
    const auto n = static_cast<Eigen::Index>(centres.places.size());
    // φ(0) = 0, so that a single centre needs the polynomial.
    const Eigen::Index m = with_polynomial || n == 1 ? kPolynomial : 0;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + m, n + m);
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(n + m, kValues);
    for (Eigen::Index j = 0; j < n; ++j) {
      const Vec3& x = centres.places[j];
      for (Eigen::Index i = 0; i < j; ++i) {
        matrix(i, j) = matrix(j, i) = phi<cubic>((x - centres.places[i]).norm());
      }
      if (m > 0) {
        matrix.col(j).tail<kPolynomial>() << 1, x;
        matrix.row(j).tail<kPolynomial>() << 1, x.transpose();
      }
      values.row(j) = centres.values[j].transpose();
    }
    Eigen::MatrixXd weights = matrix.partialPivLu().solve(values);
    const double residual = (matrix * weights - values).cwiseAbs().maxCoeff();
    if (!(residual <= kResidual * values.cwiseAbs().maxCoeff())) {
      weights = matrix.completeOrthogonalDecomposition().solve(values);
    }
    return weights;
  }

  void fill(const Centres& centres, const Eigen::MatrixXd& weights) {
    const std::size_t num = centres.places.size();
    groups_.resize((num + kGroup - 1) / kGroup, Group{});
    for (std::size_t c = 0; c < num; ++c) {
      Group& group = groups_[c / kGroup];
      const auto place = c % kGroup;
      for (int k = 0; k < 3; ++k) group.x[k][place] = centres.places[c][k];
      for (int i = 0; i < kValues; ++i) {
        group.weights[i][place] = weights(static_cast<Eigen::Index>(c), i);
      }
    }
    const Eigen::Index rest = weights.rows() - static_cast<Eigen::Index>(num);
    for (Eigen::Index q = 0; q < rest; ++q) {
      for (int i = 0; i < kValues; ++i) {
        const double of_q = weights(static_cast<Eigen::Index>(num) + q, i);
        if (q == 0) polynomial_.value[i] = of_q;
        if (q > 0) slopes_[q - 1][i] = of_q;
      }
    }
  }

  void do_evaluate(const Location& at, TouchResult& result) const noexcept override {
    Sums sums = polynomial_;
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < kValues; ++i) {
        sums.value[i] += slopes_[k][i] * at.x[k];
        if (i < 3) sums.slope[i][k] = slopes_[k][i];
      }
    }
    kernel_(groups_.data(), groups_.size(), at.x, sums);
    const double per_spacing = 1 / grid().spacing();
    for (int i = 0; i < 3; ++i) {
      result.force[i] = sums.value[i];
      for (int k = 0; k < 3; ++k) result.stiffness(i, k) = per_spacing * sums.slope[i][k];
    }
    result.energy = sums.value[3];
  }

  void do_smooth_stiffness(const Location& at, Mat3& stiffness) const noexcept override {
    stiffness = stiffness_.at(grid().leaf(at.leaf), at.s);
  }

  void do_add_memory(MemoryRanges& ranges) const override {
    ranges.push_back({this, sizeof *this});
    palpate::add_memory(groups_, ranges);
    stiffness_.add_memory(ranges);
  }

  std::vector<Group> groups_;
  /// The value of the polynomial at rest.
  Sums polynomial_;
  double slopes_[3][kValues] = {};
  NodalStiffness stiffness_;
  Kernel kernel_;
};

}  // namespace

std::unique_ptr<Interpolator> make_radial_basis(Method method, const TouchToolSpace& tool_space,
                                                const InterpolationOptions& options) {
  if (method == Method::rbf_cubic) return std::make_unique<RadialBasis<true>>(tool_space, options);
  return std::make_unique<RadialBasis<false>>(tool_space, options);
}

}  // namespace palpate
