// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/piece_support.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "solvers/support/box_mesh.h"
#include "solvers/support/message_of.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_piece_support {
namespace {

/// Boxes of 1 m³ in a row, 2 m apart, of which each is higher than the one before by 1 m.
TetMesh make_row(ElementOrder order, int num_boxes) {
  TetMesh mesh;
  mesh.order = order;
  for (int i = 0; i < num_boxes; ++i) {
    const TetMesh box = make_box(order, {1, 1, 1}, {1, 1, 1.0 + i});
    const Index first = mesh.num_points();
    for (const Vec3& p : box.points) mesh.points.push_back(p + Vec3(2.0 * i, 0, 0));
    for (const Index p : box.cells) mesh.cells.push_back(first + p);
  }
  return mesh;
}

std::vector<char> fixed_where(const TetMesh& mesh, const std::function<bool(const Vec3&)>& where) {
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(where(p) ? 1 : 0);
  return fixed;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class SupportOfAnyOrder : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(PieceSupport, SupportOfAnyOrder, testing::ValuesIn(kOrders),
                         name_of_order);

TEST_P(SupportOfAnyOrder, EachPieceNeedsThreePointsOffALine) {
  const TetMesh mesh = make_row(GetParam(), 2);
  const auto mobile = [&](const std::function<bool(const Vec3&)>& of_second) {
    const auto fixed =
        fixed_where(mesh, [&](const Vec3& p) { return p.x() < 1.5 ? p.z() == 0 : of_second(p); });
    return PieceSupport(mesh, fixed).find_mobile_piece({}).value_or("");
  };
  EXPECT_EQ(mobile([](const Vec3& p) { return p.z() == 0; }), "");
  const std::string line = mobile([](const Vec3& p) { return p.z() == 0 && p.y() == 0; });
  EXPECT_TRUE(contains(line, "around (2.5, 0.5, 1) m is not held but along one line")) << line;
  const std::string point = mobile([](const Vec3& p) { return p == Vec3(2, 0, 0); });
  EXPECT_TRUE(contains(point, "is not held but at one point")) << point;
  const std::string none = mobile([](const Vec3&) { return false; });
  EXPECT_TRUE(contains(none, "one of them is not held: 6 cells, 2 m³, around (2.5, 0.5, 1) m"))
      << none;
}

TEST_P(SupportOfAnyOrder, ToolsHoldToo) {
  const TetMesh mesh = make_row(GetParam(), 2);
  const PieceSupport support(
      mesh, fixed_where(mesh, [](const Vec3& p) { return p.x() < 1.5 && p.z() == 0; }));
  std::vector<Index> top;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (mesh.points[p].z() == 2) top.push_back(p);
  }
  EXPECT_NE(message_of([&] { support.require_held({}); }), "");
  EXPECT_NE(message_of([&] { support.require_held({0}); }), "") << "a point of the other piece";
  EXPECT_EQ(message_of([&] { support.require_held(top); }), "");
  EXPECT_EQ(message_of([&] { support.require_held({top[0]}); }), "") << "it only turns";
  EXPECT_FALSE(support.find_mobile_piece(top));
  EXPECT_TRUE(support.find_mobile_piece({top[0]}));
}

TEST(PieceSupport, TheLargestAreNamed) {
  const TetMesh mesh = make_row(ElementOrder::linear, 6);
  const PieceSupport support(
      mesh, fixed_where(mesh, [](const Vec3& p) { return p.x() < 1.5 && p.z() == 0; }));
  const std::string message = message_of([&] { support.require_held({}); });
  EXPECT_TRUE(contains(message, "6 pieces")) << message;
  EXPECT_TRUE(contains(message, "5 of them are not held: 6 cells, 6 m³")) << message;
  EXPECT_TRUE(contains(message, "; and 2 smaller.")) << message;
}

TEST(PieceSupport, APointOfNoCellHoldsNothing) {
  TetMesh mesh = make_row(ElementOrder::linear, 1);
  mesh.points.emplace_back(0, 0, 0);
  const auto fixed = fixed_where(mesh, [](const Vec3& p) { return p == Vec3(0, 0, 0); });
  std::vector<char> unused_too(fixed);
  unused_too.back() = 1;
  const auto text = PieceSupport(mesh, unused_too).find_mobile_piece({});
  ASSERT_TRUE(text);
  EXPECT_TRUE(contains(*text, "at one point")) << *text;
}

// Two cells that share an edge, of which one is held.
TEST(PieceSupport, APartThatAnEdgeJoinsTurns) {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0, -1}};
  mesh.cells = {0, 1, 2, 3, 0, 1, 4, 5};
  const std::vector<char> held = {1, 1, 1, 1, 0, 0};
  EXPECT_FALSE(PieceSupport(mesh, held).find_mobile_piece({})) << "it is one piece";
  const auto text = find_mobile_part(mesh, held);
  ASSERT_TRUE(text);
  EXPECT_TRUE(contains(*text, "1 cell, 0.167 m³, around (0.25, -0.25, -0.25) m")) << *text;
  EXPECT_TRUE(contains(*text, "along one line")) << *text;
  EXPECT_FALSE(find_mobile_part(mesh, {1, 1, 1, 1, 1, 0}));
}

}  // namespace
}  // namespace palpate::test::test_piece_support
