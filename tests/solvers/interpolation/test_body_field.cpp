// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/body_field.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "interpolation/display_field.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/contact_space.h"
#include "solvers/state_space/example_space.h"
#include "storage/field_cache.h"
#include "storage/state_space_file.h"

namespace palpate::test::test_body_field {
namespace {

using test::analytic_space;
using test::exponential;
using test::kHalfWidth;

constexpr double kTolerance = 1e-8;
/// Of DisplayField, whose numbers are of single precision.
constexpr double kSingle = 1e-5;

class BodyFieldTest : public testing::Test {
 protected:
  BodyFieldTest() {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
  }
  ~BodyFieldTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path path() const { return folder_ / "space.palpate"; }

  /// Gives the usable configurations random fields, in the file and as the coefficients of a mode
  /// for each unknown; pressures that are the first of u.
  void write(TouchToolSpace& tool_space) {
    std::filesystem::remove(path());
    StateSpaceFile file = StateSpaceFile::create(path(), scene_, kTolerance);
    file.add_tool_space(tool_space.setup);
    const Eigen::Index rows = 3 * Eigen::Index{scene_.body.mesh.num_points()};
    const auto count = static_cast<Eigen::Index>(tool_space.configurations.size());
    tool_space.coefficients.setZero(rows, count);
    tool_space.coefficient_gradients.setZero(3 * rows, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      Configuration c;
      static_cast<ConfigurationSummary&>(c) =
          tool_space.configurations[static_cast<std::size_t>(i)];
      if (c.usable()) {
        c.u = Eigen::VectorXd::Random(rows);
        c.v = 100 * Eigen::MatrixXd::Random(rows, 3);
        c.p = c.u.head(kPressures);
        c.p_v = c.v.topRows(kPressures);
        tool_space.coefficients.col(i) = c.u.cast<float>();
        tool_space.coefficient_gradients.col(i) = c.v.reshaped().cast<float>();
      }
      file.add({tool_space.setup.id}, c);
    }
    file.close();
  }

  /// Of the body.
  static constexpr Eigen::Index kPressures = 7;
  Scene scene_ = test::cube_scene(1, ElementOrder::linear);
  std::filesystem::path folder_;
};

// Beside holes, across cells of different size and outside the box, too.
TEST_F(BodyFieldTest, IsTheDisplayFieldOfAllPoints) {
  TouchToolSpace holes = analytic_space(exponential);
  test::make_holes(holes, 0.2);
  for (TouchToolSpace tool_space :
       {analytic_space(exponential, 1), holes, test::graded_space(exponential, 5, 2),
        test::unbalanced_space(exponential)}) {
    write(tool_space);
    const BodyField field(tool_space);
    const DisplayField expected(tool_space);
    // Some of them are read again and again.
    FieldCache fields(path(), hash(scene_), 100000);
    Eigen::VectorXf c(expected.num_modes());
    NodalVector u;
    NodalVector p;
    test::RandomPoints points(1.3 * kHalfWidth);
    for (int i = 0; i < 200; ++i) {
      const Vec3 t = points();
      const Support support = expected.coefficients(t, c.data());
      EXPECT_EQ(field.evaluate(t, fields, Keep::all, u, p), support);
      ASSERT_LT((u - c.cast<double>()).lpNorm<Eigen::Infinity>(), kSingle) << t.transpose();
      EXPECT_EQ(p, u.head(kPressures));
    }
    EXPECT_EQ(field.evaluate(Vec3::Constant(std::nan("")), fields, Keep::all, u, p), Support::none);
    EXPECT_EQ(u.size(), 0);
    EXPECT_EQ(field.evaluate(Vec3::Constant(1e308), fields, Keep::all, u, p), Support::none);
    EXPECT_EQ(p.size(), 0);
  }
}

TEST_F(BodyFieldTest, ReadsWhatItNeedsOnce) {
  TouchToolSpace tool_space = analytic_space(exponential);
  write(tool_space);
  const BodyField field(tool_space);
  FieldCache fields(path(), hash(scene_));
  NodalVector u;
  NodalVector p;
  const double h = tool_space.setup.grid.spacing();
  field.evaluate(Vec3(0.2 * h, 0.3 * h, 0.4 * h), fields, Keep::all, u, p);
  std::filesystem::remove(path());
  EXPECT_EQ(field.evaluate(Vec3(0.7 * h, 0.6 * h, 0.1 * h), fields, Keep::all, u, p),
            Support::inside);
  EXPECT_THROW(field.evaluate(Vec3(1.2 * h, 0.3 * h, 0.4 * h), fields, Keep::all, u, p),
               InputError);
  write(tool_space);
  EXPECT_EQ(field.evaluate(Vec3(1.2 * h, 0.3 * h, 0.4 * h), fields, Keep::all, u, p),
            Support::inside);
}

TEST_F(BodyFieldTest, TellsOfAFileThatIsNotItsOwn) {
  TouchToolSpace tool_space = analytic_space(exponential, 3);
  const BodyField field(tool_space);
  NodalVector u;
  NodalVector p;
  const auto message = [&](const std::string& scene_hash) -> std::string {
    FieldCache fields(path(), scene_hash);
    try {
      field.evaluate(Vec3::Constant(1e-3), fields, Keep::all, u, p);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  write(tool_space);
  EXPECT_EQ(message(hash(scene_)), "");
  EXPECT_NE(message("other").find("its scene is"), std::string::npos) << message("other");

  TouchToolSpace wider = tool_space;
  wider.setup.grid.half_width *= 2;
  for (ConfigurationSummary& c : wider.configurations) c.t *= 2;
  write(wider);
  EXPECT_NE(message(hash(scene_)).find("another tip or grid"), std::string::npos);

  TouchToolSpace failed = tool_space;
  for (ConfigurationSummary& c : failed.configurations) c.outcome = Outcome::not_converged;
  write(failed);
  EXPECT_NE(message(hash(scene_)).find("no displacement"), std::string::npos);
}

// A configuration that touches nothing is stored without fields: the body is at rest there.
TEST_F(BodyFieldTest, WhatTouchesNothingIsNotRead) {
  const test::ContactExample contact = test::slab(0.002);
  Grid grid;
  grid.half_width = kHalfWidth;
  grid.resolution = 7;
  grid.sparse = true;
  TouchToolSpace tool_space = test::contact_space(contact, grid, 0.006);
  write(tool_space);
  int free = 0;
  {
    StateSpaceFile file = StateSpaceFile::open_to_append(path(), scene_, kTolerance);
    for (std::size_t i = 0; i < tool_space.configurations.size(); ++i) {
      Configuration c;
      static_cast<ConfigurationSummary&>(c) = tool_space.configurations[i];
      if ((c.flags & flags::touches_nothing) == 0) continue;
      ++free;
      file.add({tool_space.setup.id}, c);
      tool_space.coefficients.col(static_cast<Eigen::Index>(i)).setZero();
      tool_space.coefficient_gradients.col(static_cast<Eigen::Index>(i)).setZero();
    }
    file.close();
  }
  EXPECT_GT(free, 20);
  const BodyField field(tool_space);
  const DisplayField expected(tool_space);
  FieldCache fields(path(), hash(scene_));
  Eigen::VectorXf c(expected.num_modes());
  Eigen::VectorXd u;
  Eigen::VectorXd p;
  int at_rest = 0;
  test::RandomPoints random;
  for (int i = 0; i < 300; ++i) {
    const Vec3 q = random();
    const Support support = field.evaluate(q, fields, Keep::all, u, p);
    EXPECT_EQ(support, expected.coefficients(q, c.data()));
    ASSERT_EQ(u.size(), c.size());
    EXPECT_LT((u - c.cast<double>()).norm(), kSingle * (1 + u.norm()));
    EXPECT_LT((p - u.head(kPressures)).norm(), 1e-12 * (1 + u.norm()));
    at_rest += u.isZero(0) ? 1 : 0;
  }
  EXPECT_GT(at_rest, 50);
}

}  // namespace
}  // namespace palpate::test::test_body_field
