// SPDX-License-Identifier: BSD-3-Clause
// The part of a state space that touching needs: the surface alone, its displacement by a few
// modes, and of each configuration what interpolation needs. That is a few hundred bytes a
// configuration.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "state_space/state_space.h"
#include "state_space/surface.h"

namespace palpate {

class StateSpaceFile;

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
  /// c of the surface displacement u ≈ modes · c [r × num_configurations], m; 0 where a
  /// configuration is not usable.
  Eigen::MatrixXf coefficients;
  /// Gradient of c [3r × num_configurations], without unit: ∂c/∂t_x, then ∂c/∂t_y, then ∂c/∂t_z.
  Eigen::MatrixXf coefficient_gradients;
};

/// Gives the tool space of a rigid tool its clearance; one that is bonded has none.
/// @throws InputError a tool that is none, see make_contact() and ToolClearance.
void add_clearance(const Scene& scene, TouchToolSpace& tool_space);

struct TouchSpace {
  std::string scene_hash;
  /// The file that has the fields; empty: there is none.
  std::string file;
  Surface surface;
  /// Orthonormal modes of the surface displacement [3 × surface.num_points() × r], see pod.h.
  Eigen::MatrixXf modes;
  /// The tool spaces in the order of their numbers.
  std::vector<TouchToolSpace> tool_spaces;
  /// What is damaged in the file, and so is missing here, see StateSpaceFile::left_out().
  std::vector<std::string> left_out;

  /// Largest displacement of a surface point in any usable configuration, m.
  double largest_displacement = 0;
  /// Largest error that the modes make in u at any surface point of any usable configuration, m.
  double displacement_error = 0;
  /// The same error of spacing · ∂u/∂t, m.
  double sensitivity_error = 0;

  [[nodiscard]] Index num_modes() const { return static_cast<Index>(modes.cols()); }
  /// The tool space at an active node, or nullptr.
  [[nodiscard]] const TouchToolSpace* find(ToolSpaceId id) const;
};

/// The default bound of a surface point's error, as a share of the largest displacement.
inline constexpr double kDefaultTouchBound = 1e-3;

/// Makes the touch space of a state space.
/// @param space It has u and v of every usable configuration.
/// @throws InputError u or v is missing or not finite, or the bound is out of range, see PodBasis.
[[nodiscard]] TouchSpace make_touch_space(const StateSpace& space,
                                          double bound = kDefaultTouchBound);

/// Does the same from a file, with the fields of one configuration in memory at a time.
/// Configurations whose fields are damaged or not finite are left out.
[[nodiscard]] TouchSpace make_touch_space(const StateSpaceFile& file,
                                          double bound = kDefaultTouchBound);

/// Does the same without modes, for a program that feels and does not show: no field is read.
[[nodiscard]] TouchSpace make_touch_space_without_modes(const StateSpaceFile& file);

}  // namespace palpate
