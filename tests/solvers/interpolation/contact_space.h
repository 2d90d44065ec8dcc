// SPDX-License-Identifier: BSD-3-Clause
// Tool spaces of a rigid tool around a whole body, with energies of which every derivative is
// known: Π = s(q) f(d), with a depth d of the tool in the body and its layer of contact, δ thick.
// f = c d⁴ / (d + δ)^{3/2} begins as the fourth power and goes on as the contact of Hertz; s is
// smooth.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "interpolation/absent_cells.h"
#include "interpolation/cell_tree.h"
#include "interpolation/error_estimate.h"
#include "solvers/interpolation/analytic_space.h"

namespace palpate::test {

/// A function of three coordinates and its derivatives up to the third.
struct Jet {
  double value = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  double third[3][3][3] = {};

  [[nodiscard]] static Jet coordinate(const Vec3& q, int axis) {
    Jet jet;
    jet.value = q[axis];
    jet.first = Vec3::Unit(axis);
    return jet;
  }
};

inline Jet operator*(const Jet& a, const Jet& b) {
  Jet jet;
  jet.value = a.value * b.value;
  jet.first = a.value * b.first + b.value * a.first;
  jet.second = a.value * b.second + b.value * a.second + a.first * b.first.transpose() +
               b.first * a.first.transpose();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        jet.third[i][j][k] = a.value * b.third[i][j][k] + b.value * a.third[i][j][k] +
                             a.first[i] * b.second(j, k) + a.first[j] * b.second(i, k) +
                             a.first[k] * b.second(i, j) + b.first[i] * a.second(j, k) +
                             b.first[j] * a.second(i, k) + b.first[k] * a.second(i, j);
      }
    }
  }
  return jet;
}

inline Jet operator*(double a, Jet jet) {
  Jet factor;
  factor.value = a;
  return factor * jet;
}

inline Jet operator+(Jet a, const Jet& b) {
  a.value += b.value;
  a.first += b.first;
  a.second += b.second;
  for (int i = 0; i < 27; ++i) a.third[i / 9][i / 3 % 3][i % 3] += b.third[i / 9][i / 3 % 3][i % 3];
  return a;
}

/// f(u) @param f Value and derivatives of f at u.
inline Jet composed(const std::array<double, 4>& f, const Jet& u) {
  Jet jet;
  jet.value = f[0];
  jet.first = f[1] * u.first;
  jet.second = f[1] * u.second + f[2] * u.first * u.first.transpose();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        jet.third[i][j][k] = f[1] * u.third[i][j][k] +
                             f[2] * (u.first[i] * u.second(j, k) + u.first[j] * u.second(i, k) +
                                     u.first[k] * u.second(i, j)) +
                             f[3] * u.first[i] * u.first[j] * u.first[k];
      }
    }
  }
  return jet;
}

/// u^p for u > 0.
inline Jet power(const Jet& u, double p) {
  const double x = u.value;
  return composed({std::pow(x, p), p * std::pow(x, p - 1), p * (p - 1) * std::pow(x, p - 2),
                   p * (p - 1) * (p - 2) * std::pow(x, p - 3)},
                  u);
}

inline Jet sine(const Jet& u) {
  return composed({std::sin(u.value), std::cos(u.value), -std::sin(u.value), -std::cos(u.value)},
                  u);
}

/// A body that a tool presses; q, depth and clearance in m.
struct ContactExample {
  std::function<Jet(const Vec3& q)> depth;
  Clearance clearance;
};

/// Below the height z the tool touches.
inline ContactExample slab(double z) {
  return {[z](const Vec3& q) {
            Jet depth = -1 * Jet::coordinate(q, 2);
            depth.value += z;
            return depth;
          },
          [z](const Vec3& q) { return q[2] - z; }};
}

/// The tool touches within an ellipsoid, with its axes along those of q.
inline ContactExample ellipsoid(const Vec3& centre, const Vec3& half_axes) {
  const double least = half_axes.minCoeff();
  return {
      [=](const Vec3& q) {
        Jet sum;
        for (int axis = 0; axis < 3; ++axis) {
          Jet x = Jet::coordinate(q, axis);
          x.value -= centre[axis];
          x = (1 / half_axes[axis]) * x;
          sum = sum + x * x;
        }
        Jet depth = -least * power(sum, 0.5);
        depth.value += least;
        return depth;
      },
      [=](const Vec3& q) { return least * ((q - centre).cwiseQuotient(half_axes).norm() - 1); }};
}

inline constexpr double kLayer = 0.002;
/// c, N/m^{3/2}: the force at a depth of 8 mm is some 30 N.
inline constexpr double kStrength = 1.8e4;

/// Energy, force, stiffness and third derivatives at q.
inline Jet contact_energy(const ContactExample& contact, const Vec3& q) {
  const Jet depth = contact.depth(q);
  if (depth.value <= 0) return {};
  Jet shifted = depth;
  shifted.value += kLayer;
  const double waves = 25;
  Jet smooth = sine(waves * Jet::coordinate(q, 0) + 0.6 * waves * Jet::coordinate(q, 1)) *
               sine(-0.7 * waves * Jet::coordinate(q, 1) + 0.5 * waves * Jet::coordinate(q, 2));
  smooth = 0.3 * smooth;
  smooth.value += 1;
  return kStrength * smooth * power(depth, 4) * power(shifted, -1.5);
}

inline ConfigurationSummary contact_configuration(const ContactExample& contact, const Grid& grid,
                                                  const CheckPoint& p) {
  ConfigurationSummary c;
  c.check_point = p;
  c.t = grid.place(p);
  c.outcome = Outcome::converged;
  const Jet energy = contact_energy(contact, c.t);
  c.energy = energy.value;
  c.force = energy.first;
  c.stiffness = energy.second;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      for (int k = j; k < 3; ++k) c.third_derivative[kThirdIndex[i][j][k]] = energy.third[i][j][k];
    }
  }
  if (contact.depth(c.t).value <= 0) c.flags = flags::touches_nothing;
  return c;
}

/// Adds what is missing of these check-points.
inline void add_configurations(TouchToolSpace& tool_space, const ContactExample& contact,
                               const std::vector<CheckPoint>& points) {
  std::map<CheckPoint, ConfigurationSummary> all;
  for (const ConfigurationSummary& c : tool_space.configurations) all[c.check_point] = c;
  for (const CheckPoint& p : points) {
    if (all.count(p) == 0) all[p] = contact_configuration(contact, tool_space.setup.grid, p);
  }
  tool_space.configurations.clear();
  for (const auto& [p, c] : all) tool_space.configurations.push_back(c);
  without_modes(tool_space);
}

/// The coarsest cells that are not proved free and are in part less deep than a depth.
inline TouchToolSpace contact_space(const ContactExample& contact, const Grid& grid, double depth) {
  TouchToolSpace tool_space;
  tool_space.setup.id = kContactToolSpace;
  RigidTool sphere;
  sphere.radius = 0.01;
  tool_space.setup.interaction = rigid_contact_spec(sphere);
  tool_space.setup.grid = grid;
  tool_space.clearance = contact.clearance;
  std::vector<CheckPoint> corners;
  for (std::int32_t i = -grid.reach(); i < grid.reach(); i += grid.coarsest) {
    for (std::int32_t j = -grid.reach(); j < grid.reach(); j += grid.coarsest) {
      for (std::int32_t k = -grid.reach(); k < grid.reach(); k += grid.coarsest) {
        const Cell cell{{i, j, k}, grid.coarsest};
        if (is_proved_free(grid, contact.clearance, cell)) continue;
        double least = contact.depth(grid.place(cell.first)).value;
        for (int corner = 1; corner < 8; ++corner) {
          least = std::min(least, contact.depth(grid.place(corner_of(cell, corner))).value);
        }
        if (least > depth) continue;
        for (int corner = 0; corner < 8; ++corner) corners.push_back(corner_of(cell, corner));
      }
    }
  }
  add_configurations(tool_space, contact, corners);
  return tool_space;
}

inline void split(TouchToolSpace& tool_space, const ContactExample& contact,
                  const std::vector<Cell>& cells) {
  std::vector<CheckPoint> points;
  for (const Cell& cell : cells) {
    for (int point = 0; point < 27; ++point) points.push_back(point_of_halves(cell, point));
  }
  add_configurations(tool_space, contact, points);
}

}  // namespace palpate::test
