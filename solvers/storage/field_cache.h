// SPDX-License-Identifier: BSD-3-Clause
// A cache of the fields of a file's configurations. They are read when they are first asked for,
// and kept, since the same few are needed again and again while a body is touched.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "fields/field_source.h"
#include "state_space/tool_space.h"
#include "storage/state_space_file.h"

namespace palpate {

class FieldCache : public FieldSource {
 public:
  static constexpr std::size_t default_bytes = std::size_t{256} << 20;

  /// @param scene_hash What tells the space from others, see TouchSpace.
  /// @param bytes The memory of the fields and modes that are kept: those that were used last.
  FieldCache(std::filesystem::path path, std::string scene_hash, std::size_t bytes = default_bytes)
      : path_(std::move(path)), scene_hash_(std::move(scene_hash)), most_bytes_(bytes) {}

  /// A body in the file.
  /// @throws InputError, BackendError as get() does.
  [[nodiscard]] SpaceBody read_body(BodyId body) const;

  /// The file is open only while something is read from it.
  /// @throws InputError the file is missing or damaged, or was replaced: it is of another scene or
  ///   grid, or lacks one of the configurations; or it keeps less than what is needed.
  /// @throws BackendError as StateSpaceFile does.
  void add_up(const ToolSpaceSetup& setup, const std::vector<FieldShare>& shares, Keep needed,
              NodalVector& u, NodalVector& p) override;

 private:
  struct Entry {
    StoredFields fields;
    std::uint64_t last_use = 0;
  };

  [[nodiscard]] StateSpaceFile open() const;
  [[noreturn]] void fail(const std::string& what) const;
  void read(const ToolSpaceSetup& setup, const std::vector<ConfigurationSummary>& missing);
  [[nodiscard]] std::size_t bytes() const;
  void forget_old_ones();

  std::filesystem::path path_;
  std::string scene_hash_;
  std::size_t most_bytes_;
  /// The memory of the entries, without the bases, bytes.
  std::size_t entry_bytes_ = 0;
  std::uint64_t uses_ = 0;
  std::map<StateKey, Entry> entries_;
  StateSpaceFile::Known known_;
  /// What is needed of a body to read its fields.
  struct OfBody {
    /// The results of kept_points(). The entry of Keep::all gives the number of points.
    std::map<Keep, std::vector<Index>> points;
    SettledBody at_rest;
  };
  /// The bodies of which something was read.
  std::map<BodyId, OfBody> bodies_;
};

}  // namespace palpate
