// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/conjugate_gradients.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "iterative/passes.h"

namespace palpate {
namespace {

/// A curvature below this share of the largest possible one is rounding.
constexpr double kCurvatureRounding = 1e-15;
/// Each true residual must be at most this share of the one before it in the same solve; else the
/// solve stagnates.
constexpr double kLeastProgress = 0.5;
/// After this many iterations without a smaller residual in the recurrence, the true residual is
/// computed, unless the energy xᵀKx/2 − bᵀx has fallen meanwhile by more than this share of its
/// whole decrease. The energy is what each iteration decreases: in a plate or a shell, whose
/// bending is a thousand times softer than its stretching, the residual first grows for hundreds of
/// iterations.
constexpr int kPatience = 60;
constexpr double kLeastFall = 1e-6;

constexpr int kMaxColumns = 3;
using Numbers = std::array<double, kMaxColumns>;

}  // namespace

std::string to_string(SolveStatus status) {
  switch (status) {
    case SolveStatus::converged: return "converged";
    case SolveStatus::iteration_limit: return "iteration limit";
    case SolveStatus::negative_curvature: return "negative curvature";
    case SolveStatus::singular: return "singular";
    case SolveStatus::indefinite_preconditioner: return "indefinite preconditioner";
    case SolveStatus::stagnated: return "stagnated";
    case SolveStatus::not_finite: return "not finite";
    case SolveStatus::no_preconditioner: return "no preconditioner";
  }
  return "unknown";
}

SolveSummary KrylovSolver::solve(const Operator& k, Preconditioner& preconditioner,
                                 Eigen::Ref<Eigen::MatrixXd> columns) {
  SolveSummary all;
  const auto refuse = [&](SolveStatus status) {
    columns.setZero();
    all.status = status;
    all.residual = 1;
    return all;
  };
  if (!preconditioner.is_ready()) return refuse(SolveStatus::no_preconditioner);
  if (!columns.allFinite() || !k.is_finite()) return refuse(SolveStatus::not_finite);
  for (Eigen::Index first = 0; first < columns.cols();) {
    const Eigen::Index together = columns.cols() - first >= kMaxColumns ? kMaxColumns : 1;
    auto part = columns.middleCols(first, together);
    first += together;
    if (all.status != SolveStatus::converged) {
      part.setZero();
      continue;
    }
    const int before = all.iterations;
    const double worst = all.residual;
    all = solve_together(k, preconditioner, part);
    all.iterations += before;
    all.residual = std::max(all.residual, worst);
  }
  return all;
}

SolveSummary KrylovSolver::solve_together(const Operator& k, Preconditioner& preconditioner,
                                          Eigen::Ref<Eigen::MatrixXd> columns) {
  const Index n = k.num_nodes();
  const auto m = static_cast<int>(columns.cols());
  for (NodeVectors<double>* vector : {&b_, &x_, &r_, &z_, &p_, &q_}) vector->set_zero(n, m);
  sums_.set_zero(k.num_sums(), m);
  preconditioner.reserve(m);
  b_.assign(columns);
  r_.assign(columns);

  const auto dots = [&](const NodeVectors<double>& a, const NodeVectors<double>& b) {
    Numbers products{};
    dot(n, m, a.data(), b.data(), products.data());
    return products;
  };
  Numbers b_norm = dots(b_, b_);
  for (double& norm : b_norm) norm = std::sqrt(norm);
  // A column that has converged is not changed any more: its steps are zero.
  std::array<bool, kMaxColumns> is_active{};
  for (int c = 0; c < m; ++c) is_active[c] = b_norm[c] > 0;
  // The residual of each column over its right-hand side, by the recurrence or true.
  Numbers relative{};
  const auto measure = [&] {
    const Numbers squares = dots(r_, r_);
    for (int c = 0; c < m; ++c) relative[c] = b_norm[c] > 0 ? std::sqrt(squares[c]) / b_norm[c] : 0;
  };
  const auto measure_truly = [&] {
    k.residual(b_, x_, sums_, r_);
    measure();
  };

  SolveSummary summary;
  const auto end = [&](SolveStatus status) {
    measure_truly();
    summary.status = status;
    summary.residual = *std::max_element(relative.begin(), relative.begin() + m);
    x_.copy_to(columns);
    if (!std::isfinite(summary.residual) || !columns.allFinite()) {
      columns.setZero();
      summary.residual = 1;
      summary.status = SolveStatus::not_finite;
    }
    return summary;
  };

  Numbers rz{};
  Numbers alpha{};
  // Whether the next direction of a column is the preconditioned residual alone.
  std::array<bool, kMaxColumns> begins{true, true, true};
  Numbers last_true{1, 1, 1};
  Numbers least{1, 1, 1};
  std::array<int, kMaxColumns> since_least{};
  // The decrease of the energy, N m: in all, and when since_least was last set to 0.
  Numbers fall{};
  Numbers last_fall{};
  while (is_active[0] || is_active[1] || is_active[2]) {
    if (summary.iterations == options_.max_iterations) return end(SolveStatus::iteration_limit);
    ++summary.iterations;

    // The direction: β = z·(r − r_old) / (r·z)_old, where r − r_old = −α q.
    preconditioner.apply(r_, z_);
    const Numbers next = dots(r_, z_);
    const Numbers change = dots(z_, q_);
    Numbers beta{};
    for (int c = 0; c < m; ++c) {
      if (!is_active[c]) continue;
      if (!std::isfinite(next[c])) return end(SolveStatus::not_finite);
      if (next[c] <= 0) return end(SolveStatus::indefinite_preconditioner);
      if (!begins[c]) beta[c] = -alpha[c] * change[c] / rz[c];
      begins[c] = false;
    }
    rz = next;
    scale_and_add(n, m, beta.data(), z_.data(), p_.data());

    // The step along the direction.
    k.apply(p_, sums_, q_);
    const Numbers curvature = dots(p_, q_);
    const Numbers length = dots(p_, p_);
    const Numbers slope = dots(p_, r_);
    alpha = {};
    for (int c = 0; c < m; ++c) {
      if (!is_active[c]) continue;
      const double rounding = kCurvatureRounding * k.largest_diagonal() * length[c];
      if (!std::isfinite(curvature[c])) return end(SolveStatus::not_finite);
      if (curvature[c] < -rounding) {
        summary.curvature = curvature[c] / length[c];
        summary.direction = p_.column(c).reshaped();
        return end(SolveStatus::negative_curvature);
      }
      if (curvature[c] <= rounding) return end(SolveStatus::singular);
      alpha[c] = slope[c] / curvature[c];
    }
    add(n, m, alpha.data(), p_.data(), x_.data());
    Numbers minus_alpha{};
    for (int c = 0; c < m; ++c) minus_alpha[c] = -alpha[c];
    add(n, m, minus_alpha.data(), q_.data(), r_.data());
    measure();

    // If a column seems to have converged or to stagnate, its true residual decides.
    std::array<bool, kMaxColumns> asks{};
    for (int c = 0; c < m; ++c) {
      if (!is_active[c]) continue;
      if (!std::isfinite(relative[c])) return end(SolveStatus::not_finite);
      fall[c] += 0.5 * alpha[c] * slope[c];
      const bool is_less = relative[c] < least[c];
      least[c] = std::min(least[c], relative[c]);
      ++since_least[c];
      if (is_less ||
          (since_least[c] == kPatience && fall[c] - last_fall[c] > kLeastFall * fall[c])) {
        since_least[c] = 0;
        last_fall[c] = fall[c];
      }
      asks[c] = relative[c] <= options_.tolerance || since_least[c] >= kPatience;
    }
    if (!(asks[0] || asks[1] || asks[2])) continue;
    measure_truly();
    for (int c = 0; c < m; ++c) {
      if (!asks[c]) continue;
      if (relative[c] <= options_.tolerance) {
        is_active[c] = false;
        continue;
      }
      if (!(relative[c] <= kLeastProgress * last_true[c])) return end(SolveStatus::stagnated);
      last_true[c] = least[c] = relative[c];
      since_least[c] = 0;
      begins[c] = true;
    }
  }
  return end(SolveStatus::converged);
}

std::size_t KrylovSolver::bytes() const {
  std::size_t bytes = 0;
  for (const NodeVectors<double>* vector : {&b_, &x_, &r_, &z_, &p_, &q_, &sums_}) {
    bytes += vector->bytes();
  }
  return bytes;
}

}  // namespace palpate
