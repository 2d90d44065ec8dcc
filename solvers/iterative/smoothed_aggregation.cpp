// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/smoothed_aggregation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>

#include "base/parallel.h"

namespace palpate {
namespace {

/// Couplings below this threshold are weak.
constexpr double kThreshold = 0.02;
/// A level with at most this many aggregates is solved exactly, by its inverse.
constexpr Index kFewAggregates = 100;
/// If the next level had more than this share of the nodes, as with many separate bodies, the
/// smoother alone has to do.
constexpr double kLeastReduction = 0.8;
/// A stiffness below this share of the largest is rounding: the body can move freely.
constexpr double kSingular = 1e-12;

/// The least number of rows of a part, for a dense matrix, and of blocks, for a sparse one.
constexpr Index kRowsOfPart = 128;
constexpr Index kBlocksOfPart = 4096;

std::vector<float> padded(std::size_t size) { return std::vector<float>(size + 2, 0.0F); }

template <int R, int C>
std::vector<float> as_floats(const std::vector<Block<R, C>>& blocks) {
  std::vector<float> floats = padded(blocks.size() * R * C);
  for_each_range({static_cast<Index>(blocks.size()), kBlocksOfPart}, [&](Index first, Index last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      Eigen::Matrix<float, R, C>::Map(floats.data() + i * R * C) = blocks[i].template cast<float>();
    }
  });
  return floats;
}

/// D⁻¹; nothing: a block is not positive definite.
template <int B>
std::optional<std::vector<Block<B, B>>> invert_diagonal(const BlockRows<B, B>& matrix) {
  std::vector<Block<B, B>> inverse(matrix.num_rows());
  std::atomic<bool> is_definite{true};
  for_each_range({matrix.num_rows(), kRowsOfPart}, [&](Index first_row, Index last_row) {
    for (Index node = first_row; node < last_row; ++node) {
      const auto* first = matrix.column.data() + matrix.start[node];
      const auto* last = matrix.column.data() + matrix.start[node + 1];
      const auto at = std::lower_bound(first, last, node) - matrix.column.data();
      const Eigen::LLT<Block<B, B>> factor(matrix.block[at]);
      if (factor.info() != Eigen::Success) is_definite = false;
      inverse[node] = factor.solve(Block<B, B>::Identity());
    }
  });
  if (!is_definite) return std::nullopt;
  return inverse;
}

template <int B>
double largest_eigenvalue_of(const BlockRows<B, B>& matrix,
                             const std::vector<Block<B, B>>& inverse) {
  using Vector = Eigen::Matrix<double, B, 1>;
  const Ranges ranges(matrix.num_rows(), kRowsOfPart);
  const auto times = [&](const Eigen::VectorXf& x, Eigen::VectorXf& y) {
    for_each_range(ranges, [&](Index first, Index last) {
      for (Index node = first; node < last; ++node) {
        Vector sum = Vector::Zero();
        for (Index k = matrix.start[node]; k < matrix.start[node + 1]; ++k) {
          sum.noalias() +=
              matrix.block[k] * x.segment<B>(B * matrix.column[k]).template cast<double>();
        }
        y.segment<B>(B * node) = sum.template cast<float>();
      }
    });
  };
  const auto divide = [&](const Eigen::VectorXf& x, Eigen::VectorXf& y) {
    for_each_range(ranges, [&](Index first, Index last) {
      for (Index node = first; node < last; ++node) {
        const Vector part = x.segment<B>(B * node).template cast<double>();
        y.segment<B>(B * node) = (inverse[node] * part).template cast<float>();
      }
    });
  };
  return largest_eigenvalue(Eigen::Index{B} * matrix.num_rows(), times, divide);
}

SetupReport indefinite(int negative) {
  SetupReport report;
  report.status = SetupStatus::indefinite;
  report.negative_at_least = std::max(negative, 1);
  return report;
}

template <int B>
Prolongation as_prolongation(BlockRows<B, 6> rows) {
  Prolongation result;
  result.rows = B;
  result.values = as_floats(rows.block);
  ByColumn columns = by_column(rows.num_columns, rows.start, rows.column);
  result.transposed = padded(rows.block.size() * 6 * B);
  for_each_range({static_cast<Index>(rows.block.size()), kBlocksOfPart},
                 [&](Index first, Index last) {
                   for (Index k = first; k < last; ++k) {
                     Eigen::Matrix<float, 6, B>::Map(&result.transposed[std::size_t{6 * B} * k]) =
                         rows.block[columns.place[k]].transpose().template cast<float>();
                   }
                 });
  result.column_start = std::move(columns.start);
  result.row = std::move(columns.row);
  result.start = std::move(rows.start);
  result.column = std::move(rows.column);
  return result;
}

/// Makes the next level: its prolongation, matrix and motions. It returns nothing if the level
/// would have hardly fewer nodes.
template <int B>
std::optional<BlockRows<6, 6>> coarsen(const BlockRows<B, B>& matrix,
                                       const std::vector<Block<B, B>>& inverse, double largest,
                                       const Motions<B>& motions, Prolongation& prolongation,
                                       Motions<6>& coarse_motions) {
  const Aggregates aggregates = aggregate(matrix, kThreshold);
  if (aggregates.count > kLeastReduction * matrix.num_rows()) return std::nullopt;
  // The damping that minimises the largest eigenvalue of the smoothed motions.
  const double omega = 4 / (3 * largest);
  const BlockRows<B, 6> rows = smoothed_prolongation(
      matrix, inverse, omega, tentative_prolongation(aggregates, motions, coarse_motions));
  BlockRows<6, 6> coarse = coarse_matrix(matrix, rows);
  prolongation = as_prolongation(rows);
  return coarse;
}

/// Inverts a small matrix. The report says if it is not positive definite.
SetupReport invert(const BlockRows<6, 6>& matrix, Eigen::MatrixXf& inverse) {
  const Eigen::Index size = 6 * Eigen::Index{matrix.num_rows()};
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
  for (Index row = 0; row < matrix.num_rows(); ++row) {
    for (Index k = matrix.start[row]; k < matrix.start[row + 1]; ++k) {
      dense.block<6, 6>(6 * row, 6 * matrix.column[k]) = matrix.block[k];
    }
  }
  // Scaled to a unit diagonal, parts of different stiffness are treated alike.
  if (!(dense.diagonal().array() > 0).all()) return indefinite(1);
  const Eigen::VectorXd scale = dense.diagonal().cwiseSqrt().cwiseInverse();
  dense = scale.asDiagonal() * dense * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> factor(dense);
  const Eigen::VectorXd pivots = factor.vectorD();
  const double rounding = kSingular * pivots.cwiseAbs().maxCoeff();
  const auto num_negative = static_cast<int>((pivots.array() < -rounding).count());
  if (num_negative > 0) return indefinite(num_negative);
  if ((pivots.array().abs() <= rounding).any()) {
    SetupReport report;
    report.status = SetupStatus::singular;
    return report;
  }
  const Eigen::MatrixXd solved = factor.solve(Eigen::MatrixXd(scale.asDiagonal()));
  const Eigen::MatrixXd result = scale.asDiagonal() * solved;
  inverse = ((result + result.transpose()) / 2).cast<float>();
  return {};
}

}  // namespace

std::size_t AggregateLevel::bytes() const {
  return prolongation.bytes() + (start.size() + column.size()) * sizeof(Index) +
         sizeof(float) * (values.size() + inverse_diagonal.size() + inverse.size() + b.size() +
                          x.size() + r.size() + d.size() + second_b.size() + second_x.size());
}

AggregationCycle::AggregationCycle(std::shared_ptr<const BlockPattern> pattern,
                                   const std::vector<Vec3>& places)
    : pattern_(std::move(pattern)),
      neighbours_(find_neighbourhoods(*pattern_)),
      motions_(rigid_motions(places)),
      finest_(pattern_) {}

SetupReport AggregationCycle::refresh(const std::vector<double>& values, double unit) {
  SetupReport report = check_diagonal(*pattern_, values);
  if (report.status != SetupStatus::ok) return report;
  Hierarchy hierarchy;
  if (pattern_->num_nodes > 0) {
    BlockRows<6, 6> matrix;
    Motions<6> motions;
    bool has_coarse = false;
    {
      BlockRows<3, 3> fine = all_blocks(*pattern_, neighbours_, values);
      for_each_range({static_cast<Index>(fine.block.size()), kBlocksOfPart},
                     [&](Index first, Index last) {
                       for (Index k = first; k < last; ++k) fine.block[k] *= unit;
                     });
      const auto inverse = invert_diagonal(fine);
      if (!inverse) return indefinite(1);
      const double largest = largest_eigenvalue_of(fine, *inverse);
      auto coarse = coarsen(fine, *inverse, largest, motions_, hierarchy.first, motions);
      has_coarse = coarse.has_value();
      if (has_coarse) matrix = std::move(*coarse);
    }
    while (has_coarse) {
      AggregateLevel& level = hierarchy.levels.emplace_back();
      level.num_nodes = matrix.num_rows();
      has_coarse = false;
      if (level.num_nodes <= kFewAggregates) {
        report = invert(matrix, level.inverse);
        if (report.status != SetupStatus::ok) return report;
        break;
      }
      const auto inverse = invert_diagonal(matrix);
      if (!inverse) return indefinite(1);
      const double largest = largest_eigenvalue_of(matrix, *inverse);
      level.polynomial = Chebyshev(largest);
      level.inverse_diagonal = as_floats(*inverse);
      Motions<6> coarse_motions;
      auto coarse = coarsen(matrix, *inverse, largest, motions, level.prolongation, coarse_motions);
      level.values = as_floats(matrix.block);
      level.start = std::move(matrix.start);
      level.column = std::move(matrix.column);
      has_coarse = coarse.has_value();
      if (!has_coarse) break;
      matrix = std::move(*coarse);
      motions = std::move(coarse_motions);
    }
  }
  finest_.refresh(values, unit);
  below_ = std::move(hierarchy);
  reserve(columns_);
  return report;
}

void AggregationCycle::reserve(int columns) {
  columns_ = columns;
  finest_.reserve(columns);
  residual_.set_zero(pattern_->num_nodes, columns);
  for (AggregateLevel& level : below_.levels) {
    const Eigen::Index size = Eigen::Index{8} * columns * level.num_nodes;
    for (Eigen::VectorXf* vector :
         {&level.b, &level.x, &level.r, &level.d, &level.second_b, &level.second_x}) {
      vector->setZero(size);
    }
  }
}

void AggregationCycle::solve(std::size_t at, int columns, const Eigen::VectorXf& b,
                             Eigen::VectorXf& x) {
  AggregateLevel& level = below_.levels[at];
  x.setZero();
  if (level.inverse.size() > 0) {
    const auto parts = [&](auto& vector, int column) {
      using Part = std::conditional_t<std::is_const_v<std::remove_reference_t<decltype(vector)>>,
                                      const Eigen::Matrix<float, 6, Eigen::Dynamic>,
                                      Eigen::Matrix<float, 6, Eigen::Dynamic>>;
      return Eigen::Map<Part, 0, Eigen::OuterStride<>>(
          vector.data() + 8 * column, 6, level.num_nodes, Eigen::OuterStride<>(8 * columns));
    };
    for (int column = 0; column < columns; ++column) {
      // r and d are work space for vectors without the zeros.
      auto from = level.r.head(6 * Eigen::Index{level.num_nodes});
      auto to = level.d.head(6 * Eigen::Index{level.num_nodes});
      from.reshaped(6, level.num_nodes) = parts(b, column);
      for_each_range({static_cast<Index>(to.size()), kRowsOfPart}, [&](Index first, Index last) {
        to.segment(first, last - first).noalias() =
            level.inverse.middleRows(first, last - first) * from;
      });
      parts(x, column) = to.reshaped(6, level.num_nodes);
    }
    return;
  }
  const auto update = [&](ChebyshevStep step, const Eigen::VectorXf& r) {
    chebyshev_update(level.num_nodes, level.inverse_diagonal.data(), columns, step, r.data(),
                     x.data(), level.d.data());
  };
  const auto find_residual = [&] {
    residual(level.view(), columns, b.data(), x.data(), level.r.data());
  };
  update({0, level.polynomial.first}, b);
  find_residual();
  update(level.polynomial.second, level.r);
  if (!level.prolongation.start.empty()) {
    find_residual();
    AggregateLevel& next = below_.levels[at + 1];
    restrict_to(level.prolongation.view(), columns, level.r.data(), next.b.data());
    visit(at + 1, columns);
    prolong(level.prolongation.view(), columns, next.x.data(), x.data());
  }
  find_residual();
  update({0, level.polynomial.first}, level.r);
  find_residual();
  update(level.polynomial.second, level.r);
}

void AggregationCycle::visit(std::size_t at, int columns) {
  AggregateLevel& level = below_.levels[at];
  solve(at, columns, level.b, level.x);
  if (level.inverse.size() > 0) return;  // the solution was exact
  residual(level.view(), columns, level.b.data(), level.x.data(), level.second_b.data());
  solve(at, columns, level.second_b, level.second_x);
  level.x += level.second_x;
}

void AggregationCycle::apply(int columns, const float* b, float* x) {
  finest_.start(columns, b, x);
  if (!below_.levels.empty()) {
    finest_.residual(columns, b, x, residual_.data());
    AggregateLevel& next = below_.levels.front();
    restrict_to(below_.first.view(), columns, residual_.data(), next.b.data());
    visit(0, columns);
    prolong(below_.first.view(), columns, next.x.data(), x);
  }
  finest_.smooth(columns, b, x);
}

std::size_t AggregationCycle::bytes() const {
  std::size_t bytes = finest_.bytes() + residual_.bytes() + below_.first.bytes() +
                      motions_.size() * sizeof(motions_[0]) +
                      neighbours_.start.size() * sizeof(Index) +
                      neighbours_.all.size() * sizeof(neighbours_.all[0]);
  for (const AggregateLevel& level : below_.levels) bytes += level.bytes();
  return bytes;
}

std::vector<Index> AggregationCycle::level_sizes() const {
  std::vector<Index> sizes{pattern_->num_nodes};
  for (const AggregateLevel& level : below_.levels) sizes.push_back(level.num_nodes);
  return sizes;
}

std::unique_ptr<Cycle> make_aggregation_cycle(std::shared_ptr<const BlockPattern> pattern,
                                              const std::vector<Vec3>& places) {
  return std::make_unique<AggregationCycle>(std::move(pattern), places);
}

}  // namespace palpate
