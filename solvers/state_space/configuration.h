// SPDX-License-Identifier: BSD-3-Clause
// One configuration of a state space: an equilibrium of the body with the tool held at a
// check-point [P07, 3.2.3].
//
// [P07] Peterlík & Matyska, An Algorithm of State-Space Precomputation…, World Haptics 2007.
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <type_traits>
#include <vector>

#include "base/outcome.h"
#include "base/types.h"

namespace palpate {

/// A place on the grid of a tool's coordinates, in steps of the grid: (0,0,0) is rest.
using CheckPoint = std::array<std::int32_t, 3>;

/// The check-points around one, itself among them, by number: i slowest, k fastest.
inline constexpr int num_neighbours = 27;
[[nodiscard]] inline CheckPoint neighbour(const CheckPoint& p, int number) {
  return {p[0] + number / 9 - 1, p[1] + number / 3 % 3 - 1, p[2] + number % 3 - 1};
}
/// The check-point that is some steps away in the direction of a neighbour.
[[nodiscard]] inline CheckPoint neighbour(const CheckPoint& p, int number, std::int32_t steps) {
  const CheckPoint way = neighbour({}, number);
  return {p[0] + steps * way[0], p[1] + steps * way[1], p[2] + steps * way[2]};
}
/// The number of the neighbour of p in whose direction q lies, however far; −1: it lies in none.
[[nodiscard]] inline int neighbour_number(const CheckPoint& p, const CheckPoint& q) {
  std::int64_t steps = 0;
  for (int k = 0; k < 3; ++k) steps = std::max(steps, std::abs(std::int64_t{q[k]} - p[k]));
  int number = 0;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t way = std::int64_t{q[k]} - p[k];
    if (way != 0 && std::abs(way) != steps) return -1;
    number = 3 * number + (way > 0) - (way < 0) + 1;
  }
  return number;
}

/// Check-points from one to another, both of them inside.
struct CheckPointBox {
  CheckPoint first{};
  CheckPoint last{};

  [[nodiscard]] bool contains(const CheckPoint& p) const {
    for (int a = 0; a < 3; ++a) {
      if (p[a] < first[a] || p[a] > last[a]) return false;
    }
    return true;
  }
};

/// The square of the distance of two check-points, in steps of the grid.
[[nodiscard]] inline std::int64_t squared_distance(const CheckPoint& a, const CheckPoint& b) {
  std::int64_t sum = 0;
  for (int i = 0; i < 3; ++i) {
    const std::int64_t way = std::int64_t{a[i]} - b[i];
    sum += way * way;
  }
  return sum;
}

/// The largest number of levels of a check-point. Without this limit a body that is deformed beyond
/// what its law describes, and so finds ever more equilibria, would never be explored to the end.
inline constexpr std::int32_t kMostLevels = 64;

/// The levels reached by transitions to the neighbours of a check-point, by their numbers. Where
/// cells differ in size, the neighbour is the nearest check-point in its direction that is a corner
/// of a cell.
using Reached = std::array<std::int32_t, num_neighbours>;
/// These stand in place of a level where the transition was not tried, has failed, or has found a
/// configuration beyond the kMostLevels of its check-point.
inline constexpr std::int32_t not_tried = -2;
inline constexpr std::int32_t failed_to_reach = -1;
inline constexpr std::int32_t beyond_most_levels = -3;

/// ∂³Π/∂t³ in the order xxx, xxy, xxz, xyy, xyz, xzz, yyy, yyz, yzz, zzz [10], N/m².
using ThirdDerivative = Eigen::Matrix<double, 10, 1>;

/// What the size of the cells does to a configuration, as MeshErrorEstimator estimates it.
struct MeshError {
  /// The energy that a finer mesh would still release, not positive as a rule, J; NaN: it was not
  /// estimated.
  double energy = std::numeric_limits<double>::quiet_NaN();
  /// By how much the force of the configuration is too large [3], N: minus the gradient of energy.
  Vec3 force = Vec3::Zero();
  /// Whether the estimate may be trusted.
  bool is_reliable = false;

  [[nodiscard]] bool is_known() const { return std::isfinite(energy); }
};

/// A configuration without its fields.
struct ConfigurationSummary {
  CheckPoint check_point{};
  /// The number of this equilibrium among those at its check-point, from 0. Below zero the
  /// configuration is a candidate: a transition from a neighbour has found it, and it may turn out
  /// to be a known one, see candidate_level().
  std::int32_t level = 0;
  /// The configuration whose state was the start of the transition to this one; rest is its own
  /// parent.
  CheckPoint parent{};
  std::int32_t parent_level = 0;
  /// Coordinates of the tool t [3], m; for a bonded tool its displacement from rest.
  Vec3 t = Vec3::Zero();
  /// Potential energy at equilibrium Π, J.
  double energy = 0;
  /// Force that holds the tool, h = ∂Π/∂t [3], N.
  Vec3 force = Vec3::Zero();
  /// Haptic stiffness k = ∂h/∂t [3×3], symmetric, N/m.
  Mat3 stiffness = Mat3::Zero();
  /// T = ∂k/∂t; NaN where it was not computed.
  ThirdDerivative third_derivative =
      ThirdDerivative::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Of a tool that is turned, and touches something: the derivatives of Π by all its coordinates
  /// (all_derivatives.h). Else empty.
  std::vector<double> of_turns;
  Outcome outcome = Outcome::not_converged;
  Flags flags = 0;
  /// Largest nodal residual over the scene's force scale, without unit.
  double residual = 0;
  /// Least det F over quadrature points and vertices.
  double minimum_det_f = 1;
  std::int32_t negative_pivots = 0;
  std::int32_t iterations = 0;
  /// A signature that tells displacements apart: Σ s_n u_n / √num_points [3], s_n = ±1 at random,
  /// m. Between two states it differs by about the root mean square of the difference of u.
  Vec3 signature = Vec3::Zero();
  MeshError mesh_error;
  /// Where history matters, the level that the body is on after it was moved from here to each
  /// neighbour.
  Reached reached = filled_with_not_tried();
  /// Time that the transition took, s.
  double seconds = 0;

  /// Whether it may be interpolated: it has converged, and so has a force and a stiffness.
  [[nodiscard]] bool usable() const { return outcome == Outcome::converged; }
  /// Whether other configurations may be reached from it: it is usable and within the force limit.
  [[nodiscard]] bool leads_on() const {
    return usable() && (flags & flags::beyond_force_limit) == 0;
  }
  [[nodiscard]] bool has_third_derivative() const { return third_derivative.allFinite(); }
  /// Whether transitions between levels were made from here, or have led here.
  [[nodiscard]] bool has_history() const {
    return level != 0 || reached != filled_with_not_tried();
  }

 private:
  [[nodiscard]] static Reached filled_with_not_tried() {
    Reached reached;
    reached.fill(not_tried);
    return reached;
  }
};

/// The largest force of the configurations that lead on, N.
[[nodiscard]] inline double largest_force(const std::vector<ConfigurationSummary>& configurations) {
  double largest = 0;
  for (const ConfigurationSummary& c : configurations) {
    if (c.leads_on()) largest = std::max(largest, c.force.norm());
  }
  return largest;
}

/// An equilibrium on the way to a configuration, between its parent's displacement and its own
/// [P08]: more places at which the force is known.
struct IntermediateState {
  /// The check-point of the configuration.
  CheckPoint target{};
  /// Its number along the way, from 1.
  std::int32_t number = 1;
  /// Coordinates of the tool t [3], m; for a bonded tool its displacement from rest.
  Vec3 t = Vec3::Zero();
  /// Potential energy, J.
  double energy = 0;
  /// Force that holds the tool, N.
  Vec3 force = Vec3::Zero();
  Outcome outcome = Outcome::not_converged;
  Flags flags = 0;
  /// Time that the solve took, s.
  double seconds = 0;

  [[nodiscard]] bool usable() const { return outcome == Outcome::converged; }
};

/// The order in which intermediate states are kept: by target, then along the way.
[[nodiscard]] inline bool operator<(const IntermediateState& a, const IntermediateState& b) {
  return a.target != b.target ? a.target < b.target : a.number < b.number;
}

/// What a transition between neighbours has reached, where history matters.
struct LevelTransition {
  CheckPoint start{};
  std::int32_t start_level = 0;
  CheckPoint target{};
  /// Level at the target, failed_to_reach or beyond_most_levels.
  std::int32_t reached = failed_to_reach;
};

/// Calls visit for each number of a summary, in the order of the columns of the file. What
/// transitions have reached is not among them, nor is the error of the mesh, nor what belongs to
/// turns.
template <class Summary, class Visit>
void for_each_number_of_summary(Summary& c, Visit&& visit) {
  for (auto& x : c.check_point) visit(x);
  visit(c.level);
  for (auto& x : c.parent) visit(x);
  visit(c.parent_level);
  for (int a = 0; a < 3; ++a) visit(c.t[a]);
  visit(c.energy);
  for (int a = 0; a < 3; ++a) visit(c.force[a]);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) visit(c.stiffness(a, b));
  }
  visit(c.outcome);
  visit(c.flags);
  visit(c.residual);
  visit(c.minimum_det_f);
  visit(c.negative_pivots);
  visit(c.iterations);
  visit(c.seconds);
  for (int a = 0; a < 3; ++a) visit(c.signature[a]);
  visit(c.third_derivative);
}

/// Does the same for the error of the mesh.
template <class Error, class Visit>
void for_each_number_of_mesh_error(Error& error, Visit&& visit) {
  visit(error.energy);
  for (int a = 0; a < 3; ++a) visit(error.force[a]);
  visit(error.is_reliable);
}

/// Does the same for an intermediate state.
template <class State, class Visit>
void for_each_number_of_intermediate(State& state, Visit&& visit) {
  for (auto& x : state.target) visit(x);
  visit(state.number);
  for (int a = 0; a < 3; ++a) visit(state.t[a]);
  visit(state.energy);
  for (int a = 0; a < 3; ++a) visit(state.force[a]);
  visit(state.outcome);
  visit(state.flags);
  visit(state.seconds);
}

/// Does the same for a transition.
template <class Transition, class Visit>
void for_each_number_of_transition(Transition& transition, Visit&& visit) {
  for (auto& x : transition.start) visit(x);
  visit(transition.start_level);
  for (auto& x : transition.target) visit(x);
  visit(transition.reached);
}

/// The level that stands for what a transition from (start, start_level) has found at a neighbour,
/// until its level is known. It is below zero, and no other transition to that neighbour has it.
[[nodiscard]] inline std::int32_t candidate_level(const CheckPoint& start, std::int32_t start_level,
                                                  const CheckPoint& target) {
  return -1 - neighbour_number(target, start) - num_neighbours * start_level;
}

struct Configuration : ConfigurationSummary {
  /// Displacement u [3 × num_points], m; empty where only the summary was read, or the transition
  /// failed.
  Eigen::VectorXd u;
  /// Sensitivity v = ∂u/∂t [3 × num_points, 3]; empty as u is.
  Eigen::MatrixXd v;
  /// Pressures of mixed cells p [num_pressures], Pa, and ∂p/∂t [num_pressures, 3], Pa/m; empty as u
  /// is, and where no material of the scene is mixed.
  Eigen::VectorXd p;
  Eigen::MatrixXd p_v;
};

/// Calls visit for each field of a configuration, or of one that is reduced: u, v, p, p_v.
template <class Fields, class Visit>
void for_each_field(Fields& fields, Visit&& visit) {
  visit(fields.u);
  visit(fields.v);
  visit(fields.p);
  visit(fields.p_v);
}

/// The memory of the fields, bytes.
template <class Fields>
[[nodiscard]] std::size_t bytes_of_fields(const Fields& fields) {
  std::size_t bytes = 0;
  for_each_field(fields, [&](const auto& field) {
    using Number = typename std::decay_t<decltype(field)>::Scalar;
    bytes += static_cast<std::size_t>(field.size()) * sizeof(Number);
  });
  return bytes;
}

/// The order in which configurations are kept: by check-point, then level.
[[nodiscard]] inline bool operator<(const ConfigurationSummary& a, const ConfigurationSummary& b) {
  return a.check_point != b.check_point ? a.check_point < b.check_point : a.level < b.level;
}

/// The first configuration of a check-point, of a level or a higher one; the end of the list: there
/// is none.
/// @param configurations They are in the order of operator<.
template <class Configurations>
[[nodiscard]] auto find_level(Configurations& configurations, const CheckPoint& p,
                              std::int32_t level) {
  ConfigurationSummary sought;
  sought.check_point = p;
  sought.level = level;
  const auto found = std::lower_bound(
      configurations.begin(), configurations.end(), sought,
      [](const ConfigurationSummary& a, const ConfigurationSummary& b) { return a < b; });
  return found != configurations.end() && found->check_point == p ? found : configurations.end();
}

/// The nearest check-point in the direction of a neighbour that has a configuration, as cells have
/// sides of a power of two; p itself: there is none within kFarthestNeighbour steps.
/// @param configurations They are in the order of operator<.
inline constexpr std::int32_t kFarthestNeighbour = 64;
template <class Configurations>
[[nodiscard]] CheckPoint nearest_neighbour(const Configurations& configurations,
                                           const CheckPoint& p, int number) {
  for (std::int32_t steps = 1; steps <= kFarthestNeighbour; steps *= 2) {
    const CheckPoint q = neighbour(p, number, steps);
    if (find_level(configurations, q, 0) != configurations.end()) return q;
  }
  return p;
}

/// Notes at the start of a transition what it has reached, unless a check-point that was found
/// later lies between its ends.
/// @param configurations They are in the order of operator<.
template <class Configurations>
void note(const LevelTransition& transition, Configurations& configurations) {
  const auto start = find_level(configurations, transition.start, transition.start_level);
  if (start == configurations.end() || start->level != transition.start_level) return;
  const int number = neighbour_number(transition.start, transition.target);
  if (nearest_neighbour(configurations, transition.start, number) != transition.target) return;
  start->reached[number] = transition.reached;
}

}  // namespace palpate
