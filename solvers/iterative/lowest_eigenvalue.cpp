// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/lowest_eigenvalue.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "iterative/conjugate_gradients.h"
#include "iterative/passes.h"

namespace palpate {
namespace {

constexpr int kVectors = 3;
/// A direction of the basis is rounding if orthogonalisation leaves less than this share of it.
constexpr double kDependent = 1e-10;
/// A value below minus this share of the largest stiffness is negative, and not rounding.
constexpr double kEigenvalueRounding = 1e-14;
/// The approximate probability that a negative mode is missed.
constexpr double kChance = 1e-3;

/// Aᵀ B.
Eigen::Matrix3d products_of(const NodeVectors<double>& a, const NodeVectors<double>& b) {
  Eigen::Matrix<double, kVectors, kVectors, Eigen::RowMajor> products;
  gram(a.num_nodes(), a.data(), b.data(), products.data());
  return products;
}

/// Vectors, and the weight of each of them in each of three combinations.
struct Term {
  const NodeVectors<double>* vectors;
  Eigen::Matrix3d shares;
};

/// Computes the sum of the terms.
void combine(std::initializer_list<Term> terms, NodeVectors<double>& result) {
  using Node = Eigen::Matrix<double, 4, kVectors>;
  for_each_range({result.num_nodes(), kNodesOfPart}, [&](Index first, Index last) {
    for (Index node = first; node < last; ++node) {
      const std::size_t at = std::size_t{4 * kVectors} * node;
      Node sum = Node::Zero();
      for (const Term& term : terms) {
        sum.noalias() += Node::Map(term.vectors->data() + at) * term.shares;
      }
      Node::Map(result.data() + at) = sum;
    }
  });
}

/// The lowest values of xᵀKx / xᵀx among the combinations of some vectors.
struct Ritz {
  Eigen::Vector3d values = Eigen::Vector3d::Zero();
  /// The weight of each vector in the three combinations [number of vectors × 3].
  Eigen::MatrixXd shares;
};

/// The Rayleigh-Ritz method on an orthonormal basis of the span of the vectors. It returns nothing
/// if a vector is not finite.
/// @param products The products of K with the vectors.
std::optional<Ritz> rayleigh_ritz(const std::vector<const NodeVectors<double>*>& vectors,
                                  const std::vector<const NodeVectors<double>*>& products) {
  const Eigen::Index size = kVectors * static_cast<Eigen::Index>(vectors.size());
  Eigen::MatrixXd mass(size, size);
  Eigen::MatrixXd stiffness(size, size);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const auto put = [&](Eigen::MatrixXd& matrix, const Eigen::Matrix3d& block) {
        matrix.block<kVectors, kVectors>(kVectors * i, kVectors * j) = block;
        matrix.block<kVectors, kVectors>(kVectors * j, kVectors * i) = block.transpose();
      };
      put(mass, products_of(*vectors[i], *vectors[j]));
      put(stiffness, products_of(*vectors[i], *products[j]));
    }
  }
  if (!mass.allFinite() || !stiffness.allFinite()) return std::nullopt;
  const Eigen::VectorXd inverse_lengths = mass.diagonal().unaryExpr(
      [](double square) { return square > 0 ? 1 / std::sqrt(square) : 0.0; });
  mass = (inverse_lengths.asDiagonal() * mass * inverse_lengths.asDiagonal()).eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_mass(mass);
  const Eigen::VectorXd& squares = of_mass.eigenvalues();
  const Eigen::Index rank = (squares.array() > kDependent * squares.maxCoeff()).count();
  const Eigen::MatrixXd basis = inverse_lengths.asDiagonal() *
                                of_mass.eigenvectors().rightCols(rank) *
                                squares.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(basis.transpose() * stiffness * basis);
  Ritz ritz;
  ritz.shares.setZero(size, kVectors);
  // A body of one node has fewer modes than there are vectors.
  const Eigen::Index count = std::min<Eigen::Index>(rank, kVectors);
  ritz.shares.leftCols(count) = basis * modes.eigenvectors().leftCols(count);
  ritz.values.head(count) = modes.eigenvalues().head(count);
  return ritz;
}

Eigen::MatrixXd noise(Index num_nodes) {
  std::mt19937 engine(1);
  Eigen::MatrixXd columns(3 * Eigen::Index{num_nodes}, kVectors);
  for (double& x : columns.reshaped()) x = (engine() & 1U) != 0 ? 1 : -1;
  return columns;
}

/// The result of conjugate gradients for noise: K⁻¹ times the noise, or a direction of negative
/// curvature.
struct Search {
  Eigen::VectorXd vector;
  /// Whether there is no negative mode.
  bool is_definite = false;
};

Search search(const Operator& k, Preconditioner& preconditioner, const Eigen::VectorXd& b,
              int max_iterations) {
  KrylovSolver solver({kChance / std::sqrt(static_cast<double>(b.size())), max_iterations});
  Eigen::MatrixXd x = b;
  const SolveSummary summary = solver.solve(k, preconditioner, x);
  const bool is_negative = summary.status == SolveStatus::negative_curvature;
  return {is_negative ? summary.direction : x.col(0), summary.status == SolveStatus::converged};
}

}  // namespace

std::string to_string(EigenStatus status) {
  switch (status) {
    case EigenStatus::converged: return "converged";
    case EigenStatus::negative: return "negative";
    case EigenStatus::iteration_limit: return "iteration limit";
    case EigenStatus::sign_unknown: return "sign unknown";
    case EigenStatus::not_finite: return "not finite";
    case EigenStatus::no_preconditioner: return "no preconditioner";
  }
  return "unknown";
}

LowestEigenvalue find_lowest_eigenvalue(const Operator& k, Preconditioner& preconditioner,
                                        const EigenOptions& options) {
  const Index n = k.num_nodes();
  LowestEigenvalue result;
  if (n == 0) {
    result.value = std::numeric_limits<double>::infinity();
    return result;
  }
  if (!preconditioner.is_ready() || !k.is_finite()) {
    result.status = k.is_finite() ? EigenStatus::no_preconditioner : EigenStatus::not_finite;
    result.value = std::numeric_limits<double>::quiet_NaN();
    result.vector.setZero(3 * Eigen::Index{n});
    return result;
  }
  const Search found = search(k, preconditioner, noise(n).col(0), options.max_solve_iterations);
  NodeVectors<double> x, kx, p, kp, z, kz, r, sums, room;
  for (NodeVectors<double>* vector : {&x, &kx, &p, &kp, &z, &kz, &r, &room}) {
    vector->set_zero(n, kVectors);
  }
  sums.set_zero(k.num_sums(), kVectors);
  preconditioner.reserve(kVectors);
  // Noise after preconditioning has large parts in the lowest modes; the solution has larger ones.
  r.assign(noise(n));
  preconditioner.apply(r, x);
  x.column(0) = found.vector.reshaped(3, n);
  k.apply(x, sums, kx);
  bool has_p = false;
  const auto end = [&](EigenStatus status) {
    result.status = status;
    result.vector = x.column(0).reshaped();
    if (status == EigenStatus::not_finite) result.vector.setZero();
    return result;
  };
  for (bool has_z = false;; has_z = true) {
    std::vector<const NodeVectors<double>*> vectors{&x};
    std::vector<const NodeVectors<double>*> products{&kx};
    if (has_z) vectors.push_back(&z), products.push_back(&kz);
    if (has_p) vectors.push_back(&p), products.push_back(&kp);
    const std::optional<Ritz> ritz = rayleigh_ritz(vectors, products);
    if (!ritz) {
      result.value = std::numeric_limits<double>::quiet_NaN();
      return end(EigenStatus::not_finite);
    }
    const Eigen::Vector3d& values = ritz->values;
    result.value = values[0];

    // The step that is added to x is the next p; the same holds for their products with K.
    const auto move = [&](NodeVectors<double>& of_x, const NodeVectors<double>& of_z,
                          NodeVectors<double>& of_p) {
      const auto share = [&](Eigen::Index i) -> Eigen::Matrix3d {
        return ritz->shares.middleRows<kVectors>(kVectors * i);
      };
      if (has_p) {
        combine({{&of_z, share(1)}, {&of_p, share(2)}}, room);
      } else if (has_z) {
        combine({{&of_z, share(1)}}, room);
      }
      if (has_z) std::swap(of_p, room);
      combine({{&of_x, share(0)}, {&of_p, Eigen::Matrix3d::Identity()}}, room);
      std::swap(of_x, room);
    };
    move(x, z, p);
    move(kx, kz, kp);
    has_p = has_z;

    const bool is_negative = result.value < -kEigenvalueRounding * k.largest_diagonal();
    if (is_negative && options.stop_when_negative) return end(EigenStatus::negative);
    // r = K x − x λ, and its preconditioned z.
    combine({{&kx, Eigen::Matrix3d::Identity()}, {&x, Eigen::Matrix3d((-values).asDiagonal())}}, r);
    preconditioner.apply(r, z);
    double products_rz[kVectors];
    dot(n, kVectors, r.data(), z.data(), products_rz);
    if (!std::isfinite(products_rz[0])) return end(EigenStatus::not_finite);
    const double scale =
        std::max(std::abs(result.value), kEigenvalueRounding * k.largest_diagonal());
    result.error = std::abs(products_rz[0]) / scale;
    if (result.error <= options.tolerance) {
      if (is_negative) return end(EigenStatus::negative);
      const bool is_positive =
          found.is_definite && result.value > kEigenvalueRounding * k.largest_diagonal();
      return end(is_positive ? EigenStatus::converged : EigenStatus::sign_unknown);
    }
    if (result.iterations == options.max_iterations) return end(EigenStatus::iteration_limit);
    ++result.iterations;
    k.apply(z, sums, kz);
  }
}

Inertia inertia_of(const LowestEigenvalue& lowest, const SetupReport& setup) {
  Inertia inertia;
  inertia.lowest_eigenvalue = lowest.value;
  inertia.num_negative = setup.negative_at_least;
  if (lowest.status == EigenStatus::negative) {
    inertia.num_negative = std::max(inertia.num_negative, 1);
  }
  const bool is_known = inertia.num_negative > 0 || lowest.status == EigenStatus::converged;
  inertia.knowledge = is_known ? Inertia::Knowledge::at_least : Inertia::Knowledge::unknown;
  return inertia;
}

}  // namespace palpate
