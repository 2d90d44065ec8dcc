// SPDX-License-Identifier: BSD-3-Clause
// Explorers in other processes, over a connection: what they find, and what happens to those that
// are killed, that have the wrong key, or that send what is none of our messages.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/clock.h"
#include "base/error.h"
#include "explorers/explorer_hub.h"
#include "explorers/keys.h"
#include "explorers/local_explorers.h"
#include "explorers/serve.h"
#include "explorers/wire.h"
#include "solvers/explorers/relay.h"
#include "solvers/following/ball_on_block.h"
#include "solvers/support/message_of.h"
#include "solvers/support/world_folder.h"

namespace palpate::test::test_explorers {
namespace {

constexpr const char* kHere = "tcp://127.0.0.1:*";
/// Long enough on a busy machine, s.
constexpr double kPatience = 120;

class ExplorersTest : public testing::Test {
 protected:
  ExplorersTest() {
    make_keys(folder_.path());
    hub_ = std::make_unique<ExplorerHub>(folder_.path(), kHere);
  }

  void begin() {
    session_ = std::make_unique<FollowSession>(ball_.scene, ball_.options);
    session_->follow(ball_.hand());
    hub_->explore_for(session_.get());
  }
  void start(int number) { start(number, hub_->endpoint()); }
  void start(int number, const std::string& endpoint) {
    explorers_ =
        std::make_unique<LocalExplorers>(PALPATE_EXPLORE, number, folder_.path(), endpoint, 0);
  }
  /// Exchanges until a condition holds.
  template <class Condition>
  [[nodiscard]] bool until(const Condition& condition) {
    const auto begin = SteadyClock::now();
    while (!condition()) {
      if (seconds_since(begin) > kPatience) return false;
      if (explorers_) (void)explorers_->watch();
      (void)hub_->exchange(0.01);
    }
    return true;
  }
  [[nodiscard]] bool is_done() const { return session_->figures().is_complete; }
  using Found = std::map<CheckPoint, ConfigurationSummary>;
  [[nodiscard]] static Found found_by(FollowSession& session) {
    Found found;
    while (const auto chunk = session.take_chunk()) {
      for (const auto& of_space : chunk->tool_spaces) {
        for (const auto& c : of_space.configurations) found[c.check_point] = c;
      }
    }
    return found;
  }
  [[nodiscard]] Found found() { return found_by(*session_); }
  /// What an explorer in this process finds.
  [[nodiscard]] Found found_here() const {
    FollowSession session(ball_.scene, ball_.options);
    session.follow(ball_.hand());
    Explorer explorer(session.job());
    while (const auto task = session.next()) EXPECT_TRUE(session.accept(explorer.make(*task)));
    return found_by(session);
  }
  /// The explorers that run. MPI may have started a process of its own besides.
  [[nodiscard]] std::vector<pid_t> processes() const {
    std::vector<pid_t> all;
    std::ifstream children("/proc/self/task/" + std::to_string(getpid()) + "/children");
    for (pid_t process = 0; children >> process;) {
      std::ifstream name("/proc/" + std::to_string(process) + "/comm");
      std::string text;
      if (name >> text && text == "palpate-explore") all.push_back(process);
    }
    return all;
  }

  std::unique_ptr<Communicator> communicator_ = make_serial_communicator();
  WorldFolder folder_{*communicator_};
  BallOnBlock ball_;
  std::unique_ptr<FollowSession> session_;
  std::unique_ptr<ExplorerHub> hub_;
  std::unique_ptr<LocalExplorers> explorers_;
};

TEST_F(ExplorersTest, FindWhatOneFindsHere) {
  begin();
  start(2);
  ASSERT_TRUE(until([&] { return hub_->figures().num_explorers == 2; }));
  ASSERT_TRUE(until([&] { return is_done(); })) << hub_->figures().last_failure;
  EXPECT_EQ(hub_->figures().num_refused, 0);
  const auto here = found_here();
  const auto there = found();
  ASSERT_EQ(there.size(), here.size());
  // At the edges of the block there are several equilibria, and the order in which states are found
  // decides which of them follow.
  std::size_t others = 0;
  for (const auto& [p, c] : there) {
    EXPECT_EQ(c.usable(), here.at(p).usable());
    if (c.usable() && (c.force - here.at(p).force).norm() > 1e-6 * (1 + c.force.norm())) ++others;
  }
  EXPECT_LE(others, there.size() / 20);
}

TEST_F(ExplorersTest, ThatAreKilledLoseNothing) {
  begin();
  start(2);
  for (int i = 0; i < 20; ++i) {
    const std::int64_t before = session_->figures().num_solved;
    ASSERT_TRUE(until([&] { return session_->figures().num_solved >= before + 2 || is_done(); }));
    const std::vector<pid_t> running = processes();
    ASSERT_FALSE(running.empty());
    for (const pid_t process : running) kill(process, SIGKILL);
  }
  ASSERT_TRUE(until([&] { return is_done(); }));
  EXPECT_EQ(found().size(), found_here().size());
}

TEST_F(ExplorersTest, WhoseConnectionsAreCutLoseNothing) {
  begin();
  Relay relay(hub_->endpoint());
  start(2, relay.endpoint());
  for (int i = 0; i < 20; ++i) {
    const std::int64_t before = session_->figures().num_solved;
    ASSERT_TRUE(until([&] { return session_->figures().num_solved >= before + 2 || is_done(); }));
    relay.cut();
  }
  ASSERT_TRUE(until([&] { return is_done(); }));
  EXPECT_GE(relay.num_cut(), 20);
  EXPECT_EQ(found().size(), found_here().size());
}

TEST_F(ExplorersTest, OneThatIsStoppedIsLostAndComesBack) {
  begin();
  start(1);
  ASSERT_TRUE(until([&] { return hub_->figures().num_busy == 1; }));
  ASSERT_EQ(processes().size(), 1u);
  const pid_t process = processes().front();
  kill(process, SIGSTOP);
  ASSERT_TRUE(until([&] { return hub_->figures().num_explorers == 0; }));
  EXPECT_EQ(session_->figures().num_under_way, 0);
  kill(process, SIGCONT);
  ASSERT_TRUE(until([&] { return is_done(); }));
}

// As that of a window which is busy.
TEST_F(ExplorersTest, OfAHubThatDoesNotListenForAWhileGoOn) {
  begin();
  start(2);
  ASSERT_TRUE(until([&] { return hub_->figures().num_busy == 2; }));
  // More has come than is read with a limit, and nobody is there any more when the next heartbeat
  // is due.
  std::this_thread::sleep_for(std::chrono::seconds(12));
  for (const pid_t process : processes()) kill(process, SIGKILL);
  std::this_thread::sleep_for(std::chrono::seconds(6));
  ASSERT_TRUE(until([&] { return is_done(); })) << hub_->figures().last_failure;
  EXPECT_EQ(found().size(), found_here().size());
}

TEST_F(ExplorersTest, GoOnWithAnotherSession) {
  begin();
  start(2);
  ASSERT_TRUE(until([&] { return session_->figures().num_solved > 3; }));
  ball_.options.contact->tool.radius = 0.02;
  auto second = std::make_unique<FollowSession>(ball_.scene, ball_.options);
  second->follow(ball_.hand());
  hub_->explore_for(second.get());
  EXPECT_EQ(session_->figures().num_under_way, 0);
  session_ = std::move(second);
  ASSERT_TRUE(until([&] { return is_done(); }));
  EXPECT_EQ(found().size(), found_here().size());
}

TEST_F(ExplorersTest, WithoutAKeyOrWithAnotherAreRefused) {
  begin();
  const auto other = folder_ / "other";
  make_keys(other);
  // The leader's key is right, the explorer's own is not.
  std::filesystem::copy_file(leader_key(folder_.path()), leader_key(other),
                             std::filesystem::copy_options::overwrite_existing);
  std::filesystem::remove(other / "leader_secret");
  const LocalExplorers strangers(PALPATE_EXPLORE, 1, other, hub_->endpoint());
  ASSERT_TRUE(until([&] { return hub_->figures().num_refused > 0; }));
  const auto begin = SteadyClock::now();
  EXPECT_FALSE(
      until([&] { return hub_->figures().num_explorers > 0 || seconds_since(begin) > 2; }) &&
      hub_->figures().num_explorers > 0);
  const std::atomic<bool> stop{false};
  EXPECT_NE(message_of([&] {
              serve_explorer({folder_ / "none", hub_->endpoint()}, stop);
            }).find("no key"),
            std::string::npos);
}

/// Bytes to the port of the hub, as from a program that speaks no ZeroMQ.
/// @returns Whether it was reached.
bool send_bytes(const std::string& endpoint, const std::string& bytes) {
  const int file = connect_to(port_of(endpoint));
  if (file < 0) return false;
  (void)!::write(file, bytes.data(), bytes.size());
  close(file);
  return true;
}

std::size_t memory_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::size_t kib = 0;
    if (word == "VmRSS:" && status >> kib) return kib;
  }
  return 0;
}

TEST_F(ExplorersTest, GarbageAndManyConnectionsLeaveTheHubAsItIs) {
  begin();
  std::string noise(5000, '\0');
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<char>((i * 7919) % 251);
  const auto flood = [&](int number) {
    for (int i = 0; i < number; ++i) {
      ASSERT_TRUE(send_bytes(hub_->endpoint(), i % 3 == 0 ? std::string() : noise));
      if (i % 50 == 0) (void)hub_->exchange();
    }
  };
  flood(2000);
  const std::size_t before = memory_kib();
  flood(98000);
  EXPECT_LT(memory_kib(), before + 8192);
  EXPECT_GT(hub_->figures().num_refused, 0);
  EXPECT_EQ(hub_->figures().num_explorers, 0);
  start(1);
  ASSERT_TRUE(until([&] { return session_->figures().num_solved > 2; }));
}

TEST_F(ExplorersTest, OneThatIsAdmittedAndSendsNonsenseHarmsNobody) {
  begin();
  const Certificate own(zcert_load(explorer_key(folder_.path()).c_str()));
  const Certificate leader(zcert_load(leader_key(folder_.path()).c_str()));
  const Socket socket(zsock_new(ZMQ_DEALER));
  zcert_apply(own.get(), socket.get());
  zsock_set_curve_serverkey(socket.get(), zcert_public_txt(leader.get()));
  zsock_set_linger(socket.get(), 0);
  ASSERT_EQ(zsock_connect(socket.get(), "%s", hub_->endpoint().c_str()), 0);
  zstr_send(socket.get(), "one frame");
  zstr_sendx(socket.get(), "two", "frames", nullptr);
  zstr_sendx(socket.get(), "more", "than", "two", nullptr);
  ASSERT_TRUE(until([&] { return hub_->figures().num_refused >= 3; }));
  // It says hello, takes a task and answers it with cut bytes.
  send(socket.get(), {WireKind::hello, 0, bytes_of("another version")});
  bool is_garbage = false;
  std::optional<WireMessage> message;
  const auto receives = [&](WireKind kind) {
    return until([&] {
      message = receive(socket.get(), is_garbage);
      return message && message->kind == kind;
    });
  };
  ASSERT_TRUE(receives(WireKind::refuse));
  send(socket.get(), {WireKind::hello, 0, wire_layout()});
  ASSERT_TRUE(receives(WireKind::job));
  const std::int64_t job = message->job;
  send(socket.get(), {WireKind::ready, job, {}});
  ASSERT_TRUE(receives(WireKind::task));
  start(1);
  const std::int64_t refused = hub_->figures().num_refused;
  send(socket.get(), {WireKind::result, job, bytes_of("no result")});
  ASSERT_TRUE(until([&] { return hub_->figures().num_refused > refused; }));
  // A message larger than any configuration ends its connection.
  send(socket.get(), {WireKind::result, job, Bytes(std::size_t{130} << 20)});
  // The other explorer finds all the same.
  ASSERT_TRUE(until([&] { return is_done(); }));
  EXPECT_EQ(found().size(), found_here().size());
}

TEST_F(ExplorersTest, AJobThatComesAgainRightAfterATaskIsAnswered) {
  session_ = std::make_unique<FollowSession>(ball_.scene, ball_.options);
  session_->follow(ball_.hand());
  // A leader of its own, which sends what a hub sends after two greetings.
  const Certificate key(zcert_load(leader_key(folder_.path()).c_str()));
  const Socket socket(zsock_new(ZMQ_ROUTER));
  zcert_apply(key.get(), socket.get());
  zsock_set_curve_server(socket.get(), 1);
  zsock_set_linger(socket.get(), 0);
  const int port = zsock_bind(socket.get(), "tcp://127.0.0.1:*");
  ASSERT_GT(port, 0);
  const LocalExplorers explorers(PALPATE_EXPLORE, 1, folder_.path(),
                                 "tcp://127.0.0.1:" + std::to_string(port));
  std::string from;
  const auto receives = [&](WireKind kind) {
    const auto begin = SteadyClock::now();
    while (seconds_since(begin) < kPatience / 4) {
      bool is_garbage = false;
      const auto message = receive(socket.get(), is_garbage, &from);
      if (message && message->kind == kind) return true;
      if (!message) usleep(1000);
    }
    return false;
  };
  ASSERT_TRUE(receives(WireKind::alive));
  const WireMessage job{WireKind::job, 7, pack(session_->job())};
  send(socket.get(), job, &from);
  ASSERT_TRUE(receives(WireKind::ready));
  for (int i = 0; i < 20; ++i) {
    const auto task = session_->next();
    ASSERT_TRUE(task);
    session_->lose(task->number);
    send(socket.get(), {WireKind::task, 7, pack(*task)}, &from);
    send(socket.get(), job, &from);
    ASSERT_TRUE(receives(WireKind::ready)) << i;
  }
}

TEST_F(ExplorersTest, ThereIsOneHubInAProgramAndAnAddressMayBeTaken) {
  EXPECT_THROW(ExplorerHub(folder_.path(), kHere), BackendError);
  const std::string taken = hub_->endpoint();
  hub_.reset();
  EXPECT_NE(message_of([&] { ExplorerHub(folder_ / "none", kHere); }).find("no key"),
            std::string::npos);
  EXPECT_NE(message_of([&] { ExplorerHub(folder_.path(), "tcp://nowhere"); }).find("listen"),
            std::string::npos);
  // The port is free again after a while.
  const auto begin = SteadyClock::now();
  while (hub_ == nullptr && seconds_since(begin) < kPatience) {
    try {
      hub_ = std::make_unique<ExplorerHub>(folder_.path(), taken);
    } catch (const InputError&) {
      usleep(10'000);
    }
  }
  ASSERT_NE(hub_, nullptr);
  EXPECT_EQ(hub_->endpoint(), taken);
}

TEST_F(ExplorersTest, AKeyThatIsThereTwiceIsRefused) {
  hub_.reset();
  std::filesystem::copy_file(explorer_key(folder_.path()), explorer_keys(folder_.path()) / "again");
  EXPECT_NE(message_of([&] { ExplorerHub(folder_.path(), kHere); }).find("are the same"),
            std::string::npos);
}

TEST_F(ExplorersTest, SecretKeysThatOthersReadAreRefused) {
  namespace fs = std::filesystem;
  fs::permissions(explorer_keys(folder_.path()), fs::perms::others_write, fs::perm_options::add);
  hub_.reset();
  EXPECT_NE(message_of([&] { ExplorerHub(folder_.path(), kHere); }).find("put keys into"),
            std::string::npos);
  fs::permissions(folder_.path() / "leader_secret", fs::perms::others_read, fs::perm_options::add);
  EXPECT_NE(message_of([&] { make_keys(folder_.path()); }).find("Others may read"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_explorers
