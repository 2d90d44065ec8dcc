// SPDX-License-Identifier: BSD-3-Clause
// The displacement of every point of the body, and the pressures of its mixed cells, at a
// displacement t of the active node. DisplayField does the same with modes of the surface; this
// class takes the fields in the space's file. A configuration that touches nothing has no fields:
// the body is at rest there.
#pragma once

#include <map>

#include "fields/field_source.h"
#include "interpolation/interpolator.h"
#include "interpolation/near_states.h"

namespace palpate {

/// Immutable. It copies all that it needs but the fields, so that the tool space need not outlive
/// it.
class BodyField {
 public:
  /// @throws InputError the tool space has no grid, see CheckPointGrid.
  explicit BodyField(const TouchToolSpace& tool_space)
      : BodyField(tool_space, CheckPointGrid(tool_space)) {}
  /// @param grid The grid of the tool space, such as that of an interpolator: it takes a while to
  ///   make the grid of a rigid tool.
  BodyField(const TouchToolSpace& tool_space, CheckPointGrid grid);

  /// @param fields The fields of the space, such as a FieldCache. Those that are needed at t are
  ///   read if they are not in memory.
  /// @param needed The points whose displacement is needed; that of other points may be zero.
  /// @param u Displacement [3 × num_points], m.
  /// @param p Pressures [num_pressures], Pa; empty if the body has none. Both u and p are empty if
  ///   the support is `none`, or if no configuration of the tool space touches the body.
  /// @param near Of the same tool space, as the force has them: where there is no cell, the
  ///   configurations around give the displacement too. Null: the nearest cell is continued.
  /// @throws InputError, BackendError as FieldSource::add_up.
  Support evaluate(const Vec3& t, FieldSource& fields, Keep needed, NodalVector& u, NodalVector& p,
                   const NearStates* near = nullptr) const;

 private:
  struct Weight {
    double a = 0;
    Vec3 d = Vec3::Zero();
  };
  /// Weights by configuration.
  using Weights = std::map<std::int32_t, Weight>;
  [[nodiscard]] bool touches(std::int32_t configuration) const;
  /// The weights at t, and how far they can be trusted.
  [[nodiscard]] Support find_weights(const Vec3& t, const NearStates* near, Weights& weights) const;
  /// Adds a u + v d of a node to the weights.
  void add_node(std::int32_t node, double a, const Vec3& d, Weights& weights) const;

  ToolSpaceSetup setup_;
  std::vector<ConfigurationSummary> configurations_;
  CheckPointGrid grid_;
  /// A configuration that has fields; −1: none has.
  std::int32_t any_touching_ = -1;
  /// Index into the hanging nodes, by node.
  std::map<std::int32_t, std::size_t> hanging_;
};

}  // namespace palpate
