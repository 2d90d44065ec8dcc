// SPDX-License-Identifier: BSD-3-Clause
// The displacement of every point of the body, and the pressures of its mixed cells, that answer a
// displacement t of the active node: as DisplayField, but from the fields in the space's file in
// place of the modes of the surface. A configuration that touches nothing has no fields: the body
// is at rest there.
#pragma once

#include <map>

#include "interpolation/interpolator.h"
#include "state_space/field_cache.h"

namespace palpate {

/// Immutable, and holds all it needs but the fields: the tool space may go.
class BodyField {
 public:
  /// @throws InputError the tool space has no grid, see CheckPointGrid.
  explicit BodyField(const TouchToolSpace& tool_space)
      : BodyField(tool_space, CheckPointGrid(tool_space)) {}
  /// @param grid Of the tool space, as an interpolator has it: it takes a while to make that of a
  ///   rigid tool.
  BodyField(const TouchToolSpace& tool_space, CheckPointGrid grid);

  /// @param fields Of the file of the space; what is needed at t is read, if it is not there.
  /// @param needed The points whose displacement is needed; that of others may be zero.
  /// @param u Displacement [3 × num_points], m. @param p Pressures [num_pressures], Pa; empty for a
  ///   body without. Both are empty where nothing is found,
  ///   or where no configuration of the tool space touches the body.
  /// @throws InputError, BackendError as FieldCache::add_up.
  Support evaluate(const Vec3& t, FieldCache& fields, Keep needed, NodalVector& u,
                   NodalVector& p) const;

 private:
  struct Weight {
    double a = 0;
    Vec3 d = Vec3::Zero();
  };
  /// By configuration.
  using Weights = std::map<std::int32_t, Weight>;
  [[nodiscard]] bool touches(std::int32_t configuration) const;
  /// Adds a u + v d of a node.
  void add_node(std::int32_t node, double a, const Vec3& d, Weights& weights) const;

  ToolSpaceSetup setup_;
  std::vector<ConfigurationSummary> configurations_;
  CheckPointGrid grid_;
  /// A configuration that has fields; −1: there is none.
  std::int32_t any_touching_ = -1;
  /// Place among the hanging nodes, by node.
  std::map<std::int32_t, std::size_t> hanging_;
};

}  // namespace palpate
