// SPDX-License-Identifier: BSD-3-Clause
// A folder that all ranks of a test share, for as long as the test lasts.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "schedule/communicator.h"

namespace palpate::test {

class WorldFolder {
 public:
  /// Makes it, empty, named after the test that runs and the number of ranks.
  /// @param world It must outlive this object. @note Collective, and so is the end of the object.
  explicit WorldFolder(Communicator& world) : world_(world) {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("palpate_") + info->test_suite_name() + '_' + info->name() +
                       '_' + std::to_string(world.size());
    std::replace(name.begin(), name.end(), '/', '_');
    path_ = std::filesystem::temp_directory_path() / name;
    if (world_.rank() == 0) {
      std::filesystem::remove_all(path_);
      std::filesystem::create_directory(path_);
    }
    agree(world_, [] {});
  }
  ~WorldFolder() {
    agree(world_, [] {});
    if (world_.rank() == 0) std::filesystem::remove_all(path_);
  }
  WorldFolder(const WorldFolder&) = delete;
  WorldFolder& operator=(const WorldFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  Communicator& world_;
  std::filesystem::path path_;
};

}  // namespace palpate::test
