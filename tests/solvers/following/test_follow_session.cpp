// SPDX-License-Identifier: BSD-3-Clause
// An exploration around a hand, whose explorers are in this process.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/error.h"
#include "exploration/precompute.h"
#include "following/follow_session.h"
#include "solvers/following/ball_on_block.h"
#include "solvers/support/message_of.h"
#include "solvers/support/world_folder.h"

namespace palpate::test::test_follow_session {
namespace {

using Found = std::map<CheckPoint, ConfigurationSummary>;

Found found_in(const TouchSpace& space) {
  Found found;
  for (const ConfigurationSummary& c : space.tool_spaces.front().configurations) {
    found.emplace(c.check_point, c);
  }
  return found;
}

/// Explores until nothing is left, or so many were solved for.
void explore(FollowSession& session, Explorer& explorer, std::int64_t at_most = 100'000) {
  while (session.figures().num_solved < at_most) {
    const std::optional<ExplorerTask> task = session.next();
    if (!task) return;
    // As it would go through a connection.
    ASSERT_TRUE(session.accept(unpack_result(pack(explorer.make(unpack_task(pack(*task)))))));
  }
}

void expect_same_where_both_are(const Found& some, const Found& all) {
  double largest = 0;
  for (const auto& [p, c] : all) largest = std::max(largest, c.force.norm());
  for (const auto& [p, c] : some) {
    ASSERT_EQ(all.count(p), 1u);
    const ConfigurationSummary& other = all.at(p);
    ASSERT_EQ(c.usable(), other.usable());
    // Beside a ridge there are several equilibria.
    if (!c.usable() || ((c.flags | other.flags) & flags::near_fold) != 0) continue;
    EXPECT_LT((c.force - other.force).norm(), 1e-6 * largest);
    EXPECT_LT((c.stiffness - other.stiffness).norm(), 1e-4 * (1 + other.stiffness.norm()));
  }
}

class FollowSessionTest : public testing::Test {
 protected:
  [[nodiscard]] std::unique_ptr<FollowSession> begin() const {
    auto session = std::make_unique<FollowSession>(ball_.scene, ball_.options);
    session->follow(ball_.hand());
    return session;
  }
  [[nodiscard]] Found offline() const {
    auto communicator = make_serial_communicator();
    PrecomputeOptions options = ball_.options;
    options.file.clear();
    return found_in(precompute(*ball_.scene, options, *communicator, {}).space);
  }

  BallOnBlock ball_;
};

TEST_F(FollowSessionTest, FindsWhatAnExplorationOfTheWholeFinds) {
  const auto session = begin();
  Explorer explorer(unpack_job(pack(session->job())));
  TouchSpace space = session->empty_space();
  std::int64_t num_chunks = 0;
  explore(*session, explorer, 20);
  EXPECT_EQ(session->figures().num_solved, 20);
  while (const auto chunk = session->take_chunk()) {
    take(*chunk, space);
    ++num_chunks;
  }
  EXPECT_GT(num_chunks, 0);
  const std::size_t first = found_in(space).size();
  EXPECT_GT(first, 15u);
  explore(*session, explorer);
  while (const auto chunk = session->take_chunk()) take(*chunk, space);
  const Found all = offline();
  EXPECT_GT(all.size(), first);
  EXPECT_EQ(found_in(space).size(), all.size());
  expect_same_where_both_are(found_in(space), all);
  EXPECT_EQ(session->figures().coverage.known, session->figures().coverage.needed);
  EXPECT_GT(session->figures().coverage.needed, 0);
}

TEST_F(FollowSessionTest, ALostTaskIsGivenAgainAndALateResultIsIgnored) {
  const auto session = begin();
  Explorer explorer(session->job());
  const std::optional<ExplorerTask> lost = session->next();
  ASSERT_TRUE(lost);
  session->lose(lost->number);
  const std::optional<ExplorerTask> again = session->next();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->transition.target, lost->transition.target);
  EXPECT_NE(again->number, lost->number);
  const ExplorerResult late = explorer.make(*lost);
  EXPECT_TRUE(session->accept(late));
  EXPECT_EQ(session->figures().num_solved, 0);
  EXPECT_TRUE(session->accept(explorer.make(*again)));
  EXPECT_EQ(session->figures().num_solved, 1);
}

TEST_F(FollowSessionTest, AResultThatWasNotAskedForIsRefusedAndItsTaskGivenAgain) {
  const auto session = begin();
  Explorer explorer(session->job());
  // One with fields.
  std::optional<ExplorerTask> task = session->next();
  ExplorerResult right = explorer.make(*task);
  while (right.found.u.size() == 0) {
    ASSERT_TRUE(session->accept(right));
    task = session->next();
    right = explorer.make(*task);
  }
  const std::int64_t solved = session->figures().num_solved;
  const auto refuses = [&](const auto& spoil) {
    ExplorerResult spoilt = right;
    spoil(spoilt.found);
    EXPECT_FALSE(session->accept(spoilt));
    const std::optional<ExplorerTask> again = session->next();
    ASSERT_TRUE(again);
    EXPECT_EQ(again->transition.target, right.found.check_point);
    right.number = again->number;
  };
  refuses([](Configuration& found) { found.check_point[0] += 1; });
  refuses([](Configuration& found) { found.force = Vec3::Constant(NAN); });
  refuses([](Configuration& found) { found.stiffness(0, 0) = INFINITY; });
  refuses([](Configuration& found) { found.u = Eigen::VectorXd::Zero(3); });
  refuses([](Configuration& found) { found.v = Eigen::MatrixXd::Zero(found.u.size(), 1); });
  refuses([](Configuration& found) { found.v(5, 1) = NAN; });
  refuses([](Configuration& found) { found.u.resize(0); });
  refuses([](Configuration& found) { found.t.x() += 1e-3; });
  EXPECT_EQ(session->figures().num_solved, solved);
  EXPECT_TRUE(session->accept(right));
  EXPECT_EQ(session->figures().num_solved, solved + 1);
}

TEST_F(FollowSessionTest, GoesOnWithAFileAndAWholeExplorationGoesOnWithItsFile) {
  const auto communicator = make_serial_communicator();
  const WorldFolder folder(*communicator);
  ball_.options.file = folder / "hand.palpate";
  std::int64_t first = 0;
  {
    const auto session = begin();
    Explorer explorer(session->job());
    explore(*session, explorer, 20);
    (void)session->finish();
    first = 20;
  }
  {
    const auto session = begin();
    Explorer explorer(session->job());
    explore(*session, explorer, 10);
    TouchSpace space = session->empty_space();
    while (const auto chunk = session->take_chunk()) take(*chunk, space);
    EXPECT_GE(found_in(space).size(), 25u);
    (void)session->finish();
    first += 10;
  }
  const PrecomputeResult whole = precompute(*ball_.scene, ball_.options, *communicator, {});
  EXPECT_TRUE(whole.report.complete);
  EXPECT_GE(whole.report.num_reused, 25);
  EXPECT_LE(whole.report.num_reused, first);
  expect_same_where_both_are(found_in(whole.space), offline());
  // Nothing is left for a hand.
  const auto session = begin();
  EXPECT_FALSE(session->next());
}

TEST_F(FollowSessionTest, SaysWhatCannotBeFollowed) {
  PrecomputeOptions options;
  options.half_width = 0.01;
  EXPECT_NE(message_of([&] { FollowSession(ball_.scene, options); }).find("rigid tool"),
            std::string::npos);
  options = ball_.options;
  options.intermediate_states = 2;
  EXPECT_NE(message_of([&] { FollowSession(ball_.scene, options); }).find("intermediate"),
            std::string::npos);
  options = ball_.options;
  options.contact->shell.region = [](const Vec3&) { return false; };
  EXPECT_NE(message_of([&] { FollowSession(ball_.scene, options); }).find("nothing to press"),
            std::string::npos);
}

TEST_F(FollowSessionTest, DamagedBytesAreRefused) {
  const auto session = begin();
  Explorer explorer(session->job());
  const std::optional<ExplorerTask> task = session->next();
  ASSERT_TRUE(task);
  const Bytes sound = pack(explorer.make(*task));
  for (std::size_t size = 0; size < sound.size(); size += 1 + sound.size() / 50) {
    const Bytes cut(sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW((void)unpack_result(cut), BackendError) << size;
  }
  Bytes longer = sound;
  longer.push_back(std::byte{0});
  EXPECT_THROW((void)unpack_result(longer), BackendError);
}

}  // namespace
}  // namespace palpate::test::test_follow_session
