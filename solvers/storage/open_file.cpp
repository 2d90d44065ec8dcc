// SPDX-License-Identifier: BSD-3-Clause
#include "storage/open_file.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "base/folder.h"
#include "base/new_file.h"
#include "base/printable.h"
#include "storage/bodies.h"
#include "storage/damage.h"
#include "storage/schema.h"

namespace palpate::storage {
namespace fs = std::filesystem;
using sqlite::Access;
using sqlite::Database;

namespace {

/// Large pages suit large blobs: a configuration of 160 kB is 10 pages.
constexpr int kPageSize = 16384;

/// The first bytes of the file, as SQLite's file format defines them. They are read through SQLite,
/// since a program that opens the file by other means loses all its locks on the file when it
/// closes it.
struct FileHeader {
  explicit FileHeader(const Database& database) { database.read_first(bytes.data(), bytes.size()); }
  [[nodiscard]] std::uint64_t number(std::size_t at, std::size_t size) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes[at + i];
    return value;
  }
  [[nodiscard]] bool is_sqlite() const {
    return std::memcmp(bytes.data(), "SQLite format 3", 16) == 0;
  }
  [[nodiscard]] bool has_write_ahead_log() const { return bytes[18] == 2; }
  [[nodiscard]] std::uint64_t file_size() const {
    const std::uint64_t page_size = number(16, 2) == 1 ? 65536 : number(16, 2);
    return page_size * number(28, 4);
  }

  std::array<unsigned char, 100> bytes{};
};

void check_is_there(const fs::path& path) {
  require_short_name(path);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    throw InputError("There is no file " + quoted(path) + ". Check its name.");
  }
  if (status.type() == fs::file_type::none) {
    throw BackendError(quoted(path) + " cannot be opened: " + error.message() +
                       ". Change the permissions of its folder.");
  }
  if (status.type() != fs::file_type::regular) {
    throw InputError(quoted(path) + " is no ordinary file. Give another file name.");
  }
  if (fs::file_size(path) == 0) {
    throw InputError(quoted(path) + " is empty, not a state space. Take a copy that is whole, or " +
                     "give another file name.");
  }
}

/// SQLite would take the missing end of the last page as zeros.
void check_end(const Database& database) {
  const fs::path& path = database.path();
  const FileHeader header(database);
  if (header.is_sqlite() && !has_log(path) && header.file_size() > fs::file_size(path)) {
    throw_damaged(path, "its end is missing");
  }
}

}  // namespace

bool make_file(const fs::path& path, const Scene& scene, const SettledBody& at_rest,
               double solver_tolerance) {
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder)) {
    throw InputError("There is no folder " + quoted(folder) + ". Make it, or give another file " +
                     "name.");
  }
  require_short_name(path);
  Bodies::require_size(scene);
  // A log that is left there would be taken for that of the new file, and may hold the last results
  // of an earlier one.
  for (const char* suffix : {"-wal", "-journal"}) {
    const fs::path log = path.string() + suffix;
    if (!fs::exists(path) && fs::exists(log)) {
      throw InputError(quoted(log) + " is the log of a file " + quoted(path) +
                       " that is not there any more, and holds what was computed last. Bring that "
                       "file back, or move the log away, or give another file name.");
    }
  }
  NewFile part(path);
  try {
    const Database database(part.path(), Access::read_write);
    database.execute("PRAGMA page_size = " + std::to_string(kPageSize));
    database.execute("PRAGMA journal_mode = MEMORY");
    sqlite::Transaction transaction(database);
    make_schema(database);
    Bodies::write_first(database, scene, at_rest, solver_tolerance);
    transaction.commit();
  } catch (const BackendError&) {
    // Another process that has just made the file takes this one for what a killed one has left.
    if (!fs::exists(part.path()) && fs::exists(path)) return false;
    throw;
  }
  return part.put_where_none_is();
}

bool has_log(const fs::path& path) {
  return fs::exists(path.string() + "-wal") || fs::exists(path.string() + "-journal");
}

void throw_log_stays(const fs::path& path) {
  throw BackendError("The log of " + quoted(path) +
                     " cannot be put into the file. Nothing is lost: " +
                     "open it again when no other program uses it.");
}

Database open_exclusively(const fs::path& given) {
  const fs::path path = without_links(given);
  check_is_there(path);
  Database database(path, Access::read_write);
  check_end(database);
  database.execute("PRAGMA locking_mode = EXCLUSIVE");
  (void)check_schema(database);
  return database;
}

Database open_to_read(const fs::path& given) {
  const fs::path path = without_links(given);
  check_is_there(path);
  {
    Database database(path, Access::read_only);
    check_end(database);
    if (!has_log(path) && !FileHeader(database).has_write_ahead_log()) {
      (void)check_schema(database);
      return database;
    }
  }
  try {
    close_as_single_file(open_exclusively(path));
  } catch (const BackendError& error) {
    // A writer, alive or killed, has a log; without one the file is whole, wherever it lies.
    if (has_log(path)) {
      throw BackendError(error.what() + std::string(" If a run that was killed left it behind, ") +
                         "copy it, with the files beside it whose names begin with its own, to " +
                         "where it can be written.");
    }
    Database database(path, Access::immutable);
    (void)check_schema(database);
    return database;
  }
  return {path, Access::read_only};
}

void close_as_single_file(Database database) {
  const fs::path path = database.path();
  {
    const Database closed = std::move(database);
    if (closed.has_moved()) {
      throw BackendError(quoted(path) +
                         " was moved, removed or replaced while it was written. What was stored "
                         "last is in its log " +
                         quoted(fs::path(path.string() + "-wal")) +
                         ": bring the file back to where it was, beside that, and open it.");
    }
    if (closed.text("PRAGMA journal_mode = DELETE") != "delete") throw_log_stays(path);
  }
  sync_folder_of(path);
}

}  // namespace palpate::storage
