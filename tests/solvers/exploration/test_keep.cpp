// SPDX-License-Identifier: BSD-3-Clause
// What a finished space keeps of its fields, and that it can be enlarged all the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "base/error.h"
#include "exploration/precompute.h"
#include "solvers/exploration/pressed_corner.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"
#include "solvers/support/world_folder.h"
#include "storage/field_cache.h"
#include "storage/state_space_file.h"

namespace palpate::test::test_keep {
namespace {

namespace fs = std::filesystem;

class Kept : public testing::Test {
 protected:
  void SetUp() override {
    options_.active_nodes = {block_.corner, block_.middle};
    options_.half_width = 0.01;
    options_.resolution = 3;
    options_.history = History::flat;
  }

  PrecomputeResult run(Keep keep, const std::string& name) {
    options_.keep = keep;
    options_.file = file(name);
    return precompute(block_.scene, options_, *world_, progress_);
  }
  [[nodiscard]] fs::path file(const std::string& name) const {
    return folder_ / (name + ".palpate");
  }

  void press() {
    block_ = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}});
    test::press_corner_of_block(options_, 0.08);
  }

  /// The same equilibria, to the solver's tolerance.
  static void expect_alike(const TouchToolSpace& a, const TouchToolSpace& b) {
    constexpr double kAgreement = 1e-7;
    ASSERT_EQ(a.configurations.size(), b.configurations.size());
    const double largest = largest_force(a.configurations);
    for (std::size_t i = 0; i < a.configurations.size(); ++i) {
      const ConfigurationSummary& c = a.configurations[i];
      const ConfigurationSummary& d = b.configurations[i];
      EXPECT_EQ(c.check_point, d.check_point);
      EXPECT_EQ(c.outcome, d.outcome);
      EXPECT_LE((c.force - d.force).norm(), kAgreement * largest);
    }
  }

  /// The reduced fields of a file are those of one that has kept all, at the points that are kept.
  void expect_right_fields(const std::string& reduced, const std::string& whole, Keep keep) const {
    const StateSpaceFile of = StateSpaceFile::open_read_only(file(reduced));
    const StateSpaceFile from = StateSpaceFile::open_read_only(file(whole));
    EXPECT_EQ(of.bases().keep(), keep);
    EXPECT_EQ(from.bases().keep(), Keep::all);
    const Surface surface = make_surface(block_.scene.body.mesh);
    const std::vector<Index> points = kept_points(block_.scene.body.mesh, surface, keep);
    for (const ToolSpace& space : from.read_tool_spaces()) {
      double largest = 0;
      double error = 0;
      for (Configuration c : from.read_summaries({space.setup.id})) {
        Configuration r = c;
        ASSERT_TRUE(from.read_fields({space.setup.id}, c));
        ASSERT_TRUE(of.read_fields({space.setup.id}, r));
        ASSERT_EQ(r.u.size(), c.u.size());
        if (c.u.size() == 0) continue;
        NodalVector rest = r.u;
        for (const Index p : points) {
          largest = std::max(largest, c.u.segment<3>(3 * p).norm());
          error = std::max(error, (r.u - c.u).segment<3>(3 * p).norm());
          rest.segment<3>(3 * p).setZero();
        }
        EXPECT_TRUE(rest.isZero(0)) << "at points that are not kept";
        if (keep == Keep::touch) {
          EXPECT_EQ(r.p.size(), 0);
        } else {
          ASSERT_EQ(r.p.size(), c.p.size());
        }
      }
      EXPECT_LE(error, kDefaultTouchBound * largest);
      EXPECT_GT(error, 0);
    }
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  test::WorldFolder folder_{*world_};
  test::Block block_ = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {4, 3, 3}});
  PrecomputeOptions options_;
  Progress progress_;
};

TEST_F(Kept, FilesOfActiveNodesAreReduced) {
  const PrecomputeResult all = run(Keep::all, "all");
  for (const Keep keep : {Keep::touch, Keep::surface}) {
    const PrecomputeResult reduced = run(keep, name_of(keep));
    EXPECT_TRUE(reduced.report.complete);
    if (world_->rank() != 0) continue;
    expect_right_fields(name_of(keep), "all", keep);
    EXPECT_LT(4 * fs::file_size(file(name_of(keep))), fs::file_size(file("all")));
    ASSERT_EQ(reduced.space.tool_spaces.size(), 2U);
    for (std::size_t s = 0; s < 2; ++s) {
      expect_alike(reduced.space.tool_spaces[s], all.space.tool_spaces[s]);
    }
    EXPECT_LE(reduced.space.displacement_error,
              kDefaultTouchBound * reduced.space.largest_displacement);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()),
              keep == Keep::touch ? 2 : 3)
        << "no rank has left a file";
  }
}

TEST_F(Kept, AFileOfMixedCellsHasItsPressures) {
  block_ =
      test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}, 0.1, 3000, 0.499});
  options_.active_nodes = {block_.corner};
  options_.half_width = 0.005;
  (void)run(Keep::all, "all");
  (void)run(Keep::surface, "surface");
  if (world_->rank() == 0) {
    expect_right_fields("surface", "all", Keep::surface);
    const StateSpaceFile all = StateSpaceFile::open_read_only(file("all"));
    const StateSpaceFile surface = StateSpaceFile::open_read_only(file("surface"));
    double largest = 0;
    double error = 0;
    for (Configuration c : all.read_summaries({block_.corner})) {
      Configuration r = c;
      ASSERT_TRUE(all.read_fields({block_.corner}, c));
      ASSERT_TRUE(surface.read_fields({block_.corner}, r));
      largest = std::max(largest, c.p.cwiseAbs().maxCoeff());
      error = std::max(error, (r.p - c.p).cwiseAbs().maxCoeff());
    }
    EXPECT_LE(error, kDefaultTouchBound * largest);
  }
  options_.resolution = 5;
  options_.half_width = 0.01;
  const PrecomputeResult grown = run(Keep::surface, "surface");
  const PrecomputeResult whole = run(Keep::all, "all");
  EXPECT_EQ(grown.report.num_reused, 27);
  if (world_->rank() != 0) return;
  expect_alike(grown.space.tool_spaces[0], whole.space.tool_spaces[0]);
}

TEST_F(Kept, AReducedSpaceIsEnlargedToTheSolversTolerance) {
  block_ = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}});
  options_.active_nodes = {block_.corner};
  options_.resolution = 5;
  options_.half_width = 0.02;
  const PrecomputeResult at_once = run(Keep::all, "at_once");
  for (const Keep keep : {Keep::touch, Keep::surface, Keep::all}) {
    options_.resolution = 3;
    options_.half_width = 0.01;  // the same spacing
    (void)run(keep, name_of(keep));
    options_.resolution = 5;
    options_.half_width = 0.02;
    const PrecomputeResult grown = run(keep, name_of(keep));
    EXPECT_EQ(grown.report.num_reused, 27);
    EXPECT_EQ(grown.report.num_solved, 125 - 27);
    EXPECT_TRUE(grown.report.complete);
    if (world_->rank() != 0) continue;
    expect_alike(grown.space.tool_spaces[0], at_once.space.tool_spaces[0]);
    if (keep < Keep::all) expect_right_fields(name_of(keep), "at_once", keep);
  }
}

TEST_F(Kept, ARunThatIsCompleteIsReducedByTheNext) {
  (void)run(Keep::all, "a");
  const std::uintmax_t large = world_->rank() == 0 ? fs::file_size(file("a")) : 0;
  agree(*world_, [] {});
  const PrecomputeResult again = run(Keep::surface, "a");
  EXPECT_EQ(again.report.num_solved, 0);
  EXPECT_EQ(again.report.num_reused, 54);
  if (world_->rank() == 0) {
    EXPECT_LT(4 * fs::file_size(file("a")), large);
  }
}

TEST_F(Kept, UntilNothingIsLeftToFindAllIsKept) {
  progress_ = [](const ProgressState& state) { return state.share() < 0.5; };
  const PrecomputeResult part = run(Keep::surface, "a");
  EXPECT_FALSE(part.report.complete);
  if (world_->rank() == 0) {
    EXPECT_EQ(StateSpaceFile::open_read_only(file("a")).bases().keep(), Keep::all);
    EXPECT_GT(part.space.tool_spaces[0].modes.cols(), 0);
  }
  progress_ = nullptr;
  agree(*world_, [] {});
  const PrecomputeResult rest = run(Keep::surface, "a");
  EXPECT_TRUE(rest.report.complete);
  EXPECT_EQ(rest.report.num_solved + rest.report.num_reused, 54);
}

TEST_F(Kept, WhatWasLeftOutIsNotAskedForAgain) {
  (void)run(Keep::touch, "a");
  std::string message;
  try {
    (void)run(Keep::surface, "a");
  } catch (const InputError& error) {
    message = error.what();
  }
  EXPECT_NE(message.find("Keep is Touch"), std::string::npos) << message;
  EXPECT_NE(message.find("Ask for Touch"), std::string::npos) << message;
}

TEST_F(Kept, TheSpaceOfARigidToolIsReducedAndEnlarged) {
  press();
  const PrecomputeResult all = run(Keep::all, "all");
  options_.contact->shell.depth = 0.002;
  (void)run(Keep::touch, "touch");
  options_.contact->shell.depth = 0.004;
  const PrecomputeResult grown = run(Keep::touch, "touch");
  EXPECT_GT(grown.report.num_solved, 0);
  if (world_->rank() != 0) return;
  expect_alike(grown.space.tool_spaces[0], all.space.tool_spaces[0]);
  expect_right_fields("touch", "all", Keep::touch);
  EXPECT_LT(3 * fs::file_size(file("touch")), fs::file_size(file("all")));
}

TEST_F(Kept, MoreThanIsKeptIsRefusedWithASentence) {
  (void)run(Keep::surface, "a");
  if (world_->rank() != 0) return;
  const StateSpaceFile a = StateSpaceFile::open_read_only(file("a"));
  FieldCache fields(file("a"), a.scene_hash());
  const ToolSpace space = a.read_tool_spaces().front();
  const ConfigurationSummary c = a.read_summaries({space.setup.id}).front();
  NodalVector u;
  NodalVector p;
  fields.add_up(space.setup, {{c, 1, Vec3::Zero()}}, Keep::surface, u, p);
  EXPECT_GT(u.norm(), 0);
  try {
    fields.add_up(space.setup, {{c, 1, Vec3::Zero()}}, Keep::all, u, p);
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("Keep All"), std::string::npos) << error.what();
  }
}

TEST_F(Kept, ASceneThatIsAnotherBodyOfTheFileIsRefused) {
  const test::Block other =
      test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}});
  if (world_->rank() == 0) {
    StateSpaceFile two = StateSpaceFile::create(file("two"), other.scene, 1e-10);
    EXPECT_EQ(two.add_body(block_.scene), 2);
    two.close();
  }
  options_.equilibrium.tolerance = 1e-10;
  options_.file = file("two");
  EXPECT_THROW((void)precompute(block_.scene, options_, *world_, progress_), InputError);
}

}  // namespace
}  // namespace palpate::test::test_keep
