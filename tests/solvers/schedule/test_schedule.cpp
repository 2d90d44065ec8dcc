// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.h"
#include "solvers/support/communicators.h"
#include "threads/usable_cores.h"

namespace palpate::test::test_schedule {
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
  const auto message = [](int rank) {
    return std::string(static_cast<std::size_t>(rank) * 5, 'x');
  };
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

TEST_F(Schedule, SplitsByColour) {
  const int colour = world_->rank() % 2;
  const auto part = world_->split(colour);
  EXPECT_EQ(part->size(), (world_->size() + 1 - colour) / 2);
  EXPECT_EQ(part->rank(), world_->rank() / 2);
  const auto all = part->all_gather(bytes_of(std::to_string(world_->rank())));
  for (int r = 0; r < part->size(); ++r) EXPECT_EQ(text_of(all[r]), std::to_string(2 * r + colour));
}

// The tests bind no rank, so that all may run on every core.
TEST_F(Schedule, RanksOfAMachineShareItsCores) {
  EXPECT_EQ(world_->num_cores(), std::max(1, num_usable_cores() / world_->size()));
  EXPECT_EQ(num_threads(*world_, 3), 3);
  const int automatic = num_threads(*world_, 0);
  EXPECT_GE(automatic, 1);
  EXPECT_LE(automatic, world_->num_cores());
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

/// Throws on the last rank alone, outside of the operation that the others come to.
class Collective : public Schedule {
 protected:
  void expect_failure_of_last_rank(const std::function<void()>& operation) {
    try {
      agree(*world_, [&] {
        if (world_->rank() == world_->size() - 1) throw std::bad_alloc();
        operation();
      });
      FAIL() << "nothing thrown";
    } catch (const MemoryError& error) {
      EXPECT_NE(std::string(error.what()).find("not enough memory"), std::string::npos);
    }
    // The ranks are in step again.
    EXPECT_EQ(static_cast<int>(world_->all_gather(Bytes(3)).size()), world_->size());
  }
};

TEST_F(Collective, AllGatherMeetsARankThatFailedBefore) {
  expect_failure_of_last_rank([&] { (void)world_->all_gather(Bytes(7)); });
}

TEST_F(Collective, GatherMeetsARankThatFailedBefore) {
  expect_failure_of_last_rank([&] { (void)world_->gather(Bytes(7)); });
}

TEST_F(Collective, ExchangeMeetsARankThatFailedBefore) {
  expect_failure_of_last_rank([&] {
    (void)world_->exchange(std::vector<Bytes>(static_cast<std::size_t>(world_->size())));
  });
}

TEST_F(Collective, SplitMeetsARankThatFailedBefore) {
  expect_failure_of_last_rank([&] { (void)world_->split(0); });
}

TEST_F(Collective, AgreementMeetsARankThatFailedBefore) {
  expect_failure_of_last_rank([&] { agree(*world_, [&] { agree(*world_, [] {}); }); });
}

TEST_F(Schedule, AnErrorWithinIsThrownOnceOnAll) {
  const auto fail_within = [&] {
    agree(*world_, [&] {
      agree(*world_, [&] {
        if (world_->rank() == 0) throw InputError("too soft");
      });
    });
  };
  EXPECT_THROW(fail_within(), InputError);
  EXPECT_FALSE(any(*world_, false));
}

TEST_F(Schedule, ALongErrorIsCut) {
  try {
    agree(*world_, [] { throw InputError(std::string(10'000, 'x')); });
    FAIL() << "nothing thrown";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), std::string(sizeof Failure::text - 1, 'x'));
  }
}

}  // namespace
}  // namespace palpate::test::test_schedule
