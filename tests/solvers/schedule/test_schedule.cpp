// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "base/error.h"
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

}  // namespace
}  // namespace palpate
