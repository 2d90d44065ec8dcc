// SPDX-License-Identifier: BSD-3-Clause
// A smooth function near the surfaces f = low … high of a distance function f, by a tensor product
// of B-splines of degree four on a regular grid of spacing h,
//
//   s(y) = Σ c_ijk β(x/h − i) β(y/h − j) β(z/h − k),   β = the centred B-spline of degree 4.
//
// s is C³ and its fourth derivatives are bounded. The coefficients follow from the samples f_ijk
// alone,
//
//   c = f − 5/24 (δ_x² + δ_y² + δ_z²) f,   δ_x² f_ijk = f_i+1,jk − 2 f_ijk + f_i−1,jk.
//
// This is quasi-interpolation of the fourth order (de Boor, A Practical Guide to Splines, ch. XII).
// It is exact for polynomials up to degree three, since Σ f_i β(x − i) = f + 5/24 f″ + … .
// Interpolation, for which c needs all samples (Unser, IEEE Signal Processing Magazine 16(6),
// 1999), has an error that is smaller by a quarter at the kinks of a distance, but it rings there.
// The values on the surface of a cube, in units of h, and of a sphere of radius 15 h are
//
//                         cube: error   |third derivative|   least curvature   sphere: error
//   c = f                       0.61          1.3                −0.07              0.028
//   quasi-interpolation         0.36          2.2                −0.15              0.00003
//   interpolation               0.27          5.2                −0.60            < 0.00001
//
// where errors and third derivatives are the largest ones. Outside a cube, the curvature of the
// exact distance is nowhere negative.
//
// The coefficients are stored in bricks of 8 × 8 × 8. A brick is kept only if one of its
// coefficients is needed between low and high.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "interaction/rigid_shape.h"

namespace palpate {

class BsplineGrid {
 public:
  struct Options {
    /// A box around all places where f lies between low and high, m.
    Eigen::AlignedBox3d bounds;
    /// The spacing h of the grid, m.
    double spacing = 0;
    double low = 0;
    double high = 0;
  };
  /// The largest number of bricks along one side: the index of all bricks has up to 67 MB.
  static constexpr int kMostBricksOfASide = 256;
  /// The largest number of bricks that are kept: 268 MB.
  static constexpr std::size_t kMostBricks = 1 << 16;

  using Function = std::function<double(const Vec3&)>;

  /// @param distance The function f, which changes by no more than the distance between two places.
  /// @throws InputError the grid would need more bricks than these limits allow.
  BsplineGrid(const Function& distance, const Options& options);

  /// Where f lies at a place: between low and high (band), below low, or above high.
  enum class Region { band, below, above };

  /// Evaluates s and its derivatives up to an order, 0 … 3, where all coefficients for this are
  /// kept, which is wherever f lies between low and high, and a little beyond.
  /// @returns band: the jet is filled; else it is left as it is, and f is below low or above high.
  [[nodiscard]] Region evaluate(const Vec3& place, int order, RigidShape::Jet& jet) const noexcept;

  [[nodiscard]] std::size_t num_coefficients() const { return coefficients_.size(); }

 private:
  using Node = std::array<Index, 3>;

  [[noreturn]] void fail() const;
  /// Finds which of the bricks in a cube of `side` bricks are kept.
  void find_bricks(const Function& distance, const Options& options, const Node& corner, Index side,
                   std::vector<Node>& kept);
  [[nodiscard]] std::size_t place_of_brick(const Node& brick) const noexcept;
  /// The entry of bricks_ for the brick of a node; kAbove outside the grid.
  [[nodiscard]] Index brick_of(const Node& node) const noexcept;
  [[nodiscard]] Vec3 position(const Node& node) const noexcept;
  template <int kOrder>
  void fill(const Node& first, const Vec3& in_cell, const std::array<const double*, 8>& corners,
            RigidShape::Jet& jet) const noexcept;

  double spacing_;
  /// The place of node 0, m.
  Vec3 origin_;
  /// The number of bricks along each side of the grid.
  Node num_bricks_;
  /// For each brick the place of its coefficients, in bricks, or one of kBelow and kAbove. The last
  /// index is the fastest.
  std::vector<Index> bricks_;
  /// [bricks kept × 8 × 8 × 8].
  std::vector<double> coefficients_;
};

}  // namespace palpate
