// SPDX-License-Identifier: BSD-3-Clause
#include "storage/stored_kind.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "interaction/motion_kind.h"
#include "storage/rows.h"

namespace palpate::storage {
namespace {

/// Spacings that differ by less than this share are equal but for rounding.
constexpr double kSpacingRounding = 1e-12;

class Bonded : public StoredKind {
 public:
  [[nodiscard]] bool has_single_fields() const override { return false; }

  [[nodiscard]] bool is_possible(const ToolSpaceSetup& setup,
                                 std::int64_t num_points) const override {
    const InteractionSpec& tool = setup.interaction;
    // The number must be the active node, since what is touched is looked up by it.
    return tool.kind == InteractionKind::bonded_patch && setup.id == tool.active_node &&
           !setup.grid.sparse && tool.material_point.allFinite() && tool.active_node >= 0 &&
           tool.active_node < num_points && rows::is_length(tool.tip_radius);
  }

  [[nodiscard]] bool may_change_tolerance(double there, double asked) const override {
    return (there > 0) == (asked > 0);
  }

  [[nodiscard]] std::string describe(const ToolSpaceSetup& setup) const override {
    return "tip radius " + shortest(setup.interaction.tip_radius) + " m, half-width " +
           shortest(setup.grid.half_width) + " m";
  }

  [[nodiscard]] const char* what_may_change() const override {
    return "only the box may grow, by the same spacing, and force limit, tolerance and history may "
           "change";
  }
};

/// A rigid tool has many configurations, which are only displayed and used as starts of solves:
/// single precision is enough.
class Rigid : public StoredKind {
 public:
  [[nodiscard]] bool has_single_fields() const override { return true; }

  /// Whether a tool can be made of the numbers is only found when it is made.
  [[nodiscard]] bool is_possible(const ToolSpaceSetup& setup,
                                 std::int64_t /*num_points*/) const override {
    const RigidTool& tool = setup.interaction.tool;
    const auto num_points = static_cast<std::int64_t>(tool.points.size());
    return setup.id <= kContactToolSpace && setup.grid.sparse && tool.shape >= ToolShape::sphere &&
           tool.shape <= ToolShape::surface && rows::is_length(tool.radius) &&
           rows::is_length(tool.length) && tool.axis.allFinite() &&
           rows::is_length(tool.law.thickness) && rows::is_length(tool.law.stiffness) &&
           rows::is_length(tool.law.offset) &&
           std::all_of(tool.motion_numbers.begin(), tool.motion_numbers.end(),
                       [](double number) { return std::isfinite(number); }) &&
           std::all_of(tool.points.begin(), tool.points.end(),
                       [](const Vec3& p) { return p.allFinite(); }) &&
           std::all_of(tool.triangles.begin(), tool.triangles.end(), [&](const auto& triangle) {
             return std::all_of(triangle.begin(), triangle.end(),
                                [&](Index p) { return p >= 0 && p < num_points; });
           });
  }

  [[nodiscard]] bool may_change_tolerance(double /*there*/, double /*asked*/) const override {
    return true;
  }

  [[nodiscard]] std::string describe(const ToolSpaceSetup& setup) const override {
    const RigidTool& tool = setup.interaction.tool;
    const ContactLaw& law = tool.law;
    const Grid& grid = setup.grid;
    return "contact thickness " + shortest(law.thickness) + " m, contact stiffness " +
           shortest(law.stiffness) + " Pa, drawn back by " + shortest(law.offset) + " m, spacing " +
           shortest(grid.coarsest * grid.spacing()) + " m, depth " + shortest(setup.policy.depth) +
           " m, " + motion_kind(tool.motion).description(tool.motion_numbers);
  }

  [[nodiscard]] const char* what_may_change() const override {
    return "only depth, region, force limit and tolerance may change";
  }
};

const StoredKind& kind(bool is_rigid) {
  static const Bonded bonded;
  static const Rigid rigid;
  return is_rigid ? static_cast<const StoredKind&>(rigid) : bonded;
}

}  // namespace

const StoredKind& kind_of(const ToolSpaceSetup& setup) { return kind(setup.presses()); }

const StoredKind& kind_of(ToolSpaceId id) { return kind(id <= kContactToolSpace); }

std::string figures_of(const ToolSpaceSetup& setup) {
  const Grid& grid = setup.grid;
  const ExplorationPolicy& policy = setup.policy;
  return kind_of(setup).describe(setup) + ", resolution " + std::to_string(grid.resolution) +
         ", coarsest cells of side " + std::to_string(grid.coarsest) + ", force limit " +
         shortest(policy.force_limit) + " N, tolerance " + shortest(policy.tolerance) +
         (policy.tolerance_is_relative ? " of the largest force" : " N") + ", " +
         std::to_string(policy.intermediate_states) + " intermediate states, " +
         (policy.third_derivatives ? "third derivatives" : "no third derivatives");
}

std::string number_of(const ToolSpaceKey& key) {
  return "tool space " + std::to_string(key.id) +
         (key.body == kFirstBody ? "" : " of body " + std::to_string(key.body));
}

bool may_become(const ToolSpaceSetup& there, const ToolSpaceSetup& asked) {
  const double spacing = there.grid.spacing();
  return there.interaction == asked.interaction && there.grid.coarsest == asked.grid.coarsest &&
         there.grid.origin == asked.grid.origin && there.region == asked.region &&
         std::abs(spacing - asked.grid.spacing()) <= kSpacingRounding * spacing &&
         kind_of(there).may_change_tolerance(there.policy.tolerance, asked.policy.tolerance) &&
         there.policy.intermediate_states == asked.policy.intermediate_states &&
         there.policy.third_derivatives == asked.policy.third_derivatives &&
         asked.grid.resolution >= there.grid.resolution;
}

std::string shortest(double value) {
  for (int digits = 6;; ++digits) {
    std::ostringstream text;
    text.precision(digits);
    text << value;
    if (digits == 17 || std::strtod(text.str().c_str(), nullptr) == value) return text.str();
  }
}

}  // namespace palpate::storage
