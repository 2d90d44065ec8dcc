// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/tool_kind.h"

#include <utility>
#include <vector>

#include "base/error.h"

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

using ToolKinds = std::vector<std::unique_ptr<const ToolKind>>;

ToolKinds& kinds_of_tools() {
  static ToolKinds all = [] {
    ToolKinds built_in;
    built_in.push_back(std::make_unique<BondedKind>());
    built_in.push_back(std::make_unique<RigidKind>());
    return built_in;
  }();
  return all;
}

const ToolKind* find_tool_kind(InteractionKind number) {
  for (const auto& kind : kinds_of_tools()) {
    if (kind->number() == number) return kind.get();
  }
  return nullptr;
}

}  // namespace

const ToolKind& tool_kind(InteractionKind number) {
  if (const ToolKind* kind = find_tool_kind(number)) return *kind;
  throw InputError("A tool is of the unknown kind " + std::to_string(static_cast<int>(number)) +
                   ". The file was damaged, or made by a later version.");
}

void add_tool_kind(std::unique_ptr<const ToolKind> kind) {
  if (find_tool_kind(kind->number()) != nullptr) {
    throw InputError("There is a kind of tool with the number " +
                     std::to_string(static_cast<int>(kind->number())) + " already.");
  }
  kinds_of_tools().push_back(std::move(kind));
}

}  // namespace palpate
