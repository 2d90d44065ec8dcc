// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/tool_kind.h"

#include <utility>

#include "interaction/kind_list.h"

namespace palpate {
namespace {

class BondedKind final : public ToolKind {
 public:
  BondedKind() = default;
  [[nodiscard]] InteractionKind number() const override { return InteractionKind::bonded_patch; }
  [[nodiscard]] std::string name(const InteractionSpec& spec) const override {
    return "active node " + std::to_string(spec.active_node);
  }
  [[nodiscard]] bool presses() const override { return false; }
  [[nodiscard]] double touching_radius(const InteractionSpec& spec) const override {
    return spec.tip_radius;
  }
  [[nodiscard]] RigidTool shown_shape(const InteractionSpec& spec) const override {
    RigidTool tip;
    tip.radius = spec.tip_radius;
    return tip;
  }
  [[nodiscard]] std::unique_ptr<Interaction> make(const InteractionSpec& spec,
                                                  InteractionFactory& of) const override {
    return of.patches(spec.tip_radius).around(spec.active_node).clone();
  }
};

class RigidKind final : public ToolKind {
 public:
  RigidKind() = default;
  [[nodiscard]] InteractionKind number() const override { return InteractionKind::rigid_contact; }
  [[nodiscard]] std::string name(const InteractionSpec& spec) const override {
    return name_of(spec.tool);
  }
  [[nodiscard]] bool presses() const override { return true; }
  [[nodiscard]] double touching_radius(const InteractionSpec& spec) const override {
    return half_width(spec.tool);
  }
  [[nodiscard]] RigidTool shown_shape(const InteractionSpec& spec) const override {
    return spec.tool;
  }
  [[nodiscard]] std::unique_ptr<Interaction> make(const InteractionSpec& spec,
                                                  InteractionFactory& of) const override {
    return of.contact(spec.tool).clone();
  }
  [[nodiscard]] std::shared_ptr<const ToolClearance> clearance(
      const InteractionSpec& spec, InteractionFactory& of) const override {
    return of.clearance_of(spec.tool);
  }
};

KindList<ToolKind>& kinds_of_tools() {
  static KindList<ToolKind> all("a kind of tool", "A tool is of the unknown kind",
                                std::make_unique<const BondedKind>(),
                                std::make_unique<const RigidKind>());
  return all;
}

}  // namespace

const ToolKind& tool_kind(InteractionKind number) { return kinds_of_tools().get(number); }

void add_tool_kind(std::unique_ptr<const ToolKind> kind) { kinds_of_tools().add(std::move(kind)); }

}  // namespace palpate
