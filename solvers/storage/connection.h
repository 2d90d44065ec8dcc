// SPDX-License-Identifier: BSD-3-Clause
// An open state-space file, as the classes of its tables share it.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "storage/damage.h"
#include "storage/rows.h"
#include "storage/sqlite.h"

namespace palpate::storage {

class Connection {
 public:
  explicit Connection(sqlite::Database opened);

  [[nodiscard]] const sqlite::Database& database() const { return database_; }
  [[nodiscard]] const std::filesystem::path& path() const { return database_.path(); }

  /// The version of the schema.
  [[nodiscard]] std::int64_t version() const { return version_; }
  /// Call this after the file was converted to another version.
  void set_version(std::int64_t version) { version_ = version; }
  [[nodiscard]] rows::Checked checked() const;
  /// Whether a scene and a tool space have a checksum.
  [[nodiscard]] bool has_checksums() const { return version_ >= 6; }

  /// Switches to a write-ahead log.
  /// @throws BackendError a log cannot be kept where the file is.
  void begin_to_write();
  [[nodiscard]] bool writes() const { return writes_; }
  /// Call this before each change: it decides whether the commit of the change waits for the disk.
  void before_change();
  /// Puts the log into the file and waits for the disk, so that everything stored so far is
  /// durable.
  void checkpoint() const;
  /// Makes the file smaller by the pages that are free in it, if that is worth the time.
  void shrink() const;
  /// Closes the file. Nothing may be called afterwards, and no statement may be left.
  void close();

  /// Sets the largest size of a row beside its plain numbers, bytes. A larger row counts as
  /// damaged.
  void make_room(std::int64_t bytes) const;

  /// The rows that were found damaged so far. Reading adds to them.
  [[nodiscard]] Damage& damage() const { return damage_; }

 private:
  sqlite::Database database_;
  std::int64_t version_;
  bool writes_ = false;
  std::optional<bool> commits_wait_;
  std::chrono::steady_clock::time_point last_wait_;
  mutable std::int64_t most_bytes_of_row_ = 0;
  mutable Damage damage_;
};

}  // namespace palpate::storage
