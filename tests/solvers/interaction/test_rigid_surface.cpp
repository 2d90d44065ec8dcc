// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/rigid_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "interaction/rigid_capsule.h"
#include "solvers/interaction/jets.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/random.h"
#include "solvers/support/surfaces.h"

namespace palpate::test::test_rigid_surface {
namespace {

using test::Jet;

constexpr double kThickness = 0.002;
constexpr double kSpacing = 0.0005;
const Vec3 kSize(0.016, 0.018, 0.014);

ToolSurface tool_of(const test::Surface& surface) {
  ToolSurface tool;
  tool.points = surface.points;
  tool.triangles = surface.triangles;
  tool.thickness = kThickness;
  tool.spacing = kSpacing;
  return tool;
}

void move(ToolSurface& tool, const Mat3& rotation, const Vec3& shift) {
  for (Vec3& point : tool.points) point = rotation * point + shift;
}

/// A box of twelve triangles around its centre.
ToolSurface box_tool() {
  ToolSurface tool = tool_of(test::box_surface(kSize, {1, 1, 1}));
  move(tool, Mat3::Identity(), -kSize / 2);
  return tool;
}

/// A box from which a quarter is cut out: a tool with a concave edge.
ToolSurface notched_tool() {
  const TetMesh box = test::make_box(ElementOrder::linear, {2, 2, 2}, kSize);
  ToolSurface tool = tool_of(test::surface_of(test::subset(box, [&](Index cell) {
    Vec3 middle = Vec3::Zero();
    for (int k = 0; k < 4; ++k) middle += box.points[box.cell(cell)[k]] / 4;
    return middle.x() < kSize.x() / 2 || middle.z() < kSize.z() / 2;
  })));
  move(tool, Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()).toRotationMatrix(), -kSize / 2);
  return tool;
}

double distance_to_box(const Vec3& place) {
  const Vec3 q = place.cwiseAbs() - kSize / 2;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

/// Places in the band, many of them at edges and corners of the box.
std::vector<Vec3> places_around_box(int count, test::Random& random) {
  std::vector<Vec3> places;
  while (static_cast<int>(places.size()) < count) {
    Vec3 place = random.vector(3, 0.5).cwiseProduct(kSize);
    const int num_on = 1 + static_cast<int>(places.size()) % 3;
    const int first = static_cast<int>(random.uniform(0, 3));
    for (int k = 0; k < num_on; ++k) {
      const int axis = (first + k) % 3;
      place[axis] = std::copysign(kSize[axis] / 2, place[axis]);
    }
    place += random.rotation().col(0) * random.uniform(0, 1) * kThickness;
    const double distance = distance_to_box(place);
    if (distance > -kThickness / 4 && distance < kThickness) places.push_back(place);
  }
  return places;
}

TEST(RigidSurface, DerivativesAreThoseOfTheValue) {
  // A step this small meets a border of the cells, where the fourth derivative jumps, at few
  // places, and moves the third by up to 40 steps there.
  constexpr double kStep = 1e-4;
  constexpr double kTolerance = 40 * kStep;
  for (const ToolSurface& tool : {box_tool(), notched_tool(), tool_of(test::icosphere(0.01, 2))}) {
    const auto shape = make_surface_tool(tool);
    test::Random random(1);
    for (const auto& [a, b, c] : tool.triangles) {
      for (int i = 0; i < 10; ++i) {
        const double u = i == 0 ? 0 : random.uniform(0, 1);
        const double v = i <= 1 ? 0 : random.uniform(0, 1 - u);
        const Vec3 on = (1 - u - v) * tool.points[a] + u * tool.points[b] + v * tool.points[c];
        const Vec3 place = on + random.uniform(0, 0.5) * kThickness * random.rotation().col(0);
        test::expect_consistent(*shape, place, kStep * shape->spacing(), shape->spacing(),
                                kTolerance);
        test::expect_orders_agree(*shape, place);
      }
    }
  }
}

TEST(RigidSurface, TheStatedErrorBoundsThatOfABox) {
  test::Random random(2);
  const std::vector<Vec3> places = places_around_box(100000, random);
  std::vector<double> errors;
  for (double spacing : {0.001, 0.0005, 0.00025}) {
    ToolSurface tool = box_tool();
    tool.spacing = spacing;
    const auto shape = make_surface_tool(tool);
    EXPECT_EQ(shape->spacing(), spacing);
    double largest = 0;
    for (const Vec3& place : places) {
      largest = std::max(largest, std::abs(shape->value(place) - distance_to_box(place)));
    }
    EXPECT_LE(largest, shape->error()) << spacing;
    EXPECT_GT(largest, 0.8 * shape->error()) << "the error is stated too large";
    EXPECT_LT(shape->rms_error(), shape->error());
    errors.push_back(largest / spacing);
  }
  // At an edge that is sharp the error is proportional to the spacing.
  EXPECT_NEAR(errors[1] / errors[0], 1, 0.2);
  EXPECT_NEAR(errors[2] / errors[1], 1, 0.2);
}

TEST(RigidSurface, TheStatedErrorBoundsThatOfATurnedNotchedBox) {
  const ToolSurface tool = notched_tool();
  const auto shape = make_surface_tool(tool);
  const SurfaceTree tree(tool.points, tool.triangles);
  test::Random random(3);
  double largest = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto& [a, b, c] = tool.triangles[i % tool.triangles.size()];
    const double u = i % 2 == 0 ? 0 : random.uniform(0, 1);
    const double v = random.uniform(0, 1 - u);
    const Vec3 place = (1 - u - v) * tool.points[a] + u * tool.points[b] + v * tool.points[c] +
                       random.uniform(0, 1) * kThickness * random.rotation().col(0);
    const double distance = tree.nearest(place).distance;
    if (distance < -shape->depth() || distance > kThickness) continue;
    largest = std::max(largest, std::abs(shape->value(place) - distance));
  }
  EXPECT_LE(largest, shape->error());
  EXPECT_GT(largest, 0.8 * shape->error()) << "the error is stated too large";
}

TEST(RigidSurface, KeepsTheErrorWanted) {
  double last_spacing = kThickness;
  for (double error : {0.2, 0.1}) {
    ToolSurface tool = box_tool();
    tool.spacing = 0;
    tool.error = error;
    const auto shape = make_surface_tool(tool);
    EXPECT_LE(shape->error(), error * kThickness);
    EXPECT_LT(shape->spacing(), last_spacing);
    last_spacing = shape->spacing();
  }
}

// The triangles themselves are wrong by the square of their size, their normals by the first power.
TEST(RigidSurface, ConvergesToTheSphere) {
  const double radius = 0.01;
  const RigidShapePtr sphere = make_sphere(radius);
  std::vector<std::array<double, 2>> errors;
  for (int level : {2, 3, 4}) {
    ToolSurface tool = tool_of(test::icosphere(radius, level));
    tool.thickness = 0.001;
    tool.spacing = 0.5 * radius / (1 << level);
    const auto shape = make_surface_tool(tool);
    std::array<double, 2>& error = errors.emplace_back();
    test::Random random(4);
    for (int i = 0; i < 20000; ++i) {
      const Vec3 place =
          (radius + random.uniform(0, 1) * tool.thickness) * random.rotation().col(0);
      const Jet jet = shape->evaluate(place, 1);
      const Jet exact = sphere->evaluate(place, 1);
      error[0] = std::max(error[0], std::abs(jet.value - exact.value) / radius);
      error[1] = std::max(error[1], (jet.gradient - exact.gradient).norm());
    }
  }
  for (std::size_t i = 1; i < errors.size(); ++i) {
    EXPECT_GT(std::log2(errors[i - 1][0] / errors[i][0]), 1.8);
    EXPECT_GT(std::log2(errors[i - 1][1] / errors[i][1]), 0.8);
  }
}

// The grid lies around the middle of the box: after a quarter turn it is the same one.
TEST(RigidSurface, TurnsWithTheTool) {
  const auto shape = make_surface_tool(box_tool());
  test::Random random(5);
  const std::vector<Vec3> places = places_around_box(2000, random);
  for (int axis = 0; axis < 3; ++axis) {
    const Mat3 quarter = Eigen::AngleAxisd(M_PI / 2, Vec3::Unit(axis)).toRotationMatrix();
    ToolSurface turned = box_tool();
    move(turned, quarter, Vec3::Zero());
    const auto turned_shape = make_surface_tool(turned);
    for (const Vec3& place : places) {
      const Jet jet = shape->evaluate(place);
      const Jet there = turned_shape->evaluate(quarter * place);
      EXPECT_NEAR(there.value, jet.value, 1e-12);
      EXPECT_LT((there.gradient - quarter * jet.gradient).norm(), 1e-9);
      EXPECT_LT(
          (there.hessian - quarter * jet.hessian * quarter.transpose()).norm() * shape->spacing(),
          1e-9);
      for (int i = 0; i < 3; ++i) {
        Mat3 third = Mat3::Zero();
        for (int j = 0; j < 3; ++j) third += quarter(i, j) * test::third_along(jet, j);
        EXPECT_LT((test::third_along(there, i) - quarter * third * quarter.transpose()).norm() *
                      shape->spacing() * shape->spacing(),
                  1e-8);
      }
    }
  }
  // Any other turn, with a shift, gives the same up to the errors.
  const Mat3 rotation = random.rotation();
  const Vec3 shift(0.003, -0.001, 0.02);
  ToolSurface turned = box_tool();
  move(turned, rotation, shift);
  const auto turned_shape = make_surface_tool(turned);
  for (const Vec3& place : places) {
    EXPECT_NEAR(turned_shape->value(rotation * place + shift), shape->value(place),
                shape->error() + turned_shape->error());
  }
}

TEST(RigidSurface, BoundsHoldTheSurface) {
  ToolSurface tool = box_tool();
  const Vec3 shift(0.01, 0, 0);
  move(tool, Mat3::Identity(), shift);
  tool.points.push_back(Vec3::Constant(1));  // of no triangle
  const auto shape = make_surface_tool(tool);
  EXPECT_LT((shape->bounds().min() - (shift - kSize / 2)).norm(), 1e-15);
  EXPECT_LT((shape->bounds().max() - (shift + kSize / 2)).norm(), 1e-15);
  EXPECT_NEAR(shape->bounding_radius(), (shift + kSize / 2).norm(), 1e-15);
  EXPECT_EQ(shape->description(), "a surface of 12 triangles");
}

TEST(RigidSurface, FarOutItIsALowerBoundOfTheDistance) {
  const auto shape = make_surface_tool(box_tool());
  test::Random random(6);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 place = random.vector(3, i % 2 == 0 ? 0.02 : 0.2);
    const double distance = distance_to_box(place);
    if (distance < kThickness) continue;
    const Jet jet = shape->evaluate(place);
    EXPECT_TRUE(test::all_finite(jet));
    EXPECT_LE(jet.value, distance + shape->error());
    EXPECT_GE(jet.value, kThickness - shape->error());
  }
  EXPECT_NEAR(shape->value(Vec3(1, 0, 0)), 1 - kSize.x() / 2, 1e-15);
  EXPECT_TRUE(test::all_finite(shape->evaluate(Vec3::Constant(1e50))));
  EXPECT_FALSE(std::isfinite(shape->value(Vec3(0, std::nan(""), 0))));
}

// In the notch of a large tool one is in the box around it, but far from its surface.
TEST(RigidSurface, FarOutInANotchThereIsNoContact) {
  ToolSurface tool = notched_tool();
  for (Vec3& point : tool.points) point *= 4;
  tool.spacing = 0.001;
  const auto shape = make_surface_tool(tool);
  const SurfaceTree tree(tool.points, tool.triangles);
  test::Random random(10);
  int num_constant = 0;
  for (int i = 0; i < 50000; ++i) {
    const Vec3 place =
        shape->bounds().center() + random.vector(3, 0.5).cwiseProduct(shape->bounds().sizes());
    const double distance = tree.nearest(place).distance;
    if (distance < kThickness) continue;
    const Jet jet = shape->evaluate(place);
    EXPECT_GE(jet.value, kThickness - shape->error());
    EXPECT_LE(jet.value, distance + shape->error());
    num_constant += jet.gradient.norm() == 0;
  }
  EXPECT_GT(num_constant, 100) << "the grid is everywhere";
}

TEST(RigidSurface, DeepInsideItLeadsOut) {
  ToolSurface tool = box_tool();
  tool.thickness = 0.001;
  tool.spacing = 0.00025;
  const auto shape = make_surface_tool(tool);
  // The grid reaches by its bricks, and by its B-splines, beyond the band.
  const double end_of_grid = tool.thickness / 2 + (8 + 2.5) * std::sqrt(3.0) * shape->spacing();
  test::Random random(7);
  int num_deep = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 place = random.vector(3, 0.5).cwiseProduct(kSize);
    const double distance = distance_to_box(place);
    const Jet jet = shape->evaluate(place);
    ASSERT_TRUE(test::all_finite(jet));
    EXPECT_NEAR(jet.value, distance, shape->spacing());
    if (distance > -end_of_grid) continue;
    // By the depth along the gradient one is at the surface.
    ++num_deep;
    EXPECT_NEAR(distance_to_box(place - jet.value * jet.gradient), 0, 1e-12);
    test::expect_orders_agree(*shape, place);
  }
  EXPECT_GT(num_deep, 20);
  // In the middle several ways are the shortest.
  EXPECT_TRUE(test::all_finite(shape->evaluate(Vec3::Zero())));
  EXPECT_NEAR(shape->value(Vec3::Zero()), -kSize.minCoeff() / 2, 1e-12);
}

// From the middle outward over both borders of the band: the value jumps by no more than the error.
TEST(RigidSurface, TheBordersOfTheBand) {
  const auto shape = make_surface_tool(box_tool());
  test::Random random(8);
  for (int line = 0; line < 100; ++line) {
    const Vec3 direction = random.rotation().col(0);
    const double step = 0.01 * shape->spacing();
    double before = shape->value(Vec3::Zero());
    for (int n = 1; before < kThickness && n < 100000; ++n) {
      const double value = shape->value(n * step * direction);
      EXPECT_NEAR(value, before, step * 1.2 + shape->error());
      before = value;
    }
    EXPECT_GE(before, kThickness);
  }
}

TEST(RigidSurface, TrianglesMayLookInward) {
  const auto outward = make_surface_tool(box_tool());
  ToolSurface inward_tool = box_tool();
  for (auto& triangle : inward_tool.triangles) std::swap(triangle[0], triangle[1]);
  ToolSurface mixed_tool = box_tool();
  std::swap(mixed_tool.triangles[4][1], mixed_tool.triangles[4][2]);
  std::swap(mixed_tool.triangles[7][1], mixed_tool.triangles[7][2]);
  const auto inward = make_surface_tool(inward_tool);
  const auto mixed = make_surface_tool(mixed_tool);
  test::Random random(9);
  for (const Vec3& place : places_around_box(1000, random)) {
    const Jet jet = outward->evaluate(place);
    EXPECT_LT(test::difference(jet, inward->evaluate(place), outward->spacing()), 1e-8);
    EXPECT_LT(test::difference(jet, mixed->evaluate(place), outward->spacing()), 1e-8);
  }
}

void expect_message(const ToolSurface& tool, const std::vector<std::string>& parts) {
  try {
    (void)make_surface_tool(tool);
    ADD_FAILURE() << "no error: " << parts.front();
  } catch (const InputError& error) {
    for (const std::string& part : parts) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
}

TEST(RigidSurface, RefusesWhatBoundsNoTool) {
  ToolSurface tool = box_tool();
  tool.triangles.clear();
  expect_message(tool, {"has no triangles", "closed surface"});

  tool = box_tool();
  tool.triangles.resize(1);
  expect_message(tool, {"is open: 3 of its edges", "Close its holes"});

  tool = box_tool();
  tool.triangles.pop_back();
  expect_message(tool, {"is open: 3 of its edges", "(", "Close its holes"});

  tool = box_tool();
  const auto first = tool.triangles[0];
  tool.triangles.push_back(first);
  expect_message(tool, {"3 edges of the tool's surface belong to more than two triangles"});

  tool = box_tool();
  tool.points[5][1] = std::nan("");
  expect_message(tool, {"Point 5 of the tool's surface", "not finite"});

  tool = box_tool();
  tool.triangles[3][1] = 99;
  expect_message(tool, {"Triangle 3 of the tool's surface names point 99", "8 points"});
  tool.triangles[3][1] = -1;
  expect_message(tool, {"Triangle 3 of the tool's surface names point -1"});

  tool = box_tool();
  tool.triangles[6][0] = tool.triangles[6][1];
  expect_message(tool, {"1 of the triangles", "no area", "triangle 6", "Clean"});
  tool = box_tool();
  tool.points.push_back((tool.points[tool.triangles[2][0]] + tool.points[tool.triangles[2][1]]) /
                        2);
  tool.triangles[2][2] = 8;  // on the line between the other two
  expect_message(tool, {"1 of the triangles", "no area", "triangle 2"});

  tool = box_tool();
  const ToolSurface other = box_tool();
  for (const Vec3& point : other.points) tool.points.push_back(point + Vec3::Constant(0.05));
  for (auto triangle : other.triangles) {
    for (Index& point : triangle) point += 8;
    tool.triangles.push_back(triangle);
  }
  expect_message(tool, {"has 2 pieces", "Connectivity"});

  tool = box_tool();
  tool.triangles = {{0, 1, 2}, {2, 1, 0}};
  expect_message(tool, {"encloses no volume"});
}

// The projective plane of six points, each edge of which belongs to two triangles.
TEST(RigidSurface, RefusesASurfaceWithOneSide) {
  ToolSurface tool = tool_of(test::icosphere(0.01, 0));
  tool.points.resize(6);
  tool.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1},
                    {1, 2, 4}, {2, 3, 5}, {3, 4, 1}, {4, 5, 2}, {5, 1, 3}};
  expect_message(tool, {"one side alone", "edge"});
}

TEST(RigidSurface, RefusesNumbersOutOfRange) {
  for (double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    ToolSurface tool = box_tool();
    tool.thickness = bad;
    expect_message(tool, {"thickness of the layer"});
    tool = box_tool();
    tool.error = bad;
    expect_message(tool, {"error wanted"});
    tool = box_tool();
    tool.spacing = bad;
    expect_message(tool, {"spacing of the grid"});
  }
  ToolSurface tool = box_tool();
  tool.thickness = 0;
  expect_message(tool, {"thickness of the layer"});
  tool = box_tool();
  tool.error = 0;
  expect_message(tool, {"error wanted"});
  tool = box_tool();
  tool.spacing = 0;
  for (Vec3& point : tool.points) point *= 100;  // in cm
  expect_message(tool, {"too fine", "a thicker layer (ContactThickness)"});
}

}  // namespace
}  // namespace palpate::test::test_rigid_surface
