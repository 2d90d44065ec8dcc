// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/bspline_grid.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

constexpr Index kBelow = -1;
constexpr Index kAbove = -2;
/// The number of coefficients along the side of a brick, and in a whole brick.
constexpr int kSide = 8;
constexpr int kShift = 3;
constexpr int kVolume = kSide * kSide * kSide;
/// The number of coefficients along each axis that act at a place.
constexpr int kSupport = 5;
/// The largest distance of one of them from the place, in units of the spacing: 5/2 along each
/// axis.
const double kReach = 2.5 * std::sqrt(3.0);

using Node = std::array<Index, 3>;

/// The place of a node in its brick.
Index offset(const Node& node) {
  constexpr Index kMask = kSide - 1;
  return ((node[0] & kMask) * kSide + (node[1] & kMask)) * kSide + (node[2] & kMask);
}

/// Calls visit(node) for each node of bricks, in the order of the coefficients.
template <class Visit>
void for_nodes(const std::vector<Node>& bricks, const Visit& visit) {
  for (const auto& [x, y, z] : bricks) {
    for (Index i = 0; i < kVolume; ++i) {
      visit(
          {x * kSide + i / (kSide * kSide), y * kSide + i / kSide % kSide, z * kSide + i % kSide});
    }
  }
}

/// The B-splines of the five nodes around the nearest, and their derivatives.
template <int kOrder>
struct Weights {
  double of[kOrder + 1][kSupport];

  /// @param t The place beyond the nearest node, −½ … ½.
  explicit Weights(double t) {
    const double a = 0.5 - t;
    const double b = 0.5 + t;
    const double t2 = t * t;
    const auto set = [&](int order, double w0, double w1, double w2, double w3, double w4) {
      double* w = of[order];
      w[0] = w0;
      w[1] = w1;
      w[2] = w2;
      w[3] = w3;
      w[4] = w4;
    };
    const double even = 19.0 / 96 + t2 * (1.0 / 4 - t2 / 6);
    const double odd = t * (11.0 / 24 - t2 / 6);
    set(0, a * a * a * a / 24, even - odd, 115.0 / 192 + t2 * (t2 / 4 - 5.0 / 8), even + odd,
        b * b * b * b / 24);
    if constexpr (kOrder >= 1) {
      const double of_odd = 11.0 / 24 - t2 / 2;
      const double of_even = t * (1.0 / 2 - 2 * t2 / 3);
      set(1, -a * a * a / 6, of_even - of_odd, t * (t2 - 5.0 / 4), of_even + of_odd, b * b * b / 6);
    }
    if constexpr (kOrder >= 2) {
      set(2, a * a / 2, 0.5 + t - 2 * t2, 3 * t2 - 5.0 / 4, 0.5 - t - 2 * t2, b * b / 2);
    }
    if constexpr (kOrder >= 3) set(3, -a, 1 - 4 * t, 6 * t, -1 - 4 * t, b);
  }
};

}  // namespace

BsplineGrid::BsplineGrid(const Function& distance, const Options& options)
    : spacing_(options.spacing) {
  int root = 1;
  for (int k = 0; k < 3; ++k) {
    // Compare floating-point numbers, since the grid may have more nodes than an index counts.
    const double size = options.bounds.sizes()[k] + 2 * kReach * spacing_;
    const double num_bricks = std::ceil(size / (kSide * spacing_));
    if (!(num_bricks <= kMostBricksOfASide)) fail();
    num_bricks_[k] = static_cast<Index>(num_bricks);
    while (root < num_bricks_[k]) root *= 2;
    origin_[k] = options.bounds.center()[k] - (num_bricks_[k] * kSide - 1) * spacing_ / 2;
  }
  bricks_.assign(static_cast<std::size_t>(num_bricks_[0]) * num_bricks_[1] * num_bricks_[2],
                 kAbove);
  std::vector<Node> kept;
  find_bricks(distance, options, {0, 0, 0}, root, kept);

  std::vector<double> samples;
  samples.reserve(kept.size() * kVolume);
  for_nodes(kept, [&](const Node& node) { samples.push_back(distance(position(node))); });
  const auto sample = [&](const Node& node) {
    const Index brick = brick_of(node);
    return brick >= 0 ? samples[brick * std::size_t{kVolume} + offset(node)]
                      : distance(position(node));
  };
  coefficients_.reserve(samples.size());
  for_nodes(kept, [&](const Node& node) {
    double sum = -6 * sample(node);
    for (int k = 0; k < 3; ++k) {
      for (int step : {-1, 1}) {
        Node neighbour = node;
        neighbour[k] += step;
        sum += sample(neighbour);
      }
    }
    coefficients_.push_back(sample(node) - 5.0 / 24 * sum);
  });
}

void BsplineGrid::fail() const {
  throw InputError(
      "The smooth distance to the tool needs a grid of spacing " + quantity(spacing_, "m") +
      ", which is too fine for a tool of this size. Lengths are in m. Give contact a thicker layer "
      "(ContactThickness), in proportion to which edges of the tool are rounded; where the surface "
      "intersects itself, repair it.");
}

void BsplineGrid::find_bricks(const Function& distance, const Options& options, const Node& corner,
                              Index side, std::vector<Node>& kept) {
  Node end;
  for (int k = 0; k < 3; ++k) {
    end[k] = std::min(corner[k] + side, num_bricks_[k]);
    if (corner[k] >= end[k]) return;
  }
  // The distance from the middle to the farthest node, and from there to where its B-spline ends.
  const double half = (side * kSide - 1) * 0.5;
  const double slack = (std::sqrt(3.0) * half + kReach) * spacing_;
  const Vec3 first = position({corner[0] * kSide, corner[1] * kSide, corner[2] * kSide});
  const double in_the_middle = distance(first + Vec3::Constant(half * spacing_));
  if (in_the_middle - slack > options.high) return;
  if (in_the_middle + slack < options.low) {
    for (Index x = corner[0]; x < end[0]; ++x) {
      for (Index y = corner[1]; y < end[1]; ++y) {
        for (Index z = corner[2]; z < end[2]; ++z) bricks_[place_of_brick({x, y, z})] = kBelow;
      }
    }
  } else if (side == 1) {
    if (kept.size() == kMostBricks) fail();
    bricks_[place_of_brick(corner)] = static_cast<Index>(kept.size());
    kept.push_back(corner);
  } else {
    for (int child = 0; child < 8; ++child) {
      const Index half_side = side / 2;
      find_bricks(distance, options,
                  {corner[0] + (child >> 2) * half_side, corner[1] + (child >> 1 & 1) * half_side,
                   corner[2] + (child & 1) * half_side},
                  half_side, kept);
    }
  }
}

std::size_t BsplineGrid::place_of_brick(const Node& brick) const noexcept {
  return (static_cast<std::size_t>(brick[0]) * num_bricks_[1] + brick[1]) * num_bricks_[2] +
         brick[2];
}

Index BsplineGrid::brick_of(const Node& node) const noexcept {
  for (int k = 0; k < 3; ++k) {
    if (node[k] < 0 || node[k] >= num_bricks_[k] * kSide) return kAbove;
  }
  return bricks_[place_of_brick({node[0] >> kShift, node[1] >> kShift, node[2] >> kShift})];
}

Vec3 BsplineGrid::position(const Node& node) const noexcept {
  return origin_ + spacing_ * Vec3(node[0], node[1], node[2]);
}

BsplineGrid::Region BsplineGrid::evaluate(const Vec3& place, int order,
                                          RigidShape::Jet& jet) const noexcept {
  const Vec3 u = (place - origin_) / spacing_;
  Node first;
  Vec3 in_cell;
  for (int k = 0; k < 3; ++k) {
    const double nearest = std::floor(u[k] + 0.5);
    // The negated comparison also holds for a place that is not a number.
    if (!(nearest >= 2 && nearest < num_bricks_[k] * kSide - 2)) return Region::above;
    first[k] = static_cast<Index>(nearest) - 2;
    in_cell[k] = u[k] - nearest;
  }
  // The coefficients lie in up to eight bricks.
  std::array<const double*, 8> corners;
  for (int corner = 0; corner < 8; ++corner) {
    const Index brick = brick_of({first[0] + (corner >> 2) * (kSupport - 1),
                                  first[1] + (corner >> 1 & 1) * (kSupport - 1),
                                  first[2] + (corner & 1) * (kSupport - 1)});
    if (brick < 0) return brick == kBelow ? Region::below : Region::above;
    corners[corner] = coefficients_.data() + brick * std::size_t{kVolume};
  }
  switch (order) {
    case 0: fill<0>(first, in_cell, corners, jet); break;
    case 1: fill<1>(first, in_cell, corners, jet); break;
    case 2: fill<2>(first, in_cell, corners, jet); break;
    default: fill<3>(first, in_cell, corners, jet);
  }
  return Region::band;
}

// One axis is summed up after the other, for all derivatives at once.
template <int kOrder>
void BsplineGrid::fill(const Node& first, const Vec3& in_cell,
                       const std::array<const double*, 8>& corners,
                       RigidShape::Jet& jet) const noexcept {
  const Weights<kOrder> x(in_cell[0]);
  const Weights<kOrder> y(in_cell[1]);
  const Weights<kOrder> z(in_cell[2]);
  // The first of the five coefficients that lies in the next brick.
  const auto crossing = [](Index node) { return kSide - (node & (kSide - 1)); };
  const Node next{crossing(first[0]), crossing(first[1]), crossing(first[2])};
  double d[kOrder + 1][kOrder + 1][kOrder + 1] = {};
  for (int a = 0; a < kSupport; ++a) {
    double in_plane[kOrder + 1][kOrder + 1] = {};
    for (int b = 0; b < kSupport; ++b) {
      const int corner = (a >= next[0] ? 4 : 0) + (b >= next[1] ? 2 : 0);
      const Index row = offset({first[0] + a, first[1] + b, 0});
      double in_row[kOrder + 1] = {};
      for (int c = 0; c < kSupport; ++c) {
        const double* brick = corners[corner + (c >= next[2] ? 1 : 0)];
        const double coefficient = brick[row + ((first[2] + c) & (kSide - 1))];
        for (int k = 0; k <= kOrder; ++k) in_row[k] += z.of[k][c] * coefficient;
      }
      for (int j = 0; j <= kOrder; ++j) {
        for (int k = 0; j + k <= kOrder; ++k) in_plane[j][k] += y.of[j][b] * in_row[k];
      }
    }
    for (int i = 0; i <= kOrder; ++i) {
      for (int j = 0; i + j <= kOrder; ++j) {
        for (int k = 0; i + j + k <= kOrder; ++k) d[i][j][k] += x.of[i][a] * in_plane[j][k];
      }
    }
  }
  const double scale = 1 / spacing_;
  jet.value = d[0][0][0];
  if constexpr (kOrder >= 1) jet.gradient = scale * Vec3(d[1][0][0], d[0][1][0], d[0][0][1]);
  if constexpr (kOrder >= 2) {
    const double scale2 = scale * scale;
    jet.hessian << d[2][0][0], d[1][1][0], d[1][0][1],  //
        d[1][1][0], d[0][2][0], d[0][1][1],             //
        d[1][0][1], d[0][1][1], d[0][0][2];
    jet.hessian *= scale2;
  }
  if constexpr (kOrder >= 3) {
    jet.third << d[3][0][0], d[2][1][0], d[2][0][1], d[1][2][0], d[1][1][1], d[1][0][2], d[0][3][0],
        d[0][2][1], d[0][1][2], d[0][0][3];
    jet.third *= scale * scale * scale;
  }
}

}  // namespace palpate
