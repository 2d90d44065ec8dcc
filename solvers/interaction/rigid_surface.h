// SPDX-License-Identifier: BSD-3-Clause
// A tool of any shape, such as a scanned one, that a closed surface of triangles bounds.
//
// The distance to triangles has kinks: its Hessian jumps where another corner or edge is nearest
// and is infinite at convex edges, and at concave ones the gradient jumps. So the tool has a spline
// instead (bspline_grid.h), which is C³ where −δ/2 ≤ d ≤ δ around the surface, δ being the
// thickness of the layer in which contact acts. It rounds edges over about the spacing h of its
// grid: its error is 0.35 h at the corners of a cube and falls with h⁴ where the surface is smooth.
// h is the largest spacing that keeps the error within the wanted one, or the spacing that is
// given. Where triangles stand for a smooth surface, a larger h gives better derivatives, since it
// does not show the triangles. For a sphere of radius R made of triangles with edges e, the root
// mean square errors of value, gradient, Hessian and third derivative are
//
//   h         e         d           ∇d        ∇²d       ∇³d
//   0.1 R     0.13 R    0.0028 R    0.006     0.17/R    4.0/R²
//   0.1 R     0.03 R    0.0002 R    0.0006    0.01/R    0.3/R²
//   0.025 R   0.13 R    0.0029 R    0.035     1.8/R     90/R²
//
// The error is measured with exact distances at places that depend on the surface and h alone:
// points of each triangle, including its corners and edges, up to h apart, and the places −δ/4,
// −δ/8, δ/2 and δ away from each of them along the normal. A tenth is added to the largest of these
// errors, for the places in between.
//
// Where the grid ends, some spacings beyond the band, the distance is the exact one inside the
// tool, with a gradient from the nearest point of the surface and a Hessian of zero. Outside it is
// δ, or the distance to the box around the tool where that is larger, and its derivatives are zero.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "interaction/bspline_grid.h"
#include "interaction/rigid_shape.h"
#include "mesh/surface_tree.h"

namespace palpate {

struct ToolSurface {
  /// The places of the points from the tool's centre [num_points], m.
  std::vector<Vec3> points;
  /// Corners as indices into `points`. Neighbouring triangles share points. The triangles may look
  /// outward or inward.
  std::vector<std::array<Index, 3>> triangles;
  /// The thickness δ of the layer in which contact acts, m.
  double thickness = 0;
  /// The largest error() that is wanted, as a share of the thickness; without effect where the
  /// spacing is given.
  double error = 0.05;
  /// The spacing of the grid, m; 0: about the largest, up to half the thickness, that keeps the
  /// error wanted.
  double spacing = 0;
};

class RigidSurface final : public RigidShape {
 public:
  /// @throws InputError a point is not finite, a triangle has no area, or the surface does not
  /// bound
  ///   one piece: it is empty, open, in several pieces, has edges of more than two triangles, or no
  ///   inside. Also if a length is out of range, or the grid would be too large. Intersections of
  ///   the surface with itself are not detected.
  explicit RigidSurface(ToolSurface tool);

  [[nodiscard]] Jet evaluate(const Vec3& place, int order = 3) const noexcept override;

  [[nodiscard]] Eigen::AlignedBox3d bounds() const noexcept override { return tree_.bounds(); }
  [[nodiscard]] double bounding_radius() const noexcept override { return bounding_radius_; }
  [[nodiscard]] double error() const noexcept override { return error_; }
  [[nodiscard]] double depth() const noexcept override { return kDepth * thickness_; }
  [[nodiscard]] std::vector<Ball> balls() const override { return balls_; }
  [[nodiscard]] std::vector<Vec3> inner_places() const override { return inner_places_; }
  [[nodiscard]] std::string description() const override;

  /// The root of the mean square of the error at the places where it is measured, m.
  [[nodiscard]] double rms_error() const { return rms_error_; }
  /// The spacing of the grid, m.
  [[nodiscard]] double spacing() const { return spacing_; }

 private:
  static constexpr double kDepth = 0.25;

  void find_inner_places();
  void make_spline(double spacing);
  void measure_error(const ToolSurface& tool);

  SurfaceTree tree_;
  std::vector<Ball> balls_;
  std::vector<Vec3> inner_places_;
  double thickness_;
  double bounding_radius_ = 0;
  double spacing_ = 0;
  double error_ = 0;
  double rms_error_ = 0;
  std::unique_ptr<const BsplineGrid> spline_;
};

[[nodiscard]] std::shared_ptr<const RigidSurface> make_surface_tool(ToolSurface tool);

}  // namespace palpate
