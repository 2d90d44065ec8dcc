// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateShownTool.h"

#include <gtest/gtest.h>
#include <vtkPolyData.h>

#include <memory>

#include "interaction/rigid_capsule.h"
#include "interaction/shape_kind.h"
#include "vtkPalpateTool.h"

namespace palpate::test::test_shown_tool {
namespace {

constexpr auto kRod = static_cast<ToolShape>(100);

/// A shape that what shows tools does not know.
class RodKind final : public ShapeKind {
 public:
  RodKind() = default;
  [[nodiscard]] ToolShape number() const override { return kRod; }
  [[nodiscard]] double half_width(const RigidTool& tool) const override { return tool.radius; }
  [[nodiscard]] double reach(const RigidTool& tool, const Vec3& /*direction*/) const override {
    return tool.radius;
  }
  [[nodiscard]] std::string name(const RigidTool& /*tool*/) const override { return "the rod"; }
  [[nodiscard]] RigidShapePtr make(const RigidTool& tool) const override {
    return make_capsule({tool.radius, tool.length, tool.axis});
  }
};

RigidTool make_rod(ToolShape shape) {
  RigidTool rod;
  rod.shape = shape;
  rod.radius = 0.01;
  rod.length = 0.03;
  rod.axis = Vec3(1, 0.5, 0);
  return rod;
}

TEST(ShownTool, AShapeThatIsNewIsShownByItsDistance) {
  vtkPalpateTool::AddKind(std::make_unique<const RodKind>());
  const RigidTool rod = make_rod(kRod);
  const auto surface = vtkPalpateToolSurface(rod);
  ASSERT_GT(surface->GetNumberOfCells(), 1000);
  const RigidShapePtr shape = make_capsule({rod.radius, rod.length, rod.axis});
  for (vtkIdType p = 0; p < surface->GetNumberOfPoints(); ++p) {
    // It is linear between places that are 1 mm apart.
    EXPECT_NEAR(shape->value(Vec3(surface->GetPoint(p))), 0, 5e-5);
  }
  double bounds[6];
  double expected[6];
  surface->GetBounds(bounds);
  vtkPalpateToolSurface(make_rod(ToolShape::capsule))->GetBounds(expected);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(bounds[i], expected[i], 5e-4);
}

}  // namespace
}  // namespace palpate::test::test_shown_tool
