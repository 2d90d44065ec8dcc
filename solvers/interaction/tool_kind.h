// SPDX-License-Identifier: BSD-3-Clause
// The meaning of the numbers of a stored tool (interaction_spec.h), for each kind of tool.
// Everything that depends on the kind is a function of this class, so that a new kind is one more
// class, and nothing else has to tell kinds apart.
#pragma once

#include <memory>
#include <string>

#include "interaction/interaction.h"
#include "interaction/interaction_spec.h"

namespace palpate {

class ToolKind {
 public:
  virtual ~ToolKind() = default;
  ToolKind(const ToolKind&) = delete;
  ToolKind& operator=(const ToolKind&) = delete;

  /// The number under which the kind is stored.
  [[nodiscard]] virtual InteractionKind number() const = 0;
  /// The name of a tool, for a message: "active node 8", "the sphere of radius 0.01 m".
  [[nodiscard]] virtual std::string name(const InteractionSpec& spec) const = 0;
  /// Whether the tool presses the body anywhere: its coordinates are then its own place, and there
  /// are places where it touches nothing. Other tools hold the body around one point, and their
  /// coordinates are how far that is displaced.
  [[nodiscard]] virtual bool presses() const = 0;
  /// Half of the width over which the tool touches the surface, m; 0: it is a point.
  [[nodiscard]] virtual double touching_radius(const InteractionSpec& spec) const = 0;
  /// The shape by which the tool is shown.
  [[nodiscard]] virtual RigidTool shown_shape(const InteractionSpec& spec) const = 0;

  /// Makes the tool.
  /// @param of The factory of the body, with the parts that it has made already.
  /// @throws InputError the tool cannot be on that body, see InteractionFactory::make().
  [[nodiscard]] virtual std::unique_ptr<Interaction> make(const InteractionSpec& spec,
                                                          InteractionFactory& of) const = 0;
  /// The places where the tool touches nothing; null: it acts wherever it is.
  [[nodiscard]] virtual std::shared_ptr<const ToolClearance> clearance(
      const InteractionSpec& /*spec*/, InteractionFactory& /*of*/) const {
    return nullptr;
  }

 protected:
  ToolKind() = default;
};

/// The kind with a number.
/// @throws InputError there is no such kind.
[[nodiscard]] const ToolKind& tool_kind(InteractionKind number);

/// Adds a kind for as long as the program runs. Call this before any tool of the kind is made.
/// @throws InputError its number is taken.
void add_tool_kind(std::unique_ptr<const ToolKind> kind);

}  // namespace palpate
