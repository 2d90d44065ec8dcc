// SPDX-License-Identifier: BSD-3-Clause
// A small orthonormal basis (POD: proper orthogonal decomposition) of fields that come batch by
// batch, to a bound on the error that is checked on every field.
//
// Of each batch some columns are bound and others, in the same span mostly, follow: of a tool space
// the displacements u of its configurations are bound, and w = H ∂u/∂t follow, with H the spacing
// of the grid so that both have one unit. With the basis U [m × r] of earlier batches, R = S − U Uᵀ
// S is what is new. A randomized range finder in blocks [HMT, 4.4] takes Q with R ≈ Q B, B = Qᵀ R,
// until the bound columns are represented. At the end the coefficients C of all batches tell which
// directions matter: with C Cᵀ = W Λ Wᵀ the columns of U W are the POD modes, of which as few are
// kept as keep the bound. No matrix of m × m is made, and one batch is in memory at a time.
//
// [HMT] Halko, Martinsson & Tropp, Finding Structure with Randomness, SIAM Review 53(2), 2011.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

namespace palpate {

/// The smallest bound that can be kept in single precision, as a share of the largest field.
inline constexpr double kLeastPodBound = 1e-5;

/// @throws InputError the bound is not in [kLeastPodBound, 1).
void validate_pod_bound(double bound);

/// The largest length of a point's vector in any column; 0 where there is none.
/// @param components The number of components of a point's vector: rows that follow each other.
[[nodiscard]] double largest_at_a_point(const Eigen::Ref<const Eigen::MatrixXf>& fields,
                                        int components);

/// The same for the fields modes · coefficients, of which only a few columns are in memory at a
/// time.
[[nodiscard]] double largest_product_at_a_point(
    const Eigen::Ref<const Eigen::MatrixXf>& modes,
    const Eigen::Ref<const Eigen::MatrixXf>& coefficients, int components);

struct PodFit {
  /// [m × r]: those that the basis began with, as they were, then orthonormal columns.
  Eigen::MatrixXf modes;
  /// Coefficients of the bound columns, in the order in which they came [r × their number], and of
  /// those that followed.
  Eigen::MatrixXf bound;
  Eigen::MatrixXf following;
  /// The largest error at any point of any bound column, and of any that followed.
  double bound_error = 0;
  double following_error = 0;
};

class PodBasis {
 public:
  /// @param num_rows m, so many components for each point.
  /// @param limit The largest error of a bound column at any point, in the unit of the fields,
  ///   above 0.
  /// @param begin Modes that stay as they are [m × any]; they need not be orthonormal, but
  ///   independent.
  PodBasis(Eigen::Index num_rows, int components, double limit, Eigen::MatrixXf begin = {});

  /// Takes in a batch of fields [m × any]. The result depends on the batches and their order alone.
  void add(const Eigen::MatrixXf& bound, const Eigen::MatrixXf& following);

  /// @returns The modes and the coefficients of all batches. Nothing may be called afterwards.
  [[nodiscard]] PodFit finish();

 private:
  struct Batch {
    /// [modes at the time × columns].
    Eigen::MatrixXf bound;
    Eigen::MatrixXf following;
  };
  [[nodiscard]] Eigen::MatrixXf all_of(Eigen::MatrixXf Batch::*columns) const;
  /// The largest error that is made without the last modes.
  [[nodiscard]] double error_without(Eigen::Index dropped, const Eigen::MatrixXf& modes,
                                     const Eigen::MatrixXf& coefficients) const;
  /// The number of leading modes that keep the bound.
  [[nodiscard]] Eigen::Index sufficient(const Eigen::MatrixXf& modes,
                                        const Eigen::MatrixXf& coefficients) const;

  int components_;
  double limit_;
  Eigen::MatrixXf begin_;
  /// Orthonormal; the first columns span those of begin_.
  Eigen::MatrixXf modes_;
  std::vector<Batch> batches_;
  /// The largest errors so far.
  double bound_error_ = 0;
  double following_error_ = 0;
  std::mt19937_64 random_{20080610};
};

}  // namespace palpate
