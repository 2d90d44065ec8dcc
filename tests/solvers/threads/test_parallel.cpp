// SPDX-License-Identifier: BSD-3-Clause
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <vector>

namespace palpate::test::test_parallel {
namespace {

/// Runs the parts backwards, and counts its loops.
class BackwardTeam final : public Team {
 public:
  void serve(DoWork do_work, void* work) override { do_work(work); }
  void run(Index num_parts, RunPart run_part, void* loop) override {
    ++num_loops;
    for (Index part = num_parts - 1; part >= 0; --part) run_part(loop, part);
  }
  int num_loops = 0;
};

TEST(Parallel, RangesCoverASequenceOnce) {
  for (const Index count : {0, 1, 4095, 4096, 5000, 100'000, 1'000'001, 2'000'000'000}) {
    const Ranges ranges(count, kNodesOfPart);
    EXPECT_EQ(ranges.first(0), 0);
    EXPECT_EQ(ranges.first(ranges.num_parts()), count);
    EXPECT_LE(ranges.num_parts(), Ranges::kMostParts);
    for (Index part = 0; part < ranges.num_parts(); ++part) {
      const Index length = ranges.first(part + 1) - ranges.first(part);
      EXPECT_GE(length, std::min(count, kNodesOfPart));
    }
  }
}

TEST(Parallel, ABodyWithAFactorIsOnePart) {
  constexpr Index kNodesOfTenThousandUnknowns = 3334;
  EXPECT_EQ(Ranges(kNodesOfTenThousandUnknowns, kNodesOfPart).num_parts(), 1);
  EXPECT_EQ(Ranges(2 * kNodesOfPart - 1, kNodesOfPart).num_parts(), 1);
  EXPECT_EQ(Ranges(2 * kNodesOfPart, kNodesOfPart).num_parts(), 2);
}

TEST(Parallel, WithoutATeamPartsRunInOrder) {
  std::vector<Index> seen;
  for_each_part(3, [&](Index part) { seen.push_back(part); });
  EXPECT_EQ(seen, (std::vector<Index>{0, 1, 2}));
  for_each_part(0, [&](Index part) { seen.push_back(part); });
  EXPECT_EQ(seen.size(), 3U);
}

TEST(Parallel, ATeamServesItsWorkAlone) {
  BackwardTeam team;
  std::vector<Index> seen;
  const auto run = [&](Index num_parts) {
    seen.clear();
    for_each_part(num_parts, [&](Index part) { seen.push_back(part); });
    return seen;
  };
  with_team(&team, [&] {
    EXPECT_EQ(run(3), (std::vector<Index>{2, 1, 0}));
    with_team(nullptr, [&] { EXPECT_EQ(run(3), (std::vector<Index>{0, 1, 2})); });
    EXPECT_EQ(run(2), (std::vector<Index>{1, 0}));
  });
  EXPECT_EQ(run(3), (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(team.num_loops, 2);
}

TEST(Parallel, OnePartNeedsNoTeam) {
  BackwardTeam team;
  Index seen = -1;
  with_team(&team, [&] { for_each_part(1, [&](Index part) { seen = part; }); });
  EXPECT_EQ(seen, 0);
  EXPECT_EQ(team.num_loops, 0);
}

}  // namespace
}  // namespace palpate::test::test_parallel
