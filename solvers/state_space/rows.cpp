// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/rows.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <type_traits>

namespace palpate::rows {
namespace {

/// Gathers numbers as they are checked, 8 bytes each.
struct Gather {
  std::vector<std::int64_t>& bits;
  void operator()(double x) const {
    std::int64_t of_x = -1;  // any NaN: the file has only one
    if (!std::isnan(x)) std::memcpy(&of_x, &x, sizeof of_x);
    bits.push_back(of_x);
  }
  template <class Integer>
  void operator()(Integer x) const {
    bits.push_back(static_cast<std::int64_t>(x));
  }
  void operator()(const ThirdDerivative& x) const {
    if (!x.allFinite()) return;
    for (const double component : x) (*this)(component);
  }
};

std::int64_t checksum_of(const std::vector<std::int64_t>& bits) {
  return static_cast<std::int64_t>(XXH3_64bits(bits.data(), bits.size() * sizeof bits[0]));
}

std::int64_t checksum_of(const void* data, std::size_t bytes, std::int64_t seed) {
  return static_cast<std::int64_t>(
      XXH3_64bits_withSeed(data, bytes, static_cast<XXH64_hash_t>(seed)));
}

/// How far a configuration may lie from its check-point, in spacings, for rounding.
constexpr double kOffCheckPoint = 1e-4;

bool is_possible(Outcome outcome) {
  return outcome >= Outcome::converged && outcome <= Outcome::invalid_scene;
}

bool is_possible(Flags of_solve) { return (of_solve & ~flags::all) == 0; }

bool is_in_box(const Site& site, const CheckPoint& c) {
  return std::all_of(c.begin(), c.end(),
                     [&](std::int32_t x) { return x >= -site.reach() && x <= site.reach(); });
}

bool is_length(double x) { return std::isfinite(x) && x >= 0; }

}  // namespace

Fields fields_of(const Configuration& configuration) {
  Fields fields;
  auto next = fields.begin();
  for_each_field(configuration, [&](const auto& field) {
    const auto size = static_cast<std::size_t>(field.size());
    *next++ = {size == 0 ? nullptr : field.data(), size * sizeof(double)};
  });
  return fields;
}

std::int64_t checksum(const Fields& fields) {
  std::int64_t sum = 0;
  for (const auto& [data, bytes] : fields) sum = checksum_of(data, bytes, sum);
  return sum;
}

std::int64_t checksum(const SiteSpace& space) {
  std::vector<std::int64_t> bits;
  for_each_number_of_site(space, Gather{bits});
  return checksum_of(bits);
}

std::int64_t checksum(Index active_node, ConfigurationSummary summary, std::int64_t of_fields,
                      Checked checked) {
  if (checked == Checked::as_version_5) summary.flags &= ~flags::beyond_force_limit;
  std::vector<std::int64_t> bits{active_node};
  for_each_number_of_summary(summary, Gather{bits});
  if (checked == Checked::all) bits.push_back(of_fields);
  return checksum_of(bits);
}

std::int64_t checksum(Index active_node, const LevelTransition& transition) {
  std::vector<std::int64_t> bits{active_node};
  for_each_number_of_transition(transition, Gather{bits});
  return checksum_of(bits);
}

std::int64_t checksum(Index active_node, IntermediateState state, Checked checked) {
  if (checked == Checked::as_version_5) state.flags &= ~flags::beyond_force_limit;
  std::vector<std::int64_t> bits{active_node};
  for_each_number_of_intermediate(state, Gather{bits});
  return checksum_of(bits);
}

std::int64_t checksum(const TestSet& set, const TestPoint& point) {
  std::vector<std::int64_t> bits{set.active_node, set.seed};
  Gather{bits}(set.tip_radius);
  Gather{bits}(set.half_width);
  for_each_number_of_test_point(point, Gather{bits});
  return checksum_of(point.displacement.data(),
                     static_cast<std::size_t>(point.displacement.size()) * sizeof(float),
                     checksum_of(bits));
}

std::int64_t checksum(const std::vector<char>& touchable, double solver_tolerance) {
  std::vector<std::int64_t> bits;
  Gather{bits}(solver_tolerance);
  return checksum_of(touchable.data(), touchable.size(), checksum_of(bits));
}

bool is_possible(const Site& site, std::int64_t num_points) {
  return site.active_node >= 0 && site.active_node < num_points && is_length(site.tip_radius) &&
         is_length(site.half_width) && is_length(site.force_limit) && is_length(site.tolerance) &&
         site.resolution >= 1 && site.resolution % 2 == 1 &&
         site.resolution <= kLargestResolution && (site.half_width > 0 || site.resolution == 1) &&
         site.coarsest >= 1 && (site.coarsest & (site.coarsest - 1)) == 0 &&
         site.reach() % site.coarsest == 0 &&
         site.coarsest_resolution() <= kLargestCoarsestResolution &&
         site.history >= History::flat && site.history <= History::levels &&
         site.intermediate_states >= 0 && site.intermediate_states <= kMostIntermediateStates;
}

bool is_possible(const Site& site, const ConfigurationSummary& c) {
  if (!is_in_box(site, c.check_point) || !is_in_box(site, c.parent) || c.parent_level < 0 ||
      !is_possible(c.outcome) || !is_possible(c.flags)) {
    return false;
  }
  const Vec3 place = site.spacing() * Vec3(c.check_point[0], c.check_point[1], c.check_point[2]);
  return !c.usable() || (c.t - place).norm() <= kOffCheckPoint * site.spacing();
}

bool is_possible(const Site& site, const LevelTransition& transition) {
  return is_in_box(site, transition.start) && is_in_box(site, transition.target) &&
         neighbour_number(transition.start, transition.target) >= 0 &&
         transition.start_level >= 0 &&
         (transition.reached >= failed_to_reach || transition.reached == beyond_most_levels);
}

bool is_possible(const Site& site, const IntermediateState& state) {
  return is_in_box(site, state.target) && state.number >= 1 &&
         state.number <= kMostIntermediateStates && is_possible(state.outcome) &&
         is_possible(state.flags);
}

bool is_possible(const TestPoint& point) {
  return point.kind >= TestKind::uniform && point.kind <= TestKind::near_rest &&
         point.number >= 0 && is_possible(point.outcome) && is_possible(point.flags);
}

bool fit(const Fields& fields, std::int64_t num_points, std::int64_t num_cells) {
  const auto& [u, v, p, p_v] = fields;
  const std::size_t of_points = static_cast<std::size_t>(num_points) * 3 * sizeof(double);
  // A mixed cell has a pressure at each of its corners, and may share them.
  const std::size_t most_of_pressures = static_cast<std::size_t>(num_cells) * 4 * sizeof(double);
  return (u.bytes == 0 || u.bytes == of_points) && (v.bytes == 0 || v.bytes == 3 * of_points) &&
         p.bytes % sizeof(double) == 0 && p.bytes <= most_of_pressures && p_v.bytes == 3 * p.bytes;
}

std::string describe(const CheckPoint& c) {
  return '(' + std::to_string(c[0]) + ", " + std::to_string(c[1]) + ", " + std::to_string(c[2]) +
         ')';
}

std::string describe(const ConfigurationSummary& summary, Index active_node) {
  return "configuration " + describe(summary.check_point) +
         (summary.level != 0 ? " of level " + std::to_string(summary.level) : "") +
         " of active node " + std::to_string(active_node);
}

std::string describe(const LevelTransition& transition, Index active_node) {
  return "transition from " + describe(transition.start) + " of level " +
         std::to_string(transition.start_level) + " to " + describe(transition.target) +
         " of active node " + std::to_string(active_node);
}

std::string describe(const IntermediateState& state, Index active_node) {
  return "intermediate state " + std::to_string(state.number) + " on the way to " +
         describe(state.target) + " of active node " + std::to_string(active_node);
}

std::string describe(const TestPoint& point, Index active_node) {
  return "test point " + std::to_string(point.number) + " of active node " +
         std::to_string(active_node);
}

}  // namespace palpate::rows
