// SPDX-License-Identifier: BSD-3-Clause
// A small orthonormal basis (POD: proper orthogonal decomposition) of displacement fields, grown
// tool space by tool space to a bound on the error that is checked on every field.
//
// The snapshots of a tool space are the columns of S = [u | w]: the displacements u of its n
// configurations and w = H ∂u/∂t, 3n of them, with H the spacing of the grid so that both have one
// unit. With the basis U [m × r] of earlier tool spaces, R = S − U Uᵀ S is what is new. A
// randomized range finder in blocks [HMT, 4.4] takes Q with R ≈ Q B, B = Qᵀ R; with B Bᵀ = W Λ Wᵀ
// the columns of Q W are the POD modes of R, of which as few are appended as keep the bound. No
// matrix of m × m is made, and one tool space's snapshots are in memory at a time.
//
// [HMT] Halko, Martinsson & Tropp, Finding Structure with Randomness, SIAM Review 53(2), 2011.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace palpate {

/// The smallest bound that can be kept in single precision.
inline constexpr double kLeastPodBound = 1e-5;

/// How a tool space's fields are represented: S ≈ modes · coefficients.
struct PodFit {
  /// [r × 4n]; r is the number of modes after this tool space.
  Eigen::MatrixXf coefficients;
  /// Largest displacement of a point |u|, m.
  double largest_displacement = 0;
  /// Largest error of a point's u, m.
  double displacement_error = 0;
  /// Largest error of a point's w, m.
  double sensitivity_error = 0;
};

class PodBasis {
 public:
  /// @param num_dofs m, three for each point.
  /// @param bound The largest error of u at any point, as a share of the largest |u| of the tool
  /// space;
  ///   where all u are zero (rest alone), that of w in the same way.
  /// @throws InputError the bound is not in [kLeastPodBound, 1).
  PodBasis(Eigen::Index num_dofs, double bound);

  /// Represents the fields of a tool space, and appends the modes that this takes. The result
  /// depends on what was given so far and its order alone.
  /// @param snapshots [m × 4n]: u of n configurations, then w, three columns a configuration.
  [[nodiscard]] PodFit extend(const Eigen::MatrixXf& snapshots);

  /// Orthonormal columns [m × r].
  [[nodiscard]] const Eigen::MatrixXf& modes() const { return modes_; }

 private:
  Eigen::MatrixXf modes_;
  double bound_;
  std::mt19937_64 random_{20080610};
};

}  // namespace palpate
