// SPDX-License-Identifier: BSD-3-Clause
// What of a state space is carried for touching: the surface alone, its displacement by a few
// modes, and of each configuration what interpolation needs. A few hundred bytes a configuration.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "state_space/state_space.h"
#include "state_space/surface.h"

namespace palpate {

class StateSpaceFile;

struct TouchSite {
  Site site;
  /// Position of the active node at rest, m.
  Vec3 rest_position = Vec3::Zero();
  /// Everything but the fields, in the order of operator<.
  std::vector<ConfigurationSummary> configurations;
  /// By target, then number; empty where the site has none.
  std::vector<IntermediateState> intermediate_states;
  /// Surface displacement u ≈ modes · c [r × num_configurations], m; 0 where it is not usable.
  Eigen::MatrixXf coefficients;
  /// Its gradient [3r × num_configurations], without unit: ∂c/∂t_x, then ∂c/∂t_y, then ∂c/∂t_z.
  Eigen::MatrixXf coefficient_gradients;
};

struct TouchSpace {
  std::string scene_hash;
  /// Where its fields are; empty: nowhere.
  std::string file;
  Surface surface;
  /// Orthonormal modes of the surface displacement [3 × surface.num_points() × r], see pod.h.
  Eigen::MatrixXf modes;
  /// By active node, ascending.
  std::vector<TouchSite> sites;
  /// What the file holds but is damaged, see StateSpaceFile::left_out().
  std::vector<std::string> left_out;

  /// Largest displacement of a surface point in any usable configuration, m.
  double largest_displacement = 0;
  /// Largest error that the modes make in u at any surface point of any usable configuration, m.
  double displacement_error = 0;
  /// The same of spacing · ∂u/∂t, m.
  double sensitivity_error = 0;

  [[nodiscard]] Index num_modes() const { return static_cast<Index>(modes.cols()); }
  /// The site at an active node, or nullptr.
  [[nodiscard]] const TouchSite* find(Index active_node) const;
};

/// Largest error of a surface point's displacement, as a share of the largest displacement.
inline constexpr double kDefaultTouchBound = 1e-3;

/// @param space With u and v of every usable configuration.
/// @throws InputError those are missing or not finite, or the bound is out of range, see PodBasis.
[[nodiscard]] TouchSpace make_touch_space(const StateSpace& space,
                                          double bound = kDefaultTouchBound);

/// The same from a file, with the fields of one configuration in memory at a time. Configurations
/// whose fields are damaged or not finite are left out.
[[nodiscard]] TouchSpace make_touch_space(const StateSpaceFile& file,
                                          double bound = kDefaultTouchBound);

/// Without modes, for a program that feels and does not show: no field is read.
[[nodiscard]] TouchSpace make_touch_space_without_modes(const StateSpaceFile& file);

}  // namespace palpate
