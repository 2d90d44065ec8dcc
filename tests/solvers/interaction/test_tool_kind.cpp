// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/tool_kind.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "solvers/support/block.h"

namespace palpate::test::test_tool_kind {
namespace {

constexpr auto kGripped = static_cast<InteractionKind>(100);

/// A kind that nothing else knows: it holds a patch and is shown as a capsule.
class Gripped final : public ToolKind {
 public:
  Gripped() = default;
  [[nodiscard]] InteractionKind number() const override { return kGripped; }
  [[nodiscard]] std::string name(const InteractionSpec& spec) const override {
    return "the grip at node " + std::to_string(spec.active_node);
  }
  [[nodiscard]] bool presses() const override { return false; }
  [[nodiscard]] double touching_radius(const InteractionSpec& spec) const override {
    return 2 * spec.tip_radius;
  }
  [[nodiscard]] RigidTool shown_shape(const InteractionSpec& spec) const override {
    RigidTool shown;
    shown.shape = ToolShape::capsule;
    shown.radius = spec.tip_radius;
    return shown;
  }
  [[nodiscard]] std::unique_ptr<Interaction> make(const InteractionSpec& spec,
                                                  InteractionFactory& of) const override {
    return of.patches(2 * spec.tip_radius).around(spec.active_node).clone();
  }
};

TEST(ToolKind, AddingOneIsOneClass) {
  add_tool_kind(std::make_unique<Gripped>());
  const Block block = make_block(Law::neo_hookean);
  InteractionSpec spec = bonded_patch_spec(block.scene.body.mesh, {}, block.corner, 0.004);
  spec.kind = kGripped;
  EXPECT_EQ(spec.name(), "the grip at node " + std::to_string(block.corner));
  EXPECT_FALSE(spec.presses());
  EXPECT_EQ(spec.touching_radius(), 0.008);
  EXPECT_EQ(spec.shown_shape().shape, ToolShape::capsule);
  InteractionFactory tools(block.scene.body, {});
  EXPECT_EQ(tools.make(spec)->num_coordinates(), 3);
  EXPECT_EQ(tools.clearance(spec), nullptr);
  EXPECT_THROW(add_tool_kind(std::make_unique<Gripped>()), InputError) << "The number is taken.";
}

TEST(ToolKind, AnUnknownOneIsRefused) {
  InteractionSpec spec;
  spec.kind = static_cast<InteractionKind>(7);
  EXPECT_THROW((void)spec.name(), InputError);
  InteractionFactory tools(make_block(Law::neo_hookean).scene.body, {});
  EXPECT_THROW((void)tools.make(spec), InputError);
  EXPECT_THROW((void)tools.clearance(spec), InputError);
}

}  // namespace
}  // namespace palpate::test::test_tool_kind
