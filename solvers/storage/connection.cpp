// SPDX-License-Identifier: BSD-3-Clause
#include "storage/connection.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/printable.h"
#include "storage/blob_sizes.h"
#include "storage/open_file.h"

namespace palpate::storage {
namespace {

/// A commit waits for the disk if the last one that did so is this long ago. So the disk is waited
/// for once in that time, and a loss of power takes no more than what was computed in it.
constexpr std::chrono::seconds kSyncEvery{1};

/// It is worth the time to make a file smaller if this share of it is free.
constexpr double kFreeShare = 0.1;

}  // namespace

Connection::Connection(sqlite::Database opened)
    : database_(std::move(opened)), version_(database_.integer("PRAGMA user_version")) {}

rows::Checked Connection::checked() const {
  if (version_ < 6) return rows::Checked::as_version_5;
  if (version_ < 7) return rows::Checked::as_version_6;
  if (version_ < 8) return rows::Checked::as_version_7;
  return version_ < 10 ? rows::Checked::as_version_9 : rows::Checked::all;
}

void Connection::begin_to_write() {
  if (database_.text("PRAGMA journal_mode = WAL") != "wal") {
    throw BackendError("A write-ahead log cannot be kept beside " + quoted(path()) +
                       ". Give a file name on another disk.");
  }
  writes_ = true;
}

void Connection::before_change() {
  if (database_.is_in_transaction()) return;
  const auto now = std::chrono::steady_clock::now();
  const bool waits = !commits_wait_ || now - last_wait_ >= kSyncEvery;
  if (waits) last_wait_ = now;
  if (commits_wait_ == waits) return;
  database_.execute(waits ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL");
  commits_wait_ = waits;
}

void Connection::checkpoint() const {
  if (database_.integer("PRAGMA wal_checkpoint(TRUNCATE)") != 0) throw_log_stays(path());
}

void Connection::shrink() const {
  const auto of_pragma = [&](const char* name) {
    return static_cast<double>(database_.integer(std::string("PRAGMA ") + name));
  };
  if (of_pragma("freelist_count") >= kFreeShare * of_pragma("page_count")) database_.vacuum();
}

void Connection::close() {
  if (writes_) close_as_single_file(std::move(database_));
}

void Connection::make_room(std::int64_t bytes) const {
  const std::int64_t of_row = std::min(bytes + blobs::kOfNumbers, blobs::kLargestRow);
  if (of_row <= most_bytes_of_row_) return;
  most_bytes_of_row_ = of_row;
  database_.limit_row(of_row);
}

}  // namespace palpate::storage
