// SPDX-License-Identifier: BSD-3-Clause
// An interface to the fields of single configurations, which are needed for the whole body while it
// is touched. The fields are in a file, but the code that interpolates knows this interface alone.
#pragma once

#include <vector>

#include "base/types.h"
#include "fields/reduced_fields.h"
#include "state_space/tool_space.h"

namespace palpate {

/// The share of a configuration in a field: a u + v d.
struct FieldShare {
  ConfigurationSummary configuration;
  double a = 0;
  /// m.
  Vec3 d = Vec3::Zero();
};

/// Adds the share of a configuration whose fields are whole to those of others.
/// @param p Empty as long as none was added that has pressures.
inline void add_share(const FieldShare& share, const Configuration& whole, NodalVector& u,
                      NodalVector& p) {
  u += share.a * whole.u + whole.v * share.d;
  if (p.size() == 0) p.setZero(whole.p.size());
  if (p.size() > 0) p += share.a * whole.p + whole.p_v * share.d;
}

class FieldSource {
 public:
  virtual ~FieldSource() = default;

  /// Adds up shares of the fields of a tool space's configurations, counted from the body at rest
  /// (SpaceBody::at_rest).
  /// @param needed The points whose displacement is needed; that of others may be zero.
  /// @param u Displacement [3 × num_points], m. @param p Pressures [num_pressures], Pa; empty for a
  ///   body without, and where they are not needed.
  /// @throws InputError, BackendError the fields are missing, or less of them is kept than is
  ///   needed.
  virtual void add_up(const ToolSpaceSetup& setup, const std::vector<FieldShare>& shares,
                      Keep needed, NodalVector& u, NodalVector& p) = 0;
};

}  // namespace palpate
