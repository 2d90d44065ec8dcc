// SPDX-License-Identifier: BSD-3-Clause
// The fields of the configurations of a state-space file, which are read when they are first asked
// for: while a body is touched the same few are needed again and again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "state_space/tool_space.h"

namespace palpate {

class StateSpaceFile;

class FieldCache {
 public:
  static constexpr std::size_t default_bytes = std::size_t{256} << 20;

  /// @param scene_hash The hash of the scene whose configurations are asked for.
  /// @param bytes The memory of the fields that are kept: those that were used last.
  FieldCache(std::filesystem::path path, std::string scene_hash, std::size_t bytes = default_bytes)
      : path_(std::move(path)), scene_hash_(std::move(scene_hash)), most_bytes_(bytes) {}

  /// The scene in the file.
  /// @throws InputError, BackendError as get() does.
  [[nodiscard]] Scene read_scene() const;

  /// The configurations with their fields, which are valid until the next call. The file is open
  /// only while something is read from it.
  /// @throws InputError the file is missing or damaged, or was replaced: it is of another scene or
  ///   grid, or lacks one of the configurations.
  /// @throws BackendError as StateSpaceFile does.
  std::vector<const Configuration*> get(const ToolSpaceSetup& setup,
                                        const std::vector<ConfigurationSummary>& wanted);

 private:
  struct Entry {
    Configuration configuration;
    std::uint64_t last_use = 0;
  };

  [[nodiscard]] StateSpaceFile open() const;
  [[noreturn]] void fail(const std::string& what) const;
  void read(const ToolSpaceSetup& setup, const std::vector<ConfigurationSummary>& missing);
  void forget_old_ones();

  std::filesystem::path path_;
  std::string scene_hash_;
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::uint64_t uses_ = 0;
  std::map<StateKey, Entry> entries_;
};

}  // namespace palpate
