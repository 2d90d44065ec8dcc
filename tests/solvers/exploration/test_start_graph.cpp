// SPDX-License-Identifier: BSD-3-Clause
// Check-points that each have an owner, on simulated ranks: transitions that fail, starts beyond
// the force limit, and what an earlier run has left.
#include "exploration/start_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "exploration/engine.h"
#include "schedule/owner.h"
#include "solvers/support/simulation.h"

namespace palpate::test::test_start_graph {
namespace {

constexpr std::int32_t kWidth = 9;
constexpr std::int32_t kLayers = 5;
constexpr double kLimit = 1;

std::uint64_t any_number(const CheckPoint& a, const CheckPoint& b) {
  std::uint64_t key = 2008;
  for (const CheckPoint& p : {a, b}) {
    for (const std::int32_t x : p) key = mix(key) ^ static_cast<std::uint32_t>(x);
  }
  return mix(key);
}

/// A third of all transitions fail, and of all check-points an eighth is beyond the force limit.
bool fails(const CheckPoint& start, const CheckPoint& target) {
  return any_number(start, target) % 3 == 0;
}
bool is_beyond_limit(const CheckPoint& p) { return p[2] > 0 && any_number(p, p) % 8 == 1; }

/// From a column that is neither in the middle nor one of the first.
double distance(const CheckPoint& p) { return std::hypot(p[0] - 6, p[1] - 5); }

/// Layers one below the other. Those of the first are reached from none, those of others from three
/// above.
std::vector<StartGraph::Target> make_targets() {
  std::vector<StartGraph::Target> targets;
  for (std::int32_t z = 0; z < kLayers; ++z) {
    for (std::int32_t x = 0; x < kWidth; ++x) {
      for (std::int32_t y = 0; y < kWidth; ++y) {
        StartGraph::Target& target = targets.emplace_back();
        target.check_point = {x, y, z};
        target.distance = distance(target.check_point);
        if (z == 0) {
          target.starts = {target.check_point};
          continue;
        }
        for (const std::int32_t step : {0, 1, -1}) {
          if (x + step >= 0 && x + step < kWidth) target.starts.push_back({x + step, y, z - 1});
        }
      }
    }
  }
  return targets;
}

/// What is found at each check-point: the start it is found from, or none.
class Expected {
 public:
  explicit Expected(const std::vector<StartGraph::Target>& targets) {
    for (const StartGraph::Target& target : targets) find(target);
  }

  std::map<CheckPoint, CheckPoint> parent;

 private:
  void find(const StartGraph::Target& target) {
    const CheckPoint& p = target.check_point;
    bool is_beyond = false;
    bool tried_none = false;
    for (const CheckPoint& start : target.starts) {
      if (start == p) tried_none = true;
      const bool is_found = start == p || parent.count(start) > 0;
      if (start != p && (is_found ? is_beyond_limit(start) : beyond_.count(start) > 0)) {
        is_beyond = true;
      }
      if (!is_found || (start != p && is_beyond_limit(start))) continue;
      if (fails(start, p)) continue;
      parent[p] = start;
      return;
    }
    if (is_beyond) {
      beyond_.insert(p);
    } else if (!tried_none && !fails(p, p)) {
      parent[p] = p;
    }
  }

  /// What was given up since a start is beyond the force limit.
  std::set<CheckPoint> beyond_;
};

class FailingSolver final : public StateSolver {
 public:
  FailingSolver(test::Simulation& simulation, int rank, Monitor& monitor)
      : simulation_(simulation), rank_(rank), monitor_(monitor) {}

  [[nodiscard]] Equilibrium begin(const ToolSpaceSetup& /*setup*/, const Eigen::VectorXd& t,
                                  Tangent /*tangent*/) override {
    return find(t, t);
  }
  [[nodiscard]] Equilibrium solve(const ToolSpaceSetup& /*setup*/, const Eigen::VectorXd& t,
                                  const Equilibrium& start, Tangent /*tangent*/) override {
    return find(start.t, t);
  }
  void forget(const ToolSpaceSetup& /*setup*/, const Equilibrium& /*state*/) override {}

 private:
  static CheckPoint check_point(const Eigen::VectorXd& t) {
    CheckPoint p{};
    for (int k = 0; k < 3; ++k) p[k] = static_cast<std::int32_t>(std::lround(t[k]));
    return p;
  }
  Equilibrium find(const Eigen::VectorXd& from, const Eigen::VectorXd& t) {
    const CheckPoint start = check_point(from);
    const CheckPoint target = check_point(t);
    simulation_.work_on(rank_, 1e-3 * static_cast<double>(1 + any_number(target, start) % 50));
    Equilibrium e;
    e.t = t;
    e.reaction = Vec3(is_beyond_limit(target) ? 2 * kLimit : 0, 0, 0);
    e.stiffness = Mat3::Identity();
    e.outcome = fails(start, target) ? Outcome::not_converged : Outcome::converged;
    if (!monitor_.go_on()) e.outcome = Outcome::aborted;
    return e;
  }

  test::Simulation& simulation_;
  int rank_;
  Monitor& monitor_;
};

/// Rank 0 knows what an earlier run has left.
class KeptRecord final : public Record {
 public:
  KeptRecord(const std::vector<ConfigurationSummary>& left, int rank, const Network& network)
      : left_(rank == 0 ? left : std::vector<ConfigurationSummary>()), network_(network) {}

  [[nodiscard]] Known known(ToolSpaceKey /*tool_space*/) const override { return {left_, {}}; }
  [[nodiscard]] std::vector<std::string> damaged() const override { return {}; }
  void keep(ToolSpaceKey, const Configuration& found,
            const std::vector<IntermediateState>&) override {
    kept.push_back(found);
    kept_at[found.check_point] = network_.now();
  }
  void keep(ToolSpaceKey, const LevelTransition&) override {}
  void settle(ToolSpaceKey, const ConfigurationSummary&, std::int32_t) override {}
  [[nodiscard]] Configuration load(ToolSpaceKey,
                                   const ConfigurationSummary& summary) const override {
    const auto is_it = [&](const auto& c) { return c.check_point == summary.check_point; };
    EXPECT_TRUE(std::any_of(kept.begin(), kept.end(), is_it) ||
                std::any_of(left_.begin(), left_.end(), is_it))
        << "this rank has no such configuration";
    return {summary, {}, {}, {}, {}};
  }
  [[nodiscard]] TouchSpace publish(double) override { return {}; }
  void resume() override {}
  [[nodiscard]] bool has_moved() const override { return false; }
  [[nodiscard]] TouchSpace finish(bool, double) override { return {}; }

  std::vector<ConfigurationSummary> kept;
  /// When, s.
  std::map<CheckPoint, double> kept_at;

 private:
  std::vector<ConfigurationSummary> left_;
  const Network& network_;
};

struct Explored {
  std::vector<ConfigurationSummary> kept;
  std::map<CheckPoint, double> kept_at;
  std::int64_t num_solved = 0;
  std::int64_t num_reused = 0;
};

Explored explore(int num_ranks, const std::vector<ConfigurationSummary>& left) {
  ToolSpaceSetup setup;
  setup.grid.half_width = 500;
  setup.grid.resolution = 1001;
  setup.policy.force_limit = kLimit;
  const std::vector<PlannedSpace> spaces{
      {setup, std::make_shared<StartGraph>(setup.key(), make_targets())}};
  test::Simulation simulation(num_ranks, {});
  std::deque<Monitor> monitors;
  std::deque<FailingSolver> solvers;
  std::deque<KeptRecord> records;
  std::deque<PrecomputeReport> reports;
  std::deque<Engine> engines;
  std::vector<Worker*> workers;
  for (int r = 0; r < num_ranks; ++r) {
    Network& network = simulation.network(r);
    Monitor& monitor = monitors.emplace_back(nullptr, network);
    workers.push_back(&engines.emplace_back(spaces, solvers.emplace_back(simulation, r, monitor),
                                            records.emplace_back(left, r, network), network,
                                            monitor, reports.emplace_back()));
  }
  EXPECT_TRUE(simulation.run(workers));
  Explored run;
  for (int r = 0; r < num_ranks; ++r) {
    run.kept.insert(run.kept.end(), records[r].kept.begin(), records[r].kept.end());
    run.kept_at.merge(records[r].kept_at);
    run.num_solved += reports[r].num_solved;
    run.num_reused += reports[r].num_reused;
  }
  std::sort(run.kept.begin(), run.kept.end());
  return run;
}

std::map<CheckPoint, CheckPoint> parents_of(const std::vector<ConfigurationSummary>& found) {
  std::map<CheckPoint, CheckPoint> parents;
  for (const ConfigurationSummary& c : found) {
    if (c.usable()) parents[c.check_point] = c.parent;
  }
  return parents;
}

TEST(StartGraph, EachTargetIsFoundFromItsBestStartThatLeadsOn) {
  const Expected expected(make_targets());
  // Not all are found, and not all of those from their first start.
  ASSERT_LT(expected.parent.size(), make_targets().size());
  for (const int ranks : {1, 2, 7, 64}) {
    const Explored run = explore(ranks, {});
    EXPECT_TRUE(parents_of(run.kept) == expected.parent) << ranks << " ranks";
  }
}

TEST(StartGraph, GrowsFromWhereItBegins) {
  const std::vector<ConfigurationSummary> all = explore(1, {}).kept;
  // What is interrupted is not left until the end.
  std::vector<ConfigurationSummary> first_layers;
  std::copy_if(all.begin(), all.end(), std::back_inserter(first_layers),
               [](const auto& c) { return c.usable() && c.check_point[2] < 2; });
  for (const auto& left : {std::vector<ConfigurationSummary>(), first_layers}) {
    for (const int ranks : {1, 2, 3}) {
      const std::map<CheckPoint, double> kept_at = explore(ranks, left).kept_at;
      double last = 0;
      for (const auto& [p, seconds] : kept_at) last = std::max(last, seconds);
      int num_near = 0;
      int num_early = 0;
      for (const auto& [p, seconds] : kept_at) {
        if (distance(p) > 1.5) continue;
        ++num_near;
        if (seconds < last / 3) ++num_early;
      }
      // The others wait for starts that are farther away, since the nearer failed.
      EXPECT_GT(num_early, 0.75 * num_near) << ranks << " ranks";
    }
  }
}

TEST(StartGraph, WhatIsKnownIsNotSoughtAgain) {
  const Expected expected(make_targets());
  const std::vector<ConfigurationSummary> all = explore(1, {}).kept;
  for (const std::uint64_t share : {2, 10}) {
    std::vector<ConfigurationSummary> left;
    // Nothing is kept before the starts that it is tried from, which are in the layer above.
    std::map<CheckPoint, ConfigurationSummary> found;
    for (const ConfigurationSummary& c : all) {
      if (c.usable()) found[c.check_point] = c;
    }
    std::set<CheckPoint> kept;
    for (const StartGraph::Target& target : make_targets()) {
      const CheckPoint& p = target.check_point;
      if (found.count(p) == 0 || any_number(p, {}) % share == 0) continue;
      const bool is_whole =
          std::all_of(target.starts.begin(), target.starts.end(), [&](const CheckPoint& start) {
            return start == p || found.count(start) == 0 || kept.count(start) > 0;
          });
      if (!is_whole) continue;
      kept.insert(p);
      left.push_back(found.at(p));
    }
    for (const int ranks : {1, 3, 16}) {
      const Explored run = explore(ranks, left);
      EXPECT_EQ(run.num_reused, static_cast<std::int64_t>(left.size()));
      EXPECT_EQ(run.kept.size(), all.size() - left.size());
      auto together = parents_of(run.kept);
      together.merge(parents_of(left));
      EXPECT_TRUE(together == expected.parent) << ranks << " ranks";
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_start_graph
