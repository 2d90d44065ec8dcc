// SPDX-License-Identifier: BSD-3-Clause
// How wrong the force of a rigid tool is because the cells under it are large. A sphere of radius R
// was pressed by 0.05 … 0.4 R into a block of tissue (neo-Hookean, ν = 0.45) on meshes with edges
// of 0.35 … 4 R, at three places each, and the forces were compared with the values to which they
// tend. All errors lie near one curve in x, the longest edge over the radius a of the contact, that
// follows from its area,
//
//   e = 0.040 x² / (1 + 0.105 x)    quadratic cells
//   e = 0.45 x^1.3                  linear cells
//
// Most are within a third of it for x of 0.6 … 9. Beyond that, where very coarse meshes are pressed
// deeply, they are below the curve. The curve was fitted to these same points, and the values to
// which the forces tend were extrapolated from the two finest meshes, so it is a guide and not a
// bound. The force is too large by this share of the true one: a coarse mesh is too stiff.
#pragma once

#include "mesh/tet_mesh.h"

namespace palpate {

/// e, as a share of the true force; 0 where nothing is touched.
/// @param longest_edge The longest edge of the pressed faces, m.
/// @param area The area of the contact, m².
[[nodiscard]] double expected_mesh_error(ElementOrder order, double longest_edge, double area);

/// A reliable estimate of mesh_error_estimate.h is 0.67 to 1.5 times the true error of a force. So
/// this is the largest true error, as a share of the estimate, and the largest one that is left
/// once the estimate is taken off the force.
inline constexpr double kMostOfEstimate = 1.5;
inline constexpr double kMostOfCorrected = 0.5;
/// The same of an estimate that is not reliable: with mixed cells it was 0.5 times the true error
/// or more, and 0.55 times with laws that stiffen steeply.
inline constexpr double kMostOfUnreliable = 2;
inline constexpr double kMostOfUnreliableCorrected = 1;

}  // namespace palpate
