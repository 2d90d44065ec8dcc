// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_embedding.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/surface_tree.h"

namespace palpate {
namespace {

/// Singular values below this share of the largest count as zero.
constexpr double kRankThreshold = 1e-9;
/// Smaller weights are left out.
constexpr double kLeastWeight = 1e-5;
/// The terms of a linear polynomial.
constexpr int kTerms = 4;

/// Points that share a triangle with each point, ascending, itself not among them.
std::vector<std::vector<Index>> find_neighbours(
    std::size_t num_points, const std::vector<std::array<Index, 3>>& triangles) {
  std::vector<std::vector<Index>> neighbours(num_points);
  for (const auto& triangle : triangles) {
    for (int k = 0; k < 3; ++k) {
      auto& of_point = neighbours[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
      of_point.push_back(triangle[static_cast<std::size_t>((k + 1) % 3)]);
      of_point.push_back(triangle[static_cast<std::size_t>((k + 2) % 3)]);
    }
  }
  for (auto& of_point : neighbours) {
    std::sort(of_point.begin(), of_point.end());
    of_point.erase(std::unique(of_point.begin(), of_point.end()), of_point.end());
  }
  return neighbours;
}

/// Adds the neighbours of points to them.
void add_ring(const std::vector<std::vector<Index>>& neighbours, std::vector<Index>& points) {
  std::vector<Index> all = points;
  for (const Index p : points) {
    const auto& more = neighbours[static_cast<std::size_t>(p)];
    all.insert(all.end(), more.begin(), more.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  points = std::move(all);
}

/// The interpolant around one triangle of a carrier.
class Interpolant {
 public:
  /// @param around The points of the carrier that count.
  Interpolant(const std::vector<Vec3>& carrier, const std::vector<Index>& around) {
    const auto count = static_cast<Eigen::Index>(around.size());
    points_.resize(3, count);
    for (Eigen::Index j = 0; j < count; ++j) {
      points_.col(j) = carrier[around[static_cast<std::size_t>(j)]];
    }
    origin_ = points_.rowwise().mean();
    points_.colwise() -= origin_;
    // Lengths of the order of 1 keep the matrix well scaled.
    const double size = points_.colwise().norm().maxCoeff();
    scale_ = size > 0 ? 1 / size : 1;
    points_ *= scale_;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count + kTerms, count + kTerms);
    for (Eigen::Index j = 0; j < count; ++j) {
      matrix.col(j) = values_at(points_.col(j));
      matrix.block<kTerms, 1>(count, j) = terms(points_.col(j));
      matrix.block<1, kTerms>(j, count) = terms(points_.col(j)).transpose();
    }
    factors_.setThreshold(kRankThreshold);
    factors_.compute(matrix);
  }

  /// The weights of the points at a place.
  [[nodiscard]] Eigen::VectorXd weights(const Vec3& place) const {
    const Vec3 x = scale_ * (place - origin_);
    Eigen::VectorXd right = values_at(x);
    right.tail<kTerms>() = terms(x);
    return factors_.solve(right).head(points_.cols());
  }

 private:
  [[nodiscard]] static Eigen::Vector4d terms(const Vec3& x) { return {1, x[0], x[1], x[2]}; }
  /// The radial functions of all points, with room for the polynomial.
  [[nodiscard]] Eigen::VectorXd values_at(const Vec3& x) const {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(points_.cols() + kTerms);
    values.head(points_.cols()) = (points_.colwise() - x).colwise().norm().array().cube();
    return values;
  }

  Eigen::Matrix3Xd points_;
  Vec3 origin_;
  double scale_ = 1;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors_;
};

}  // namespace

SurfaceEmbedding::SurfaceEmbedding(const std::vector<Vec3>& points,
                                   const std::vector<std::array<Index, 3>>& triangles,
                                   const std::vector<Vec3>& embedded)
    : weights_(static_cast<Eigen::Index>(embedded.size()),
               static_cast<Eigen::Index>(points.size())) {
  const SurfaceTree tree(points, triangles);
  const auto neighbours = find_neighbours(points.size(), triangles);
  std::vector<double> distances;
  std::vector<Vec3> places = embedded;
  std::map<Index, std::vector<Index>> at_triangle;
  Index hint = -1;
  for (std::size_t p = 0; p < embedded.size(); ++p) {
    const SurfaceTree::Nearest nearest = tree.nearest(embedded[p], hint);
    hint = nearest.triangle;
    nearest_.push_back({tree.points_of(nearest.triangle), nearest.weights});
    const double distance = std::abs(nearest.distance);
    distances.push_back(distance);
    // Far from the carrier the interpolant is not to be continued.
    const double most = tree.longest_side(nearest.triangle);
    if (distance > most) {
      places[p] = nearest.point + most / distance * (embedded[p] - nearest.point);
    }
    at_triangle[nearest.triangle].push_back(static_cast<Index>(p));
  }
  std::vector<Eigen::Triplet<float>> entries;
  for (const auto& [triangle, here] : at_triangle) {
    const std::array<Index, 3>& corners = tree.points_of(triangle);
    std::vector<Index> around(corners.begin(), corners.end());
    add_ring(neighbours, around);
    add_ring(neighbours, around);
    const Interpolant interpolant(points, around);
    for (const Index p : here) {
      Eigen::VectorXd weights = interpolant.weights(places[static_cast<std::size_t>(p)]);
      weights = (weights.array().abs() < kLeastWeight).select(0, weights);
      weights /= weights.sum();
      for (Eigen::Index j = 0; j < weights.size(); ++j) {
        if (weights[j] == 0) continue;
        entries.emplace_back(p, around[static_cast<std::size_t>(j)],
                             static_cast<float>(weights[j]));
      }
    }
  }
  weights_.setFromTriplets(entries.begin(), entries.end());
  if (distances.empty()) return;
  largest_distance_ = *std::max_element(distances.begin(), distances.end());
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  median_distance_ = *middle;
}

Eigen::VectorXf SurfaceEmbedding::displacement(const Eigen::VectorXf& u) const {
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  Eigen::VectorXf result(3 * weights_.rows());
  Eigen::Map<Rows>(result.data(), weights_.rows(), 3).noalias() =
      weights_ * Eigen::Map<const Rows>(u.data(), weights_.cols(), 3);
  return result;
}

}  // namespace palpate
