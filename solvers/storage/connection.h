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

  /// Of the schema.
  [[nodiscard]] std::int64_t version() const { return version_; }
  /// The file was made one of another version.
  void set_version(std::int64_t version) { version_ = version; }
  [[nodiscard]] rows::Checked checked() const;
  /// Whether a scene and a tool space have a checksum.
  [[nodiscard]] bool has_checksums() const { return version_ >= 6; }

  /// From now on there is a write-ahead log.
  /// @throws BackendError a log cannot be kept where the file is.
  void begin_to_write();
  [[nodiscard]] bool writes() const { return writes_; }
  /// Is called before each change: decides whether its commit waits for the disk.
  void before_change();
  /// Puts the log into the file and waits for the disk: what was stored so far is durable.
  void checkpoint() const;
  /// Gives the disk what is free in the file, where that is worth the time.
  void shrink() const;
  /// Closes the file. Nothing may be called afterwards, and no statement may be left.
  void close();

  /// Lets a row hold so many bytes beside its numbers; a larger one counts as damaged.
  void make_room(std::int64_t bytes) const;

  /// What was found damaged; reading adds to it.
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
