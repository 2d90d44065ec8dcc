// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/rigid_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "interaction/rigid_surface_check.h"
#include "interaction/shape_kind.h"

namespace palpate {
namespace {

/// A place of the surface counts as the nearest one to a place inside it if the distance there is
/// at least this share of the way between them. The way is found up to the share kDepthError of the
/// bounding radius.
constexpr double kNearestShare = 0.9;
constexpr double kDepthError = 1e-3;
/// The distance of the balls that stand for the tool, in bounding radii.
constexpr double kBallsApart = 0.1;
/// The largest ratio of spacing and thickness: with a larger one the spline would be rough on the
/// scale of the layer.
constexpr double kLargestSpacing = 0.5;
/// The depth that the spline reaches inside the tool, in units of the thickness. The pressure there
/// is 27/8 of that at a distance of zero, so that no place of a body in equilibrium comes deeper.
constexpr double kSplineDepth = 0.5;
/// The distances at which the error is measured, in units of the thickness.
constexpr double kOffsets[] = {-0.25, -0.125, 0, 0.5, 1};
/// The factor on the largest measured error, for the places in between. On 27 tools (boxes, needles
/// and curved ones, turned at random), none of 150 000 random places had a larger error than the
/// measured one.
constexpr double kMargin = 1.1;
/// The error is proportional to the spacing at edges, and to a power of it elsewhere. So the next
/// spacing that is tried is the one that would suffice at edges, within limits.
constexpr double kAim = 0.9;
constexpr double kLeastRefinement = 0.85;
constexpr double kMostRefinement = 0.5;

const ToolSurface& checked(ToolSurface& tool) {
  const auto check = [](const char* what, double value, bool zero_is_good, const char* unit) {
    if (std::isfinite(value) && (value > 0 || (zero_is_good && value == 0))) return;
    throw InputError(std::string(what) + " is " + quantity(value, unit) + ". Give " +
                     (zero_is_good ? "0 or more." : "a value larger than 0."));
  };
  check("The thickness of the layer in which contact acts", tool.thickness, false, "m");
  check("The spacing of the grid of the tool's distance", tool.spacing, true, "m");
  check("The error wanted of the tool's distance, as a share of the thickness,", tool.error, false,
        "");
  check_and_orient_tool(tool.points, tool.triangles);
  return tool;
}

/// Sums of the normals of the triangles at each point.
std::vector<Vec3> normals_at_points(const ToolSurface& tool) {
  std::vector<Vec3> normals(tool.points.size(), Vec3::Zero());
  for (const auto& [a, b, c] : tool.triangles) {
    const Vec3 normal =
        (tool.points[b] - tool.points[a]).cross(tool.points[c] - tool.points[a]).normalized();
    for (Index point : {a, b, c}) normals[point] += normal;
  }
  for (Vec3& normal : normals) normal.normalize();
  return normals;
}

/// Places of the surface, as balls without radius, such that each of its points has one within
/// about twice a distance, and each corner of its triangles within that.
std::vector<RigidShape::Ball> balls_on(const ToolSurface& tool, double distance) {
  std::vector<RigidShape::Ball> balls;
  const auto add = [&](const Vec3& place) {
    const bool is_near = std::any_of(balls.begin(), balls.end(), [&](const auto& ball) {
      return (ball.centre - place).norm() < distance;
    });
    if (!is_near) balls.push_back({place, 0});
  };
  for (const auto& [a, b, c] : tool.triangles) {
    const Vec3& at_a = tool.points[a];
    const Vec3& at_b = tool.points[b];
    const Vec3& at_c = tool.points[c];
    for (const Vec3& corner : {at_a, at_b, at_c}) add(corner);
    add((at_a + at_b + at_c) / 3);
    // In a large triangle these places leave wide gaps, which further places fill.
    const double longest =
        std::max({(at_b - at_a).norm(), (at_c - at_b).norm(), (at_a - at_c).norm()});
    const int parts = static_cast<int>(std::ceil(longest / (2 * distance)));
    for (int i = 0; parts > 1 && i <= parts; ++i) {
      for (int j = 0; i + j <= parts; ++j) {
        add(at_a + (i * (at_b - at_a) + j * (at_c - at_a)) / parts);
      }
    }
  }
  return balls;
}

}  // namespace

RigidSurface::RigidSurface(ToolSurface tool)
    : tree_(checked(tool).points, tool.triangles), thickness_(tool.thickness) {
  for (const auto& triangle : tool.triangles) {
    for (Index point : triangle) {
      bounding_radius_ = std::max(bounding_radius_, tool.points[point].norm());
    }
  }
  balls_ = balls_on(tool, kBallsApart * bounding_radius_);
  find_inner_places();
  if (tool.spacing > 0) {
    make_spline(tool.spacing);
    measure_error(tool);
    return;
  }
  const double wanted = tool.error * thickness_;
  for (double spacing = kLargestSpacing * thickness_;;) {
    make_spline(spacing);
    measure_error(tool);
    if (error_ <= wanted) break;
    spacing *= std::clamp(kAim * wanted / error_, kMostRefinement, kLeastRefinement);
  }
}

void RigidSurface::find_inner_places() {
  // Go inwards from each place of the surface, about as far as it stays the nearest one.
  double deepest = 0;
  std::vector<double> depths;
  for (const Ball& ball : balls_) {
    const Vec3 inwards = -tree_.nearest(ball.centre).normal;
    const auto is_nearest = [&](double way) {
      return -tree_.nearest(ball.centre + way * inwards).distance >= kNearestShare * way;
    };
    double depth = 0;
    for (double step = bounding_radius_; step > kDepthError * bounding_radius_; step /= 2) {
      if (is_nearest(depth + step)) depth += step;
    }
    inner_places_.push_back(ball.centre + depth * inwards);
    depths.push_back(depth);
    deepest = std::max(deepest, depth);
  }
  // Near edges, a body that is pressed hard may reach these places.
  const double enough = std::min(thickness_, 0.5 * deepest);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (depths[i] >= enough) inner_places_[kept++] = inner_places_[i];
  }
  inner_places_.resize(kept);
}

void RigidSurface::make_spline(double spacing) {
  spacing_ = spacing;
  const Vec3 around = Vec3::Constant(thickness_);
  Index last = -1;
  const auto distance = [&](const Vec3& place) {
    const SurfaceTree::Nearest nearest = tree_.nearest(place, last);
    last = nearest.triangle;
    return nearest.distance;
  };
  spline_.reset();  // frees the old one before the new one is made
  spline_ = std::make_unique<BsplineGrid>(
      distance, BsplineGrid::Options{{tree_.bounds().min() - around, tree_.bounds().max() + around},
                                     spacing,
                                     -kSplineDepth * thickness_,
                                     thickness_});
}

void RigidSurface::measure_error(const ToolSurface& tool) {
  const std::vector<Vec3> normals = normals_at_points(tool);
  double largest = 0;
  double sum = 0;
  double num_places = 0;
  Index last = -1;
  Jet jet;
  const auto measure = [&](const Vec3& place) {
    const SurfaceTree::Nearest nearest = tree_.nearest(place, last);
    last = nearest.triangle;
    if (nearest.distance < -depth() || nearest.distance > thickness_) return;
    if (spline_->evaluate(place, 0, jet) != BsplineGrid::Region::band) return;
    const double error = std::abs(jet.value - nearest.distance);
    largest = std::max(largest, error);
    sum += error * error;
    ++num_places;
  };
  for (const auto& [a, b, c] : tool.triangles) {
    const Vec3& at_a = tool.points[a];
    const Vec3& at_b = tool.points[b];
    const Vec3& at_c = tool.points[c];
    const double longest =
        std::max({(at_b - at_a).norm(), (at_c - at_b).norm(), (at_a - at_c).norm()});
    const int num_parts = static_cast<int>(std::ceil(longest / spacing_));
    for (int i = 0; i <= num_parts; ++i) {
      for (int j = 0; i + j <= num_parts; ++j) {
        const double u = static_cast<double>(i) / num_parts;
        const double v = static_cast<double>(j) / num_parts;
        const Vec3 place = (1 - u - v) * at_a + u * at_b + v * at_c;
        const Vec3 normal = ((1 - u - v) * normals[a] + u * normals[b] + v * normals[c]);
        for (double offset : kOffsets) measure(place + offset * thickness_ * normal.normalized());
      }
    }
  }
  error_ = kMargin * largest;
  rms_error_ = std::sqrt(sum / num_places);
}

RigidShape::Jet RigidSurface::evaluate(const Vec3& place, int order) const noexcept {
  Jet jet;
  switch (spline_->evaluate(place, order, jet)) {
    case BsplineGrid::Region::band: break;
    case BsplineGrid::Region::above:
      jet.value = place.allFinite() ? std::max(thickness_, bounds().exteriorDistance(place))
                                    : std::numeric_limits<double>::quiet_NaN();
      break;
    case BsplineGrid::Region::below: {
      const SurfaceTree::Nearest nearest = tree_.nearest(place);
      jet.value = nearest.distance;
      if (order >= 1) jet.gradient = (place - nearest.point) / nearest.distance;
      break;
    }
  }
  return jet;
}

std::string RigidSurface::description() const {
  return "a surface of " + std::to_string(tree_.num_triangles()) + " triangles";
}

std::shared_ptr<const RigidSurface> make_surface_tool(ToolSurface tool) {
  return std::make_shared<const RigidSurface>(std::move(tool));
}

namespace {

class SurfaceKind final : public ShapeKind {
 public:
  SurfaceKind() = default;
  [[nodiscard]] ToolShape number() const override { return ToolShape::surface; }
  [[nodiscard]] double half_width(const RigidTool& tool) const override {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : tool.points) box.extend(p);
    return box.isEmpty() ? 0 : 0.5 * box.sizes().minCoeff();
  }
  [[nodiscard]] double reach(const RigidTool& tool, const Vec3& direction) const override {
    double most = 0;
    for (const Vec3& p : tool.points) most = std::max(most, p.dot(direction));
    return most;
  }
  [[nodiscard]] double least_thickness(const RigidTool& tool) const override {
    double area = 0;
    for (const auto& [a, b, c] : tool.triangles) {
      const Vec3& corner = tool.points[a];
      area += 0.5 * (tool.points[b] - corner).cross(tool.points[c] - corner).norm();
    }
    return std::sqrt(area / kLargestAreaOfThickness);
  }
  [[nodiscard]] bool has_radius() const override { return false; }
  [[nodiscard]] std::string name(const RigidTool& tool) const override {
    return "the tool with a surface of " + std::to_string(tool.triangles.size()) + " triangles";
  }
  [[nodiscard]] RigidShapePtr make(const RigidTool& tool) const override {
    ToolSurface surface;
    surface.points = tool.points;
    surface.triangles = tool.triangles;
    surface.thickness = tool.law.thickness;
    return make_surface_tool(std::move(surface));
  }
};

}  // namespace

std::unique_ptr<const ShapeKind> surface_kind() { return std::make_unique<SurfaceKind>(); }

}  // namespace palpate
