// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/preconditioner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "iterative/galerkin.h"
#include "iterative/passes.h"

namespace palpate {
namespace {

class CyclePreconditioner final : public Preconditioner {
 public:
  CyclePreconditioner(std::shared_ptr<const BlockPattern> pattern, std::unique_ptr<Cycle> cycle)
      : pattern_(std::move(pattern)), cycle_(std::move(cycle)) {}

  void reserve(int columns) override {
    cycle_->reserve(columns);
    b_.set_zero(pattern_->num_nodes, columns);
    x_.set_zero(pattern_->num_nodes, columns);
  }

  void apply(const NodeVectors<double>& r, NodeVectors<double>& z) override {
    const int columns = r.num_columns();
    double factors[3];
    double norms[3];
    dot(r.num_nodes(), columns, r.data(), r.data(), norms);
    for (int c = 0; c < columns; ++c) {
      norms[c] = std::sqrt(norms[c]);
      factors[c] = norms[c] > 0 ? 1 / norms[c] : 0;
    }
    convert(r.num_nodes(), columns, factors, r.data(), b_.data());
    cycle_->apply(columns, b_.data(), x_.data());
    for (int c = 0; c < columns; ++c) factors[c] = unit_ * norms[c];
    convert(r.num_nodes(), columns, factors, x_.data(), z.data());
  }

  [[nodiscard]] std::size_t bytes() const override {
    return cycle_->bytes() + b_.bytes() + x_.bytes();
  }

 protected:
  SetupReport prepare(const std::vector<double>& values) override {
    const Ranges ranges(static_cast<Index>(values.size()), kNumbersOfPart);
    std::array<double, Ranges::kMostParts> largest_of_part{};
    for_each_part(ranges.num_parts(), [&](Index part) {
      double largest = 0;
      for (Index i = ranges.first(part); i < ranges.first(part + 1); ++i) {
        largest = std::max(largest, std::abs(values[i]));
      }
      largest_of_part[part] = largest;
    });
    const double largest = *std::max_element(largest_of_part.begin(), largest_of_part.end());
    int exponent = 0;
    (void)std::frexp(largest, &exponent);
    const double unit = std::isfinite(largest) ? std::ldexp(1.0, -exponent) : 1;
    const SetupReport report = cycle_->refresh(values, unit);
    if (report.status == SetupStatus::ok) unit_ = unit;
    return report;
  }

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  std::unique_ptr<Cycle> cycle_;
  /// Factor of the values of the matrix, a power of two.
  double unit_ = 1;
  NodeVectors<float> b_;
  NodeVectors<float> x_;
};

}  // namespace

std::unique_ptr<Preconditioner> make_preconditioner(std::shared_ptr<const BlockPattern> pattern,
                                                    std::unique_ptr<Cycle> cycle) {
  return std::make_unique<CyclePreconditioner>(std::move(pattern), std::move(cycle));
}

std::unique_ptr<Preconditioner> make_preconditioner(std::shared_ptr<const BlockPattern> pattern,
                                                    const NodeLevels& levels, CoarseSolver coarse) {
  check(levels, *pattern);
  const auto make_coarse = [&](std::shared_ptr<const BlockPattern> corners) {
    return coarse == CoarseSolver::factor
               ? make_factor_cycle(std::move(corners), make_linear_solver())
               : make_aggregation_cycle(std::move(corners), levels.corners);
  };
  // If all nodes are corners, there is no second level.
  const bool is_linear = levels.num_corners() == levels.num_nodes();
  auto cycle =
      is_linear ? make_coarse(pattern) : make_two_level_cycle(pattern, levels, make_coarse);
  return make_preconditioner(std::move(pattern), std::move(cycle));
}

}  // namespace palpate
