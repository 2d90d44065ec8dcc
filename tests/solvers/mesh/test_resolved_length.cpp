// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/resolved_length.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "solvers/support/box_mesh.h"

namespace palpate::test::test_resolved_length {
namespace {

const Vec3 kSides(0.2, 0.1, 0.1);

TetMesh make_body() { return test::make_box(ElementOrder::linear, {2, 1, 1}, kSides); }

TEST(ResolvedLength, TheSizeOfABodyIsItsDiagonal) {
  EXPECT_DOUBLE_EQ(size_of(make_body()), kSides.norm());
  EXPECT_EQ(size_of(TetMesh()), 0);
}

TEST(ResolvedLength, TakesWhatIsToldFromNone) {
  const TetMesh body = make_body();
  for (const double length : {1e-9, 1e-3, 1.0, 1e300}) {
    EXPECT_NO_THROW(check_resolved(body, "The depth", length)) << length;
  }
  for (const double length : {1e-11, 1e-300, 0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(check_resolved(body, "The depth", length), InputError) << length;
  }
}

// Beside coordinates of thousands of kilometres a nanometre is rounded away.
TEST(ResolvedLength, FarFromTheOriginLessIsTold) {
  TetMesh far = make_body();
  for (Vec3& point : far.points) point.x() += 1e6;
  EXPECT_THROW(check_resolved(far, "The depth", 1e-9), InputError);
  EXPECT_NO_THROW(check_resolved(far, "The depth", 2e-3));
}

TEST(ResolvedLength, SaysWhatAndHowMuch) {
  try {
    check_resolved(make_body(), "The depth (Depth)", 1e-300);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "The depth (Depth) is 1e-300 m, too small to be told from 0 beside a body whose "
                 "points are at up to 0.2 m. Give 2.44949e-10 m or more; lengths are in m.");
  }
}

TEST(ResolvedLength, TooLargeIsWhatRoundsTheBodyAway) {
  const TetMesh body = make_body();
  EXPECT_NO_THROW(check_not_too_large(body, "The radius", 1e5));
  for (const double length : {1e6, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(check_not_too_large(body, "The radius", length), InputError) << length;
  }
}

}  // namespace
}  // namespace palpate::test::test_resolved_length
