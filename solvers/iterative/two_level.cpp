// SPDX-License-Identifier: BSD-3-Clause
// The cycles that need no header of their own.
#include <Eigen/Core>
#include <utility>

#include "iterative/cycle.h"
#include "iterative/galerkin.h"
#include "iterative/smoother.h"

namespace palpate {
namespace {

class SmootherCycle final : public Cycle {
 public:
  explicit SmootherCycle(std::shared_ptr<const BlockPattern> pattern)
      : matrix_(std::move(pattern)) {}

  SetupReport refresh(const std::vector<double>& values, double unit) override {
    const SetupReport report = check_diagonal(matrix_.pattern(), values);
    if (report.status == SetupStatus::ok) matrix_.refresh(values, unit);
    return report;
  }
  void reserve(int columns) override { matrix_.reserve(columns); }
  void apply(int columns, const float* b, float* x) override { matrix_.start(columns, b, x); }
  [[nodiscard]] std::size_t bytes() const override { return matrix_.bytes(); }

 private:
  SmoothedMatrix matrix_;
};

class FactorCycle final : public Cycle {
 public:
  FactorCycle(std::shared_ptr<const BlockPattern> pattern, std::unique_ptr<LinearSolver> solver)
      : pattern_(std::move(pattern)), solver_(std::move(solver)) {
    solver_->analyse(expanded(*pattern_));
  }

  SetupReport refresh(const std::vector<double>& values, double unit) override {
    SetupReport report = check_diagonal(*pattern_, values);
    if (report.status != SetupStatus::ok) return report;
    std::vector<double> scaled(values);
    for (double& value : scaled) value *= unit;
    if (solver_->factorise(scaled, Precision::single_if_safe) != FactorStatus::ok) {
      report.status = SetupStatus::singular;
    } else if (solver_->negative_pivots() > 0) {
      report.status = SetupStatus::indefinite;
      report.negative_at_least = solver_->negative_pivots();
    } else {
      last_good_ = std::move(scaled);
      return report;
    }
    // Factorise the last definite matrix again.
    if (!last_good_.empty()) (void)solver_->factorise(last_good_, Precision::single_if_safe);
    return report;
  }

  void reserve(int columns) override {
    columns_.resize(3 * Eigen::Index{pattern_->num_nodes}, columns);
  }

  void apply(int columns, const float* b, float* x) override {
    using Part = Eigen::Matrix<float, 4, Eigen::Dynamic>;
    const Eigen::OuterStride<> stride(4 * columns);
    const Index n = pattern_->num_nodes;
    for (int c = 0; c < columns; ++c) {
      const Eigen::Map<const Part, 0, Eigen::OuterStride<>> from(b + 4 * c, 4, n, stride);
      columns_.col(c).reshaped(3, n) = from.topRows<3>().cast<double>();
    }
    solver_->solve(columns_.leftCols(columns));
    for (int c = 0; c < columns; ++c) {
      Eigen::Map<Part, 0, Eigen::OuterStride<>> to(x + 4 * c, 4, n, stride);
      to.topRows<3>() = columns_.col(c).reshaped(3, n).cast<float>();
      to.row(3).setZero();
    }
  }

  [[nodiscard]] std::size_t bytes() const override {
    return solver_->factor_bytes() + (last_good_.size() + columns_.size()) * sizeof(double);
  }

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  std::unique_ptr<LinearSolver> solver_;
  /// The values of the last definite matrix, to which refresh() returns after a failure.
  std::vector<double> last_good_;
  Eigen::MatrixXd columns_;
};

class TwoLevelCycle final : public Cycle {
 public:
  TwoLevelCycle(std::shared_ptr<const BlockPattern> pattern, NodeLevels levels,
                const MakeCycle& make_coarse)
      : levels_(std::move(levels)), fine_(pattern) {
    check(levels_, *pattern);
    coarse_pattern_ = std::make_shared<const BlockPattern>(coarse_pattern(*pattern, levels_));
    children_ = find_children(levels_);
    galerkin_parts_ = find_galerkin_parts(*pattern, levels_);
    coarse_neighbours_ = find_neighbourhoods(*coarse_pattern_);
    coarse_ = make_coarse(coarse_pattern_);
  }

  SetupReport refresh(const std::vector<double>& values, double unit) override {
    SetupReport report = check_diagonal(fine_.pattern(), values);
    if (report.status != SetupStatus::ok) return report;
    {
      std::vector<double> coarse_values;
      galerkin_product(fine_.pattern(), levels_, galerkin_parts_, values, unit, *coarse_pattern_,
                       coarse_neighbours_, coarse_values);
      report = coarse_->refresh(coarse_values, 1);
    }
    if (report.status != SetupStatus::ok) {
      if (report.node >= 0) report.node = levels_.node_of_corner[report.node];
      return report;
    }
    fine_.refresh(values, unit);
    reserve(residual_.num_columns());
    return report;
  }

  void reserve(int columns) override {
    fine_.reserve(columns);
    coarse_->reserve(columns);
    residual_.set_zero(fine_.pattern().num_nodes, columns);
    coarse_b_.set_zero(coarse_pattern_->num_nodes, columns);
    coarse_x_.set_zero(coarse_pattern_->num_nodes, columns);
  }

  void apply(int columns, const float* b, float* x) override {
    fine_.start(columns, b, x);
    fine_.residual(columns, b, x, residual_.data());
    restrict_to(children_, columns, residual_.data(), coarse_b_.data());
    coarse_->apply(columns, coarse_b_.data(), coarse_x_.data());
    prolong(levels_.parents, columns, coarse_x_.data(), x);
    fine_.smooth(columns, b, x);
  }

  [[nodiscard]] std::size_t bytes() const override {
    return fine_.bytes() + coarse_->bytes() + coarse_pattern_->bytes() + residual_.bytes() +
           coarse_b_.bytes() + coarse_x_.bytes() + children_.bytes() + galerkin_parts_.bytes() +
           coarse_neighbours_.all.size() * sizeof(coarse_neighbours_.all[0]) +
           levels_.parents.size() * sizeof(levels_.parents[0]) +
           levels_.corners.size() * (sizeof(Vec3) + sizeof(Index));
  }

 private:
  NodeLevels levels_;
  Children children_;
  GalerkinParts galerkin_parts_;
  SmoothedMatrix fine_;
  std::shared_ptr<const BlockPattern> coarse_pattern_;
  Neighbourhoods coarse_neighbours_;
  std::unique_ptr<Cycle> coarse_;
  NodeVectors<float> residual_;
  NodeVectors<float> coarse_b_;
  NodeVectors<float> coarse_x_;
};

}  // namespace

std::unique_ptr<Cycle> make_smoother_cycle(std::shared_ptr<const BlockPattern> pattern) {
  return std::make_unique<SmootherCycle>(std::move(pattern));
}

std::unique_ptr<Cycle> make_factor_cycle(std::shared_ptr<const BlockPattern> pattern,
                                         std::unique_ptr<LinearSolver> solver) {
  return std::make_unique<FactorCycle>(std::move(pattern), std::move(solver));
}

std::unique_ptr<Cycle> make_two_level_cycle(std::shared_ptr<const BlockPattern> pattern,
                                            NodeLevels levels, const MakeCycle& coarse) {
  return std::make_unique<TwoLevelCycle>(std::move(pattern), std::move(levels), coarse);
}

}  // namespace palpate
