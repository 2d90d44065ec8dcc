// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/turned_force.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "interpolation/hermite_data.h"
#include "state_space/all_derivatives.h"

namespace palpate {
namespace {

constexpr int kHighest = 3;
/// A share of a step that is rounding.
constexpr double kOnGrid = 1e-6;

/// B_a of the quintic basis at one end of [0, 1], and its derivative.
struct Basis {
  double value = 0, slope = 0;
};
Basis basis(int order, bool at_end, double s) noexcept {
  // That of the end is that of the beginning in the mirror.
  const double x = at_end ? 1 - s : s;
  const double x2 = x * x, x3 = x2 * x;
  Basis b;
  switch (order) {
    case 0: b = {1 + x3 * (-10 + x * (15 - 6 * x)), x2 * (-30 + x * (60 - 30 * x))}; break;
    case 1: b = {x + x3 * (-6 + x * (8 - 3 * x)), 1 + x2 * (-18 + x * (32 - 15 * x))}; break;
    default:
      b = {x2 * (0.5 + x * (-1.5 + x * (1.5 - 0.5 * x))), x * (1 + x * (-4.5 + x * (6 - 2.5 * x)))};
  }
  if (!at_end) return b;
  return order == 1 ? Basis{-b.value, b.slope} : Basis{b.value, -b.slope};
}

/// The configuration whose energy is a derivative by the angles, as far as its derivatives by the
/// place are known.
/// @param by The coordinates by which it is derived. @param d Their number.
ConfigurationSummary derived(const ConfigurationSummary& c, const std::vector<std::size_t>& by,
                             std::size_t d) {
  ConfigurationSummary result = c;
  result.mesh_error = {};
  result.third_derivative.setConstant(std::numeric_limits<double>::quiet_NaN());
  result.energy = 0;
  result.force.setZero();
  result.stiffness.setZero();
  if (c.of_turns.size() != AllDerivatives::count(d)) return result;
  const AllDerivatives all(c.of_turns, d);
  if (by.size() == 1) {
    result.energy = all.by(by[0]);
    for (int i = 0; i < 3; ++i) {
      result.force[i] = all.by(by[0], i);
      for (int j = 0; j < 3; ++j) result.stiffness(i, j) = all.by(by[0], i, j);
    }
  } else if (by.size() == 2) {
    result.energy = all.by(by[0], by[1]);
    for (int i = 0; i < 3; ++i) result.force[i] = all.by(by[0], by[1], i);
  } else {
    result.energy = all.by(by[0], by[1], by[2]);
  }
  return result;
}

/// A configuration that presses and lacks its derivatives by the angles is not used.
bool lacks_turns(const ConfigurationSummary& c, std::size_t d) {
  return c.usable() && (c.flags & flags::touches_nothing) == 0 &&
         c.of_turns.size() != AllDerivatives::count(d);
}

}  // namespace

TurnedForce::TurnedForce(const std::vector<const TouchToolSpace*>& tool_spaces,
                         const InterpolationOptions& options)
    : kernel_(best_hermite_kernel()) {
  std::vector<Turning> turns;
  for (const TouchToolSpace* space : tool_spaces) {
    turns.push_back(Turning::from(space->setup.interaction.tool.motion_numbers));
  }
  if (turns.empty()) throw InputError("There is no space of a tool that is turned.");
  turning_ = turns.front();
  turning_.angles.setZero();
  // The grid: its step is the least distance from the middle, its size the largest.
  double farthest = 0;
  step_ = std::numeric_limits<double>::infinity();
  for (const Turning& turning : turns) {
    for (const double angle : turning.angles) {
      farthest = std::max(farthest, std::abs(angle));
      if (angle != 0) step_ = std::min(step_, std::abs(angle));
    }
  }
  const int reach = std::isinf(step_) ? 0 : static_cast<int>(std::lround(farthest / step_));
  size_ = 2 * reach + 1;
  last_size_ = turning_.num_angles() == 3 ? size_ : 1;
  corner_at_.assign(static_cast<std::size_t>(size_ * size_ * last_size_), -1);
  for (std::size_t k = 0; k < turns.size(); ++k) {
    Orders numbers{};
    bool is_on_grid = reach > 0;
    for (int i = 0; i < turning_.num_angles(); ++i) {
      const double number = turns[k].angles[i] / step_;
      numbers[i] = static_cast<int>(std::lround(number)) + reach;
      is_on_grid = is_on_grid && std::abs(number + reach - numbers[i]) < kOnGrid;
    }
    if (!is_on_grid || corner_at_[index(numbers)] >= 0) {
      throw InputError("The spaces of " + tool_spaces[k]->setup.name() +
                       " are not those of a grid of orientations. The file was damaged, or not "
                       "all of it was read.");
    }
    corner_at_[index(numbers)] = static_cast<int>(corners_.size());
    corners_.push_back(make_corner(*tool_spaces[k], options));
  }
}

TurnedForce::Corner TurnedForce::make_corner(const TouchToolSpace& tool_space,
                                             const InterpolationOptions& options) const {
  const int num_angles = turning_.num_angles();
  const auto d = static_cast<std::size_t>(3 + num_angles);
  TouchToolSpace used = tool_space;
  for (ConfigurationSummary& c : used.configurations) {
    if (lacks_turns(c, d)) c.outcome = Outcome::not_converged;
  }
  Corner corner;
  corner.energy = make_interpolator(Method::energy_hermite, used, options);
  const CheckPointGrid& grid = corner.energy->grid();
  const int last = num_angles == 3 ? 2 : 0;
  for (int i = 0; i <= 2; ++i) {
    for (int j = 0; j <= 2; ++j) {
      for (int k = 0; k <= last; ++k) {
        const int total = i + j + k;
        if (total == 0 || total > kHighest) continue;
        std::vector<std::size_t> by;
        by.insert(by.end(), static_cast<std::size_t>(i), 3);
        by.insert(by.end(), static_cast<std::size_t>(j), 4);
        by.insert(by.end(), static_cast<std::size_t>(k), 5);
        std::vector<ConfigurationSummary> of;
        of.reserve(used.configurations.size());
        // In units of one step of the grid of orientations.
        const double scale = std::pow(turning_.lever * step_, total);
        for (const ConfigurationSummary& c : used.configurations) {
          of.push_back(derived(c, by, d));
          of.back().energy *= scale;
          of.back().force *= scale;
          of.back().stiffness *= scale;
        }
        HermiteDataOptions data;
        data.known = kHighest - total;
        data.third_derivatives = false;
        corner.fields.push_back({{i, j, k}, hermite_data(grid, of, data)});
      }
    }
  }
  return corner;
}

TurnedForce::Place TurnedForce::locate(const Vec3& theta) const noexcept {
  Place at;
  // Beyond the largest angle the tool is held at it.
  const double turned = theta.norm();
  at.is_beyond = turned > turning_.farthest;
  at.angles = at.is_beyond ? Vec3(turning_.farthest / turned * theta) : theta;
  for (int i = 0; i < turning_.num_angles(); ++i) {
    const double number = at.angles[i] / step_ + (size_ - 1) / 2;
    at.first[i] = std::clamp(static_cast<int>(std::floor(number)), 0, size_ - 2);
    at.s[i] = std::clamp(number - at.first[i], 0.0, 1.0);
  }
  return at;
}

std::pair<int, std::array<bool, 3>> TurnedForce::corner_of(const Place& at,
                                                           int number) const noexcept {
  Orders numbers{};
  std::array<bool, 3> ends{};
  for (int i = 0; i < turning_.num_angles(); ++i) {
    ends[i] = (number >> i & 1) != 0;
    numbers[i] = at.first[i] + (ends[i] ? 1 : 0);
  }
  return {corner_at_[index(numbers)], ends};
}

TurnedTouch TurnedForce::evaluate(const Vec3& place, const Vec3& theta) const noexcept {
  TurnedTouch result;
  if (!place.allFinite() || !theta.allFinite()) return result;
  const int num_angles = turning_.num_angles();
  const Place in_grid = locate(theta);
  // Of each angle: order, end.
  Basis bases[3][3][2];
  for (int i = 0; i < num_angles; ++i) {
    for (int order = 0; order <= 2; ++order) {
      for (const bool end : {false, true}) bases[i][order][end] = basis(order, end, in_grid.s[i]);
    }
  }
  static_cast<TouchResult&>(result) = TouchResult::empty_sum();
  Vec3 by_angle = Vec3::Zero();
  for (int number = 0; number < 1 << num_angles; ++number) {
    const auto [corner_number, ends] = corner_of(in_grid, number);
    if (corner_number < 0) return {};
    const Corner& corner = corners_[static_cast<std::size_t>(corner_number)];
    // The weight of a derivative by the angles, and how that changes with them.
    double weight = 1;
    Vec3 change = Vec3::Zero();
    const auto weigh = [&, &ends = ends](const Orders& orders) {
      weight = 1;
      for (int i = 0; i < num_angles; ++i) weight *= bases[i][orders[i]][ends[i]].value;
      for (int i = 0; i < num_angles; ++i) {
        change[i] = bases[i][orders[i]][ends[i]].slope / step_;
        for (int j = 0; j < num_angles; ++j) {
          if (j != i) change[i] *= bases[j][orders[j]][ends[j]].value;
        }
      }
    };
    weigh({});
    const TouchResult of_energy = corner.energy->evaluate(place);
    if (of_energy.support == Support::none) return {};
    result.add(weight, of_energy);
    by_angle += of_energy.energy * change;
    const Interpolator::Location location = corner.energy->locate(place);
    if (location.place != CheckPointGrid::Place::cell &&
        location.place != CheckPointGrid::Place::beside_cell) {
      continue;
    }
    const CellTree::Leaf& leaf = corner.energy->grid().leaf(location.leaf);
    const double per_side = 1 / (leaf.cell.side * corner.energy->spacing());
    for (const Field& field : corner.fields) {
      HermiteJet jet;
      kernel_(field.nodes.data(), leaf, location.s, jet);
      const Vec3 slope = per_side * Vec3(jet[1], jet[2], jet[3]);
      const double value = jet[0] + slope.dot(location.offset);
      weigh(field.orders);
      result.energy += weight * value;
      result.force += weight * slope;
      const double per_side2 = per_side * per_side;
      Mat3 bend;
      bend << jet[4], jet[7], jet[8], jet[7], jet[5], jet[9], jet[8], jet[9], jet[6];
      result.stiffness += weight * per_side2 * bend;
      by_angle += value * change;
    }
  }
  result.torque = turning_.torque(in_grid.angles, by_angle);
  if (in_grid.is_beyond) result.support = less_certain(result.support, Support::extrapolated);
  if (!std::isfinite(result.energy) || !result.force.allFinite() || !result.torque.allFinite()) {
    return {};
  }
  return result;
}

void TurnedForce::add_memory(MemoryRanges& ranges) const {
  ranges.push_back({this, sizeof *this});
  palpate::add_memory(corners_, ranges);
  palpate::add_memory(corner_at_, ranges);
  for (const Corner& corner : corners_) {
    corner.energy->add_memory(ranges);
    palpate::add_memory(corner.fields, ranges);
    for (const Field& field : corner.fields) palpate::add_memory(field.nodes, ranges);
  }
}

}  // namespace palpate
