// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/level_search.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>
#include <vector>

namespace palpate::test::test_level_search {
namespace {

constexpr CheckPoint kLeft{-1, 0, 0};
constexpr CheckPoint kMiddle{0, 0, 0};
constexpr CheckPoint kRight{1, 0, 0};

ConfigurationSummary with_force(const CheckPoint& p, double force) {
  ConfigurationSummary c;
  c.check_point = p;
  c.outcome = Outcome::converged;
  c.parent = p;
  c.t = Vec3(p[0], p[1], p[2]);
  c.force = Vec3(force, 0, 0);
  return c;
}

/// Three places in a row. In the middle the body is another one than in the flat space if the tool
/// comes from the left, and a third one if it comes from the right.
LevelSearch begin() {
  LevelSearch search({[](const CheckPoint& p) {
                        if (p != kMiddle) return std::vector<CheckPoint>{kMiddle};
                        return std::vector<CheckPoint>{kLeft, kRight};
                      },
                      [](const ConfigurationSummary& /*found*/) { return 1; }, 1});
  for (const CheckPoint& p : {kLeft, kMiddle, kRight}) search.accept(with_force(p, 1));
  search.suspect(kLeft, kMiddle);
  search.suspect(kRight, kMiddle);
  return search;
}

/// What a run has written, if nothing of it is lost.
struct Record {
  std::vector<ConfigurationSummary> levels;
  std::vector<LevelTransition> transitions;
};

struct Finished {
  Record record;
  std::multiset<std::pair<CheckPoint, CheckPoint>> made;
};

Finished finish(LevelSearch search) {
  Finished run;
  std::map<std::pair<CheckPoint, std::int32_t>, ConfigurationSummary> candidates;
  while (true) {
    const std::vector<Transition> round = search.next();
    for (const Settlement& s : search.settled()) {
      const LevelTransition& t = s.transition;
      run.record.transitions.push_back(t);
      if (!s.is_new) continue;
      ConfigurationSummary found =
          candidates.at({t.target, candidate_level(t.start, t.start_level, t.target)});
      found.level = t.reached;
      run.record.levels.push_back(found);
    }
    if (round.empty()) return run;
    for (const Transition& t : round) {
      run.made.insert({t.start, t.target});
      const double force = t.target != kMiddle ? 1 : t.start == kLeft ? 2 : 3;
      ConfigurationSummary found = with_force(t.target, force);
      found.parent = t.start;
      found.parent_level = t.start_level;
      found.level = candidate_level(t.start, t.start_level, t.target);
      candidates[{t.target, found.level}] = found;
      search.accept(found);
    }
  }
}

std::set<std::pair<std::int32_t, double>> levels_of(const Record& record) {
  std::set<std::pair<std::int32_t, double>> levels;
  for (const ConfigurationSummary& c : record.levels) levels.emplace(c.level, c.force.x());
  return levels;
}

TEST(LevelSearch, FindsALevelFromEachSide) {
  const Finished whole = finish(begin());
  EXPECT_EQ(levels_of(whole.record), (std::set<std::pair<std::int32_t, double>>{{1, 2}, {2, 3}}));
}

// The levels of a check-point are in the files of several ranks.
TEST(LevelSearch, ALevelThatWasLostHasItsNumberAgain) {
  const Finished whole = finish(begin());
  for (const ConfigurationSummary& lost : whole.record.levels) {
    LevelSearch search = begin();
    Record record;
    for (const LevelTransition& t : whole.record.transitions) {
      if (t.target != lost.check_point || t.reached != lost.level) search.recall(t);
    }
    for (const ConfigurationSummary& kept : whole.record.levels) {
      if (kept.level == lost.level) continue;
      search.recall(kept);
      record.levels.push_back(kept);
    }
    Finished resumed = finish(std::move(search));
    resumed.record.levels.insert(resumed.record.levels.end(), record.levels.begin(),
                                 record.levels.end());
    EXPECT_EQ(levels_of(resumed.record), levels_of(whole.record));
    EXPECT_EQ(resumed.made.size(), 1U);
  }
}

}  // namespace
}  // namespace palpate::test::test_level_search
