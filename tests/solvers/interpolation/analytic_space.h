// SPDX-License-Identifier: BSD-3-Clause
// Tool spaces whose configurations come from energies with known derivatives.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "interpolation/cell_tree.h"
#include "interpolation/extrapolated_node.h"
#include "state_space/touch_space.h"

namespace palpate::test {

struct Sample {
  double energy = 0;
  Vec3 force = Vec3::Zero();
  Mat3 stiffness = Mat3::Zero();
};
using Energy = std::function<Sample(const Vec3&)>;

inline constexpr double kHalfWidth = 0.012;

/// Scales the formulas: they are of the order of 1 within the box, J and N/m as they come.
inline constexpr double kUnit = 0.01;

/// e^q with q = w·x + ½ x·A x and x = t/kUnit: smooth, unsymmetric, stiffening.
inline Sample exponential(const Vec3& t) {
  const Vec3 w(0.3, -0.2, 0.4);
  Mat3 a;
  a << 0.6, 0.1, -0.2, 0.1, 0.5, 0.15, -0.2, 0.15, 0.8;
  const Vec3 x = t / kUnit;
  const Vec3 g = w + a * x;
  const double e = std::exp(w.dot(x) + 0.5 * x.dot(a * x));
  return {e, e * g / kUnit, e * (g * g.transpose() + a) / (kUnit * kUnit)};
}

/// x^a y^b z^c with (x, y, z) = t/kUnit.
inline Energy monomial(int a, int b, int c) {
  return [a, b, c](const Vec3& t) {
    const int order[3] = {a, b, c};
    double f[3][3];
    for (int k = 0; k < 3; ++k) {
      const double x = t[k] / kUnit;
      const int n = order[k];
      f[k][0] = std::pow(x, n);
      f[k][1] = n > 0 ? n * std::pow(x, n - 1) : 0;
      f[k][2] = n > 1 ? n * (n - 1) * std::pow(x, n - 2) : 0;
    }
    Sample s;
    s.energy = f[0][0] * f[1][0] * f[2][0];
    for (int i = 0; i < 3; ++i) {
      int d[3] = {0, 0, 0};
      ++d[i];
      s.force[i] = f[0][d[0]] * f[1][d[1]] * f[2][d[2]] / kUnit;
      for (int j = 0; j < 3; ++j) {
        int dd[3] = {d[0], d[1], d[2]};
        ++dd[j];
        s.stiffness(i, j) = f[0][dd[0]] * f[1][dd[1]] * f[2][dd[2]] / (kUnit * kUnit);
      }
    }
    return s;
  };
}

/// ∂³ of exponential().
inline ThirdDerivative exponential_third(const Vec3& t) {
  const Sample s = exponential(t);
  const Vec3 g = kUnit * s.force / s.energy;
  const Mat3 a = kUnit * kUnit * s.stiffness / s.energy - g * g.transpose();
  ThirdDerivative third;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      for (int k = j; k < 3; ++k) {
        third[kThirdIndex[i][j][k]] =
            g[i] * g[j] * g[k] + g[i] * a(j, k) + g[j] * a(i, k) + g[k] * a(i, j);
      }
    }
  }
  return s.energy * third / (kUnit * kUnit * kUnit);
}

/// ∂³ of monomial().
inline std::function<ThirdDerivative(const Vec3&)> monomial_third(int a, int b, int c) {
  return [a, b, c](const Vec3& t) {
    ThirdDerivative third;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) {
        for (int k = j; k < 3; ++k) {
          int powers[3] = {a, b, c};
          double value = 1 / (kUnit * kUnit * kUnit);
          for (int axis : {i, j, k}) value *= powers[axis]--;
          for (int axis = 0; axis < 3 && value != 0; ++axis) {
            value *= std::pow(t[axis] / kUnit, powers[axis]);
          }
          third[kThirdIndex[i][j][k]] = value;
        }
      }
    }
    return third;
  };
}

inline void add_third_derivatives(TouchToolSpace& tool_space,
                                  const std::function<ThirdDerivative(const Vec3&)>& third) {
  for (ConfigurationSummary& c : tool_space.configurations) c.third_derivative = third(c.t);
}

inline ConfigurationSummary analytic_configuration(const Grid& grid, const Energy& energy,
                                                   const CheckPoint& p) {
  ConfigurationSummary c;
  c.check_point = p;
  c.t = grid.place(p);
  const Sample s = energy(c.t);
  c.energy = s.energy;
  c.force = s.force;
  c.stiffness = s.stiffness;
  c.outcome = Outcome::converged;
  return c;
}

/// Makes room for the coefficients of no modes, for each configuration.
inline void without_modes(TouchToolSpace& tool_space) {
  const auto size = static_cast<Eigen::Index>(tool_space.configurations.size());
  tool_space.coefficients.resize(0, size);
  tool_space.coefficient_gradients.resize(0, size);
}

/// The corners of the coarsest cells alone where the grid is not uniform.
inline TouchToolSpace analytic_space(const Energy& energy, std::int32_t resolution = 7,
                                     std::int32_t coarsest = 1) {
  TouchToolSpace tool_space;
  tool_space.setup.id = tool_space.setup.interaction.active_node = 4;
  tool_space.setup.grid.half_width = kHalfWidth;
  tool_space.setup.grid.resolution = resolution;
  tool_space.setup.grid.coarsest = coarsest;
  const std::int32_t r = tool_space.setup.grid.reach();
  for (std::int32_t i = -r; i <= r; i += coarsest) {
    for (std::int32_t j = -r; j <= r; j += coarsest) {
      for (std::int32_t k = -r; k <= r; k += coarsest) {
        tool_space.configurations.push_back(
            analytic_configuration(tool_space.setup.grid, energy, {i, j, k}));
      }
    }
  }
  without_modes(tool_space);
  return tool_space;
}

/// Adds what is missing of the points of a cell's halves.
inline void split(TouchToolSpace& tool_space, const Energy& energy, const Cell& cell) {
  const std::int32_t half = cell.side / 2;
  for (int point = 0; point < 27; ++point) {
    const ConfigurationSummary c = analytic_configuration(
        tool_space.setup.grid, energy,
        {cell.first[0] + half * (point / 9), cell.first[1] + half * (point / 3 % 3),
         cell.first[2] + half * (point % 3)});
    const auto place =
        std::lower_bound(tool_space.configurations.begin(), tool_space.configurations.end(), c);
    if (place != tool_space.configurations.end() && place->check_point == c.check_point) continue;
    tool_space.configurations.insert(place, c);
  }
  without_modes(tool_space);
}

/// Splits the leaves for which choose(cell) holds, until there are none.
template <class Choose>
void refine(TouchToolSpace& tool_space, const Energy& energy, Choose&& choose) {
  for (bool changed = true; changed;) {
    changed = false;
    const CellTree tree(tool_space.setup.grid, tool_space.configurations);
    for (const CellTree::Leaf& leaf : tree.leaves()) {
      if (leaf.cell.side == 1 || !choose(leaf.cell)) continue;
      split(tool_space, energy, leaf.cell);
      changed = true;
    }
  }
}

/// Cells of all sizes, smaller towards (0.3, −0.5, 0.6) half-widths; neighbours differ by one size.
inline TouchToolSpace graded_space(const Energy& energy, std::int32_t coarse = 5, int depth = 4) {
  const std::int32_t coarsest = 1 << depth;
  TouchToolSpace tool_space = analytic_space(energy, (coarse - 1) * coarsest + 1, coarsest);
  refine(tool_space, energy, [&](const Cell& cell) {
    const double reach = tool_space.setup.grid.reach();
    double distance = 0;
    int axis = 0;
    for (double centre : {0.3 * reach, -0.5 * reach, 0.6 * reach}) {
      const double low = cell.first[axis++];
      distance = std::max({distance, low - centre, centre - low - cell.side});
    }
    return distance < cell.side / 2.0;
  });
  return tool_space;
}

/// Cells next to each other of which one is eight times the size: in the corner of a cell.
inline TouchToolSpace unbalanced_space(const Energy& energy) {
  TouchToolSpace tool_space = analytic_space(energy, 33, 8);
  for (std::int32_t side : {8, 4, 2}) split(tool_space, energy, {{0, 0, 0}, side});
  for (std::int32_t side : {8, 4, 2}) split(tool_space, energy, {{-16, -16, 16 - side}, side});
  return tool_space;
}

inline ConfigurationSummary& at(TouchToolSpace& tool_space, const CheckPoint& check_point) {
  for (ConfigurationSummary& c : tool_space.configurations) {
    if (c.check_point == check_point) return c;
  }
  throw std::logic_error("no such check-point");
}

/// A displacement on a side of a leaf, and the step across it.
struct OnSide {
  Vec3 t;
  Vec3 across;
};

/// Random ones, on sides within the box.
inline std::vector<OnSide> points_on_sides(const TouchToolSpace& tool_space, int count) {
  // Enough to be on the other side after the rounding of t / spacing, and no more.
  constexpr double step = 3e-17;
  const CellTree tree(tool_space.setup.grid, tool_space.configurations);
  std::mt19937 random(11);
  std::uniform_int_distribution<std::size_t> any_leaf(0, tree.leaves().size() - 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<OnSide> points;
  while (static_cast<int>(points.size()) < count) {
    const Cell& cell = tree.leaves()[any_leaf(random)].cell;
    const int axis = static_cast<int>(random() % 3);
    const std::int32_t side = cell.first[axis] + (random() % 2 == 0 ? 0 : cell.side);
    if (std::abs(side) == tool_space.setup.grid.reach()) continue;
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = cell.first[k] + cell.side * uniform(random);
    x[axis] = side;
    points.push_back({tool_space.setup.grid.spacing() * x, step * Vec3::Unit(axis)});
  }
  return points;
}

/// Takes away configurations, and lets others fail, at random.
inline void make_holes(TouchToolSpace& tool_space, double share, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<ConfigurationSummary> left;
  for (const ConfigurationSummary& c : tool_space.configurations) {
    const double u = uniform(random);
    // Without those at the corners of the coarsest cells there is no telling the cells' size.
    if (u < share / 2 && tool_space.setup.grid.coarsest == 1) continue;
    left.push_back(c);
    if (u >= share) continue;
    left.back().outcome = Outcome::not_converged;
    left.back().force.setConstant(std::nan(""));
  }
  tool_space.configurations = std::move(left);
}

/// Displacements within a box, the same in every run.
class RandomPoints {
 public:
  explicit RandomPoints(double half_width = kHalfWidth, unsigned seed = 5)
      : uniform_(-half_width, half_width), random_(seed) {}
  Vec3 operator()() {
    const double x = uniform_(random_);
    const double y = uniform_(random_);
    return {x, y, uniform_(random_)};
  }

 private:
  std::uniform_real_distribution<double> uniform_;
  std::mt19937 random_;
};

}  // namespace palpate::test
