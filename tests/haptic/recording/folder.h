// SPDX-License-Identifier: BSD-3-Clause
// What the tests of recordings share: files in a folder of their own.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "haptic/recording/recorder.h"
#include "haptic/recording/replay.h"

namespace palpate::test {

class RecordingTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
};

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// @param notice What the reader has to say at the end.
inline std::vector<TickRecord> ticks_of(const std::filesystem::path& path,
                                        std::string* notice = nullptr) {
  RecordingReader reader(path);
  std::vector<TickRecord> ticks;
  for (TickRecord record; reader.next(record);) ticks.push_back(record);
  if (notice != nullptr) {
    *notice = reader.notice();
  } else {
    EXPECT_EQ(reader.notice(), "");
  }
  return ticks;
}

}  // namespace palpate::test
