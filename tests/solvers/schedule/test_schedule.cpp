// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>
#include <string>

#include "base/error.h"
#include "schedule/batch.h"
#include "solvers/support/communicators.h"

namespace palpate {
namespace {

class Schedule : public testing::Test {
 protected:
  std::unique_ptr<Communicator> world_ = test::make_world();
};

Bytes bytes_of(const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST_F(Schedule, GathersMessagesOfAnyLength) {
  // Lengths that are no multiple of the unit of transport, nothing among them.
  const auto message = [](int rank) { return std::string(static_cast<std::size_t>(rank) * 5, 'x'); };
  const auto all = world_->all_gather(bytes_of(message(world_->rank())));
  ASSERT_EQ(static_cast<int>(all.size()), world_->size());
  const auto on_first = world_->gather(bytes_of(message(world_->rank())));
  ASSERT_EQ(static_cast<int>(on_first.size()), world_->rank() == 0 ? world_->size() : 0);
  for (int r = 0; r < world_->size(); ++r) {
    EXPECT_EQ(text_of(all[r]), message(r));
    if (!on_first.empty()) {
      EXPECT_EQ(text_of(on_first[r]), message(r));
    }
  }
}

TEST_F(Schedule, AnyIsTrueEverywhereWhenTrueOnOne) {
  EXPECT_TRUE(any(*world_, world_->rank() == world_->size() - 1));
  EXPECT_FALSE(any(*world_, false));
}

TEST_F(Schedule, ARankThatIsAskedToStopHearsOfItWhileItWorks) {
  const int last = world_->size() - 1;
  for (int again = 0; again < 2; ++again) {
    EXPECT_FALSE(world_->stop_asked());
    agree(*world_, [] {});
    if (world_->rank() == last) {
      world_->ask_to_stop();
      world_->ask_to_stop();
    } else {
      while (!world_->stop_asked()) {
      }
      EXPECT_TRUE(world_->stop_asked());
    }
    world_->forget_stop();
  }
}

TEST_F(Schedule, AnErrorOnOneRankIsThrownOnAll) {
  const int last = world_->size() - 1;
  try {
    agree(*world_, [&] {
      if (world_->rank() == last) throw InputError("too soft");
    });
    FAIL() << "nothing thrown";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "too soft");
  }
  EXPECT_THROW(agree(*world_,
                     [&] {
                       if (world_->rank() == last) throw std::runtime_error("disk full");
                     }),
               BackendError);
  EXPECT_NO_THROW(agree(*world_, [] {}));
}

TEST_F(Schedule, EachTaskRunsOnceOnItsOwnerAndAllRanksGetTheResults) {
  constexpr int num_tasks = 37;
  std::vector<int> owners;
  for (int i = 0; i < num_tasks; ++i) owners.push_back((i * i) % world_->size());
  std::vector<int> ran(num_tasks, 0);
  const auto results = run_batch(*world_, owners, [&](std::int64_t i) {
    ++ran[i];
    return bytes_of(std::string(static_cast<std::size_t>(i % 4), 'a') + std::to_string(i));
  });
  ASSERT_EQ(results.size(), owners.size());
  for (int i = 0; i < num_tasks; ++i) {
    EXPECT_EQ(ran[i], owners[i] == world_->rank() ? 1 : 0);
    EXPECT_EQ(text_of(results[i]), std::string(i % 4, 'a') + std::to_string(i));
  }
}

TEST_F(Schedule, ATaskThatThrowsEndsTheBatchOnAllRanks) {
  std::vector<int> owners(10);
  for (int i = 0; i < 10; ++i) owners[i] = i % world_->size();
  EXPECT_THROW((void)run_batch(*world_, owners,
                               [](std::int64_t i) -> Bytes {
                                 if (i == 7) throw InputError("task 7");
                                 return {};
                               }),
               InputError);
}

TEST_F(Schedule, AnEmptyBatchHasNoResults) {
  EXPECT_TRUE(run_batch(*world_, {}, [](std::int64_t) { return Bytes(1); }).empty());
}

}  // namespace
}  // namespace palpate
