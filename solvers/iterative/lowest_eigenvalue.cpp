// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/lowest_eigenvalue.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "iterative/passes.h"

namespace palpate {
namespace {

constexpr int kVectors = 3;
/// A direction of the basis of which less than this is left when the others are taken out of it is
/// rounding.
constexpr double kDependent = 1e-10;
/// A value below minus this share of the largest stiffness is negative, and no rounding.
constexpr double kRounding = 1e-14;

/// A basis that grows by blocks, each with its product with K.
struct BasisBlock {
  NodeVectors<double> vectors;
  NodeVectors<double> products;
};

/// Aᵀ B.
Eigen::Matrix3d gram(const NodeVectors<double>& a, const NodeVectors<double>& b) {
  Eigen::Matrix3d result;
  const Eigen::Index stride = 4 * kVectors;
  const Eigen::Map<const Eigen::MatrixXd> left(a.data(), stride, a.num_nodes());
  const Eigen::Map<const Eigen::MatrixXd> right(b.data(), stride, b.num_nodes());
  // All products of the rows of both, of which those of the same component of two vectors count.
  const Eigen::Matrix<double, 4 * kVectors, 4 * kVectors> products = left * right.transpose();
  for (int i = 0; i < kVectors; ++i) {
    for (int j = 0; j < kVectors; ++j) {
      result(i, j) = products.block<3, 3>(4 * i, 4 * j).trace();
    }
  }
  return result;
}

/// Σ_k blocks_k coefficients_k.
void combine(const std::vector<const NodeVectors<double>*>& blocks,
             const std::vector<Eigen::Matrix3d>& coefficients, NodeVectors<double>& result) {
  using Node = Eigen::Matrix<double, 4, kVectors>;
  for (Index node = 0; node < result.num_nodes(); ++node) {
    const std::size_t at = std::size_t{4 * kVectors} * node;
    Node sum = Node::Zero();
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      sum += Node::Map(blocks[k]->data() + at) * coefficients[k];
    }
    Node::Map(result.data() + at) = sum;
  }
}

}  // namespace

std::string to_string(EigenStatus status) {
  switch (status) {
    case EigenStatus::converged: return "converged";
    case EigenStatus::negative: return "negative";
    case EigenStatus::iteration_limit: return "iteration limit";
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
  NodeVectors<double> x, kx, p, kp, z, kz, r, sums, room;
  for (NodeVectors<double>* vector : {&x, &kx, &p, &kp, &z, &kz, &r, &sums, &room}) {
    vector->set_zero(n, kVectors);
  }
  preconditioner.reserve(kVectors);
  std::mt19937 engine(1);
  for (int c = 0; c < kVectors; ++c) {
    auto column = r.column(c);
    for (Index node = 0; node < n; ++node) {
      for (int i = 0; i < 3; ++i) column(i, node) = (engine() & 1U) != 0 ? 1 : -1;
    }
  }
  // What the preconditioner makes of noise has much of the lowest modes.
  preconditioner.apply(r, x);
  k.apply(x, sums, kx);
  bool has_p = false;
  const auto end = [&](EigenStatus status) {
    result.status = status;
    result.vector = x.column(0).reshaped();
    if (status == EigenStatus::not_finite) result.vector.setZero();
    return result;
  };
  for (bool has_z = false;; has_z = true) {
    // Rayleigh and Ritz's method on all that there is, of which an orthonormal basis is taken.
    std::vector<const NodeVectors<double>*> vectors{&x};
    std::vector<const NodeVectors<double>*> products{&kx};
    if (has_z) vectors.push_back(&z), products.push_back(&kz);
    if (has_p) vectors.push_back(&p), products.push_back(&kp);
    const auto blocks = static_cast<Eigen::Index>(vectors.size());
    Eigen::MatrixXd mass(kVectors * blocks, kVectors * blocks);
    Eigen::MatrixXd stiffness(kVectors * blocks, kVectors * blocks);
    for (Eigen::Index i = 0; i < blocks; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        mass.block<3, 3>(3 * i, 3 * j) = gram(*vectors[i], *vectors[j]);
        stiffness.block<3, 3>(3 * i, 3 * j) = gram(*vectors[i], *products[j]);
      }
    }
    if (!mass.triangularView<Eigen::Lower>().toDenseMatrix().allFinite() ||
        !stiffness.triangularView<Eigen::Lower>().toDenseMatrix().allFinite()) {
      result.value = std::numeric_limits<double>::quiet_NaN();
      return end(EigenStatus::not_finite);
    }
    const Eigen::VectorXd lengths = mass.diagonal().cwiseSqrt();
    const Eigen::VectorXd inverse_lengths =
        lengths.unaryExpr([](double length) { return length > 0 ? 1 / length : 0.0; });
    mass = inverse_lengths.asDiagonal() *
           mass.selfadjointView<Eigen::Lower>().toDenseMatrix().eval() *
           inverse_lengths.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_mass(mass);
    const auto num_dependent =
        (of_mass.eigenvalues().array() <= kDependent * of_mass.eigenvalues().maxCoeff()).count();
    const Eigen::Index rank = mass.rows() - num_dependent;
    const Eigen::MatrixXd basis =
        inverse_lengths.asDiagonal() * of_mass.eigenvectors().rightCols(rank) *
        of_mass.eigenvalues().tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
    const Eigen::MatrixXd projected =
        basis.transpose() * stiffness.selfadjointView<Eigen::Lower>().toDenseMatrix().eval() *
        basis;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(projected);
    // A body of one or two nodes may have fewer modes than there are vectors.
    const Eigen::Index num_modes = std::min<Eigen::Index>(rank, kVectors);
    Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(mass.rows(), kVectors);
    coefficients.leftCols(num_modes) = basis * ritz.eigenvectors().leftCols(num_modes);
    Eigen::Vector3d values = Eigen::Vector3d::Zero();
    values.head(num_modes) = ritz.eigenvalues().head(num_modes);
    result.value = values[0];

    std::vector<Eigen::Matrix3d> of_x(blocks);
    for (Eigen::Index i = 0; i < blocks; ++i) of_x[i] = coefficients.middleRows<3>(3 * i);
    // The next p is what the step adds to x.
    std::vector<Eigen::Matrix3d> of_p = of_x;
    of_p[0].setZero();
    const auto replace = [&](NodeVectors<double>& target,
                             const std::vector<const NodeVectors<double>*>& from,
                             const std::vector<Eigen::Matrix3d>& with) {
      combine(from, with, room);
      std::swap(target, room);
    };
    if (has_z) {
      NodeVectors<double> next_p = p;
      combine(vectors, of_p, room);
      std::swap(next_p, room);
      NodeVectors<double> next_kp = kp;
      combine(products, of_p, next_kp);
      replace(x, vectors, of_x);
      replace(kx, products, of_x);
      std::swap(p, next_p);
      std::swap(kp, next_kp);
      has_p = true;
    } else {
      replace(x, vectors, of_x);
      replace(kx, products, of_x);
    }

    const bool is_negative = result.value < -kRounding * k.largest_diagonal();
    if (is_negative && options.stop_when_negative) return end(EigenStatus::negative);
    // r = K x − x λ, and what the preconditioner makes of it.
    std::vector<Eigen::Matrix3d> of_r{Eigen::Matrix3d::Identity(),
                                      Eigen::Matrix3d((-values).asDiagonal())};
    combine({&kx, &x}, of_r, r);
    preconditioner.apply(r, z);
    double products_rz[kVectors];
    dot(n, kVectors, r.data(), z.data(), products_rz);
    if (!std::isfinite(products_rz[0])) return end(EigenStatus::not_finite);
    const double scale = std::max(std::abs(result.value), kRounding * k.largest_diagonal());
    result.error = std::abs(products_rz[0]) / scale;
    if (result.error <= options.tolerance) {
      return end(is_negative ? EigenStatus::negative : EigenStatus::converged);
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
