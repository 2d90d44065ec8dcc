// SPDX-License-Identifier: BSD-3-Clause
#include "base/printable.h"

#include <gtest/gtest.h>

#include <string>

namespace palpate::test::test_printable {
namespace {

TEST(Printable, TextOfAnyLanguageStaysAsItIs) {
  for (const std::string text : {"", "Basis 1", "Zürich", "肝臓", "🫀 π·x²"}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, WhatATerminalObeysIsShown) {
  EXPECT_EQ(printable("a\x1b[2Jb"), "a\\x1b[2Jb");
  EXPECT_EQ(printable("a\nb\rc\td\x7f"), "a\\x0ab\\x0dc\\x09d\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  // A control character of C1, and one that turns the direction of writing round.
  EXPECT_EQ(printable("a\xc2\x9b"
                      "31m"),
            "a\\xc2\\x9b31m");
  EXPECT_EQ(printable("a\xe2\x80\xae"
                      "b"),
            "a\\xe2\\x80\\xaeb");
}

TEST(Printable, BytesThatAreNoUtf8AreShown) {
  // Alone, cut off, longer than needed, a surrogate, and beyond the last character.
  EXPECT_EQ(printable("\xff"), "\\xff");
  EXPECT_EQ(printable("a\xe8\x82"), "a\\xe8\\x82");
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
}

TEST(Printable, OfALongTextTheMiddleIsLeftOut) {
  const std::string shown = printable(std::string(1000000, 'x') + "end");
  EXPECT_LT(shown.size(), 200U);
  EXPECT_NE(shown.find("of 1000003 bytes"), std::string::npos);
  EXPECT_EQ(shown.substr(shown.size() - 3), "end");
  // No character is cut in two.
  std::string wide;
  for (int i = 0; i < 100; ++i) wide += "肝";
  EXPECT_EQ(printable(wide).find("\\x"), std::string::npos);
}

// Lines stay lines; what a file puts into one does not get out of it, or fill a screen.
TEST(Printable, AMessageHasItsLines) {
  EXPECT_EQ(printable_message("The array \x1b[2J is bad.\nIt has 3.\n"),
            "The array \\x1b[2J is bad.\nIt has 3.\n");
  EXPECT_EQ(printable_message(""), "");
  EXPECT_LT(printable_message(std::string(10'000'000, 'x')).size(), kLongestMessage + 100);
}

TEST(Printable, APathIsWholeBetweenQuotes) {
  const std::string name(250, 'x');
  EXPECT_EQ(quoted(std::filesystem::path(name + "\n")), '\'' + name + "\\x0a'");
}

}  // namespace
}  // namespace palpate::test::test_printable
