// SPDX-License-Identifier: BSD-3-Clause
// The part of a state space that touching needs: the surface alone, its displacement by a few
// modes, and of each configuration what interpolation needs. That is a few hundred bytes a
// configuration.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "state_space/space_body.h"
#include "state_space/space_hash.h"
#include "state_space/state_space.h"
#include "state_space/surface.h"

namespace palpate {

class ShownSurface;
class ToolClearance;

/// How far the tool at coordinates q [3], m, may be moved in any direction without touching the
/// body at rest, at the least, m; not positive: it may touch it there. Empty: it always acts.
using Clearance = std::function<double(const Vec3& q)>;

struct TouchToolSpace {
  ToolSpaceSetup setup;
  Clearance clearance;
  /// All configurations without their fields, in the order of operator<.
  std::vector<ConfigurationSummary> configurations;
  /// These are in the order of operator<; empty where the tool space has none.
  std::vector<IntermediateState> intermediate_states;
  /// Modes of the surface displacement [3 × surface points, r], see fields/reduced_fields.h; the
  /// tool space of a rigid tool has none here.
  Eigen::MatrixXf modes;
  /// c of the surface displacement u ≈ modes · c [r × num_configurations], m; 0 where a
  /// configuration is not usable.
  Eigen::MatrixXf coefficients;
  /// Gradient of c [3r × num_configurations], without unit: ∂c/∂t_x, then ∂c/∂t_y, then ∂c/∂t_z.
  Eigen::MatrixXf coefficient_gradients;
};

/// Gives the tool space of a rigid tool its clearance. If a configuration has no force although the
/// tool is in the body at rest, the tool has gone through the surface. Earlier versions took such a
/// configuration for converged; here its outcome becomes Outcome::tool_inside.
void add_clearance(std::shared_ptr<const ToolClearance> clearance, TouchToolSpace& tool_space);

/// A stage of the cut of an organ, which is one of the bodies of a space.
struct StageOfCut {
  BodyId body = kFirstBody;
  /// The area of the cut that is open, m².
  double area = 0;
};

struct TouchSpace {
  /// The result of join_hashes() for its bodies.
  std::string scene_hash;
  /// The file that has the fields; empty: there is none.
  std::string file;
  /// The surface at rest that is shown and touched, from which displacements count: that of the
  /// first body. Modes of other bodies are carried over to it, see shown_surface.h.
  Surface surface;
  /// The stages of the cut, from the closed one on; empty: there is no cut that opens.
  std::vector<StageOfCut> stages;
  /// The tool spaces in the order of their keys.
  std::vector<TouchToolSpace> tool_spaces;
  /// What is damaged in the file, and so is missing here, see StateSpaceFile::left_out().
  std::vector<std::string> left_out;

  /// Largest displacement of a surface point in any usable configuration, m.
  double largest_displacement = 0;
  /// Largest error that the modes make in u at any surface point of any usable configuration, m.
  double displacement_error = 0;
  /// The same error of spacing · ∂u/∂t, m.
  double sensitivity_error = 0;

  /// The tool space with a key, or nullptr.
  [[nodiscard]] const TouchToolSpace* find(const ToolSpaceKey& key) const;
  /// The areas of the stages, m².
  [[nodiscard]] std::vector<double> areas_of_stages() const;
  /// The tool spaces with a number at all stages; empty: there is no cut, or one is missing.
  [[nodiscard]] std::vector<const TouchToolSpace*> find_stages(ToolSpaceId id) const;
  /// The tool spaces whose tool presses the body anywhere: none, one, or one for each region of
  /// the organ of which something was found. A space may have others besides: the first one by its
  /// key that is for the whole organ is taken alone. Those of a tool that is turned are not among
  /// them.
  [[nodiscard]] std::vector<const TouchToolSpace*> list_pressing() const;
  /// The tool spaces of a tool that is turned, one for each orientation of a grid (turned_force.h);
  /// empty: there is no such tool.
  [[nodiscard]] std::vector<const TouchToolSpace*> list_turned() const;
  /// The first of those that press, for what they have in common, the tool among it; nullptr: there
  /// is none.
  [[nodiscard]] const TouchToolSpace* find_pressing() const;
  /// Whether a tool space stands on another body than the first.
  [[nodiscard]] bool has_other_bodies() const;
};

/// Gives the tool spaces of rigid tools their clearance; bonded tools have none.
/// @param bodies Those on which they stand.
/// @throws InputError the tool is not valid, see make_contact() and ToolClearance.
void add_clearances(const std::vector<SpaceBody>& bodies, TouchSpace& space);

/// The touch space of the bodies that carry a surface, without tool spaces yet.
[[nodiscard]] TouchSpace make_empty_touch_space(const ShownSurface& shown);

}  // namespace palpate
