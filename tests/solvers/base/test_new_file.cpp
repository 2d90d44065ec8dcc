// SPDX-License-Identifier: BSD-3-Clause
#include "base/new_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "base/error.h"
#include "solvers/support/message_of.h"

namespace palpate::test::test_new_file {
namespace {

namespace fs = std::filesystem;

class NewFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
    target_ = folder_ / "a.feb";
  }
  void TearDown() override { fs::remove_all(folder_); }
  static void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
  static std::string read(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  fs::path folder_;
  fs::path target_;
};

TEST_F(NewFileTest, AppearsWhenItIsWhole) {
  write(target_, "old");
  {
    NewFile file(target_);
    write(file.path(), "new");
    EXPECT_EQ(read(target_), "old");
    file.replace();
  }
  EXPECT_EQ(read(target_), "new");
  EXPECT_EQ(files(), std::vector<std::string>{"a.feb"});
}

TEST_F(NewFileTest, LeavesNothingWhereItIsGivenUp) {
  write(target_, "old");
  { write(NewFile(target_).path(), "half"); }
  EXPECT_EQ(read(target_), "old");
  EXPECT_EQ(files(), std::vector<std::string>{"a.feb"});
}

TEST_F(NewFileTest, WritesNoFileOfOthers) {
  // Links under names that another program may guess.
  write(folder_ / "victim", "precious");
  fs::create_symlink("victim", folder_ / "a.feb.part");
  NewFile first(target_);
  NewFile second(target_);
  EXPECT_NE(first.path(), second.path());
  write(first.path(), "1");
  write(second.path(), "2");
  EXPECT_TRUE(first.put_where_none_is());
  EXPECT_FALSE(second.put_where_none_is());
  EXPECT_EQ(read(target_), "1");
  EXPECT_EQ(read(folder_ / "victim"), "precious");
}

TEST_F(NewFileTest, LinksStay) {
  fs::create_directory(folder_ / "other");
  fs::create_symlink("../a.feb", folder_ / "other" / "link");
  fs::create_symlink(folder_ / "other" / "link", folder_ / "far");
  EXPECT_EQ(fs::weakly_canonical(without_links(folder_ / "far")), fs::weakly_canonical(target_))
      << "also where the file is not there";
  {
    NewFile file(without_links(folder_ / "far"));
    write(file.path(), "new");
    file.replace();
  }
  EXPECT_TRUE(fs::is_symlink(folder_ / "far") && fs::is_symlink(folder_ / "other" / "link"));
  EXPECT_EQ(read(target_), "new");
  EXPECT_EQ(without_links(target_), target_);
  fs::create_symlink("round", folder_ / "round");
  EXPECT_NE(test::message_of([&] { (void)without_links(folder_ / "round"); }).find("to itself"),
            std::string::npos);
}

TEST_F(NewFileTest, NamesMayBeAsLongAsTheFileSystemHasThem) {
  target_ = folder_ / std::string(255, 'x');
  NewFile file(target_);
  write(file.path(), "new");
  file.replace();
  EXPECT_EQ(read(target_), "new");
  EXPECT_EQ(test::message_of([&] { require_short_name(std::string(kLongestFileName, 'x')); }), "");
  EXPECT_NE(test::message_of([&] { require_short_name(target_); }).find("shorter"),
            std::string::npos);
}

TEST_F(NewFileTest, WhatWasLeftUnfinishedIsRemovedAlone) {
  write(target_, "whole");
  write(folder_ / "a.feb.0123abcd.part", "half");
  for (const char* other : {"a.feb.part", "a.feb.0123abcd.partial", "a.feb.0123abcX.part",
                            "b.feb.0123abcd.part", "a.feb.rank1.0123abcd.part"}) {
    write(folder_ / other, "of others");
  }
  remove_unfinished(target_);
  EXPECT_EQ(files().size(), 6U);
  EXPECT_FALSE(fs::exists(folder_ / "a.feb.0123abcd.part"));
}

TEST_F(NewFileTest, SaysWhereItCannotBeMade) {
  EXPECT_THROW(NewFile(folder_ / "none" / "a"), BackendError);
}

}  // namespace
}  // namespace palpate::test::test_new_file
