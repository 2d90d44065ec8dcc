// SPDX-License-Identifier: BSD-3-Clause
#include "base/memory_error.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <string>

namespace palpate::test::test_memory_error {
namespace {

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST(MemoryError, SaysWhatForHowMuchAndWhatToDo) {
  const std::string text = not_enough_memory("to solve for a body");
  EXPECT_EQ(
      text.find("There is not enough memory to solve for a body. This process has taken up to "),
      0u);
  EXPECT_TRUE(has(text, " MB"));
  EXPECT_FALSE(has(text, "up to 0 MB"));
  EXPECT_TRUE(has(text, "Use a coarser mesh"));
  EXPECT_EQ(not_enough_memory(nullptr).find("There is not enough memory. This process"), 0u);
}

TEST(MemoryError, SaysTheLimitOfTheProcess) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  constexpr rlim_t kMost = rlim_t{1} << 45;  // more than the sanitizers take
  const rlimit limited{kMost, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &limited), 0);
  const std::string text = not_enough_memory("to solve");
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  EXPECT_TRUE(has(text, "of the 35184372 MB that its limit (ulimit -v) allows")) << text;
}

TEST(MemoryError, WhatIsRequiredIsTriedFirst) {
  EXPECT_NO_THROW(require_memory(0, "to test"));
  EXPECT_NO_THROW(require_memory(1 << 20, "to test"));
  // More than there are addresses.
  EXPECT_THROW(require_memory(std::size_t{1} << 60, "to test"), MemoryError);
}

TEST(MemoryError, ALongPurposeIsCut) {
  const std::string text = not_enough_memory(std::string(5000, 'x').c_str());
  EXPECT_LT(text.size(), kMemoryTextBytes);
  EXPECT_TRUE(has(text, "or one that has more memory."));
}

TEST(MemoryError, TakesThePlaceOfBadAlloc) {
  const auto fail = [] { with_memory("to solve for a body", [] { throw std::bad_alloc(); }); };
  try {
    fail();
    FAIL() << "nothing thrown";
  } catch (const MemoryError& error) {
    EXPECT_TRUE(has(error.what(), "to solve for a body"));
  }
  EXPECT_EQ(with_memory("to count", [] { return 3; }), 3);
  // What was told within stays as it is.
  try {
    with_memory("to solve for a body", [] { throw MemoryError("more exact"); });
    FAIL() << "nothing thrown";
  } catch (const MemoryError& error) {
    EXPECT_STREQ(error.what(), "more exact");
  }
}

}  // namespace
}  // namespace palpate::test::test_memory_error
