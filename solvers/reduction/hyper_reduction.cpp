// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/hyper_reduction.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "base/error.h"
#include "base/simd.h"
#include "reduced/reduced_energy.h"
#include "reduction/nnls.h"
#include "reduction/random_path.h"

namespace palpate {
namespace {

/// The number of points that are processed at a time.
constexpr std::size_t kChunk = 64 * kPacketSize;
/// The number of entries in each column of the random map.
constexpr int kEntries = 8;
/// The residual of the combined rows must be at most this share of the tolerance: the random map
/// keeps the norm of a residual that was fitted in it less well than other norms. On a liver it
/// makes it two thirds.
constexpr double kMargin = 0.55;
/// A state counts as if its force were at least this share of the largest. With 0.2, the largest
/// error of an equilibrium, which occurs where the force is large, is up to three times that with
/// 0.5.
constexpr double kLeastForce = 0.5;
/// The weight of the tools' forces: they are felt, while an error of a mode's force reaches the
/// tools only through the coupling of large deformations.
constexpr double kWeightOfTools = 3;

/// Calls f(index of the first point, points of the chunk, their energy) for chunks of the chosen
/// points.
template <class F>
void for_each_chunk(const BodyPoints& points, const std::vector<Material>& materials,
                    const Eigen::MatrixXd& basis, const std::vector<Index>& chosen, F&& f) {
  for (std::size_t first = 0; first < chosen.size(); first += kChunk) {
    const std::size_t count = std::min<std::size_t>(kChunk, chosen.size() - first);
    const std::vector<Index> of_chunk(chosen.begin() + first, chosen.begin() + first + count);
    Eigen::VectorXd weights(count);
    for (std::size_t i = 0; i < count; ++i) weights[i] = points.weights()[of_chunk[i]];
    const BodyPoints::Reduced chunk = points.reduce(basis, of_chunk, weights);
    ReducedEnergy energy(chunk.points, materials);
    f(first, chunk, energy);
  }
}

/// Draws a number of points, ascending: half of them are those with the largest forces, since the
/// tools' forces may depend on few points, and the others are random.
std::vector<Index> draw(const Eigen::VectorXd& sizes, Index most, std::uint64_t seed) {
  const auto count = static_cast<Index>(sizes.size());
  std::vector<Index> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  const Index num_largest = most / 2;
  std::partial_sort(numbers.begin(), numbers.begin() + num_largest, numbers.end(),
                    [&](Index a, Index b) { return sizes[a] > sizes[b]; });
  RandomNumbers random(seed);
  for (Index i = num_largest; i < most; ++i) {
    std::swap(numbers[i], numbers[i + random.below(count - i)]);
  }
  numbers.resize(most);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

/// A random sparse map of rows onto fewer rows.
class RowMap {
 public:
  struct Entry {
    Index row;
    double sign;
  };

  RowMap(Eigen::Index num_rows, Eigen::Index num_targets, std::uint64_t seed)
      : entries_(static_cast<std::size_t>(num_rows)) {
    RandomNumbers random(seed);
    const double size = 1 / std::sqrt(static_cast<double>(kEntries));
    for (std::array<Entry, kEntries>& of_row : entries_) {
      for (Entry& entry : of_row) {
        entry.row = random.below(static_cast<Index>(num_targets));
        entry.sign = random.below(2) == 0 ? size : -size;
      }
    }
  }

  [[nodiscard]] const std::array<Entry, kEntries>& of(Eigen::Index row) const {
    return entries_[static_cast<std::size_t>(row)];
  }

 private:
  std::vector<std::array<Entry, kEntries>> entries_;
};

/// The force of one point in each coordinate.
void force_of_point(const ReducedPoints& points, const std::vector<double>& stress, Index place,
                    Eigen::VectorXd& force) {
  const Eigen::Index first =
      Eigen::Index{place / kPacketSize} * 9 * kPacketSize + place % kPacketSize;
  for (Eigen::Index c = 0; c < force.size(); ++c) {
    const double* column = points.gradients.data() + c * points.gradients.rows() + first;
    double sum = 0;
    for (int i = 0; i < 9; ++i) sum += column[i * kPacketSize] * stress[first + i * kPacketSize];
    force[c] = sum;
  }
}

}  // namespace

HyperReduction hyper_reduce(const BodyPoints& points, const std::vector<Material>& materials,
                            const Eigen::MatrixXd& basis, const Eigen::MatrixXd& tool_stiffness,
                            const Eigen::MatrixXd& states, const HyperReductionOptions& options) {
  const Eigen::Index n = basis.cols();
  const Eigen::Index d = tool_stiffness.rows();
  // In these coordinates the tools have the unit √J too.
  const Eigen::LLT<Eigen::MatrixXd> root(tool_stiffness);
  Eigen::MatrixXd scaled_basis = basis;
  Eigen::MatrixXd scaled_states = states;
  Eigen::MatrixXd of_tools = kWeightOfTools * scaled_basis.rightCols(d);
  root.matrixU().solveInPlace<Eigen::OnTheRight>(of_tools);
  scaled_basis.rightCols(d) = of_tools;
  scaled_states.bottomRows(d) = root.matrixU() * states.bottomRows(d) / kWeightOfTools;

  std::vector<Index> all(points.count());
  std::iota(all.begin(), all.end(), 0);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(n, states.cols());
  // Whether the laws are defined at all points, for each state.
  std::vector<char> is_defined(static_cast<std::size_t>(states.cols()), 1);
  for_each_chunk(points, materials, scaled_basis, all,
                 [&](std::size_t, const BodyPoints::Reduced&, ReducedEnergy& energy) {
                   for (Eigen::Index s = 0; s < states.cols(); ++s) {
                     const ReducedSums of_chunk = energy.evaluate(scaled_states.col(s).data());
                     if (!std::isfinite(of_chunk.elastic)) is_defined[s] = 0;
                     sums.col(s) += energy.force();
                   }
                 });
  HyperReduction result;
  std::vector<Eigen::Index> used;
  double largest = 0;
  for (Eigen::Index s = 0; s < states.cols(); ++s) {
    // A force that overflows says nothing, and would be the largest of all.
    if (is_defined[s] == 0 || !std::isfinite(sums.col(s).squaredNorm())) continue;
    used.push_back(s);
    largest = std::max(largest, sums.col(s).norm());
  }
  result.num_left_out = static_cast<int>(states.cols()) - static_cast<int>(used.size());
  if (!(largest > 0)) {
    throw InputError(
        "Of the " + std::to_string(states.cols()) +
        " states that a reduced model is made from, none has a force and an energy that "
        "is finite. Let the tools go less far (Reach).");
  }
  const auto scale_of = [&](Eigen::Index s) {
    return 1 / std::max(sums.col(s).norm(), kLeastForce * largest);
  };

  const Index max_points = std::min({options.max_points, options.max_candidates, points.count()});
  const auto num_rows =
      static_cast<Eigen::Index>(std::ceil(options.rows_of_point * static_cast<double>(max_points)));
  const RowMap map(static_cast<Eigen::Index>(used.size()) * n, num_rows, options.seed);
  const auto add_mapped = [&](std::size_t state, const Eigen::VectorXd& force, auto&& column) {
    const double scale = scale_of(used[state]);
    for (Eigen::Index c = 0; c < n; ++c) {
      for (const RowMap::Entry& entry : map.of(static_cast<Eigen::Index>(state) * n + c)) {
        column[entry.row] += entry.sign * scale * force[c];
      }
    }
  };
  Eigen::VectorXd b = Eigen::VectorXd::Zero(num_rows);
  for (std::size_t i = 0; i < used.size(); ++i) add_mapped(i, sums.col(used[i]), b);
  std::vector<Index> candidates = all;
  if (points.count() > options.max_candidates) {
    Eigen::VectorXd sizes = Eigen::VectorXd::Zero(points.count());
    for_each_chunk(points, materials, scaled_basis, all,
                   [&](std::size_t first, const BodyPoints::Reduced& chunk, ReducedEnergy& energy) {
                     Eigen::VectorXd force(n);
                     for (const Eigen::Index s : used) {
                       (void)energy.evaluate(scaled_states.col(s).data());
                       for (std::size_t k = 0; k < chunk.place.size(); ++k) {
                         force_of_point(chunk.points, energy.stress(), chunk.place[k], force);
                         sizes[static_cast<Eigen::Index>(first + k)] +=
                             (scale_of(s) * force).squaredNorm();
                       }
                     }
                   });
    candidates = draw(sizes, options.max_candidates, options.seed);
  }
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(num_rows, static_cast<Eigen::Index>(candidates.size()));
  for_each_chunk(points, materials, scaled_basis, candidates,
                 [&](std::size_t first, const BodyPoints::Reduced& chunk, ReducedEnergy& energy) {
                   Eigen::VectorXd force(n);
                   for (std::size_t i = 0; i < used.size(); ++i) {
                     (void)energy.evaluate(scaled_states.col(used[i]).data());
                     for (std::size_t k = 0; k < chunk.place.size(); ++k) {
                       force_of_point(chunk.points, energy.stress(), chunk.place[k], force);
                       add_mapped(i, force, a.col(static_cast<Eigen::Index>(first + k)));
                     }
                   }
                 });
  const NnlsResult solution = solve_nnls(a, b, {kMargin * options.tolerance, max_points});
  const Eigen::Index num_kept = (solution.x.array() > 0).count();
  result.weights.resize(num_kept);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const double factor = solution.x[static_cast<Eigen::Index>(i)];
    // This must agree with num_kept: what is not a number is left out too.
    if (!(factor > 0)) continue;
    result.weights[static_cast<Eigen::Index>(result.points.size())] =
        factor * points.weights()[candidates[i]];
    result.points.push_back(candidates[i]);
  }

  const BodyPoints::Reduced chosen = points.reduce(scaled_basis, result.points, result.weights);
  ReducedEnergy energy(chosen.points, materials);
  double error = 0;
  for (const Eigen::Index s : used) {
    (void)energy.evaluate(scaled_states.col(s).data());
    error += (scale_of(s) * (energy.force() - sums.col(s))).squaredNorm();
  }
  double size = 0;
  for (const Eigen::Index s : used) size += (scale_of(s) * sums.col(s)).squaredNorm();
  result.residual = std::sqrt(error / size);
  result.converged = result.residual <= options.tolerance;
  return result;
}

}  // namespace palpate
