// SPDX-License-Identifier: BSD-3-Clause
#include "storage/sqlite.h"

#include <sqlite3.h>

#include <cctype>
#include <cstdio>
#include <cstring>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/memory_error.h"
#include "base/printable.h"

namespace palpate::sqlite {
namespace {

/// How long to wait for another program that has the file, ms: enough for it to finish a
/// transaction, not a computation.
constexpr int kBusyTimeout_ms = 500;

std::string query_of(Access access) {
  switch (access) {
    case Access::read_only: return "mode=ro";
    case Access::immutable: return "mode=ro&immutable=1";
    case Access::read_write: return "mode=rw";
  }
  return {};
}

/// Nothing that a file brings along is run, and nothing is made as large as the file says. The
/// statements are ours alone and small.
void defend(sqlite3* handle) {
  for (const auto& [option, value] :
       {std::pair{SQLITE_DBCONFIG_DEFENSIVE, 1}, std::pair{SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
        std::pair{SQLITE_DBCONFIG_ENABLE_TRIGGER, 0}, std::pair{SQLITE_DBCONFIG_ENABLE_VIEW, 0}}) {
    sqlite3_db_config(handle, option, value, nullptr);
  }
  for (const auto& [limit, value] :
       {std::pair{SQLITE_LIMIT_SQL_LENGTH, 100'000}, std::pair{SQLITE_LIMIT_COLUMN, 100},
        std::pair{SQLITE_LIMIT_EXPR_DEPTH, 100}, std::pair{SQLITE_LIMIT_ATTACHED, 0},
        std::pair{SQLITE_LIMIT_TRIGGER_DEPTH, 1}}) {
    sqlite3_limit(handle, limit, value);
  }
}

/// A path as an URI that SQLite opens.
std::string to_uri(const std::filesystem::path& path, const std::string& query) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path).string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || std::strchr("/-_.~", c) != nullptr) {
      uri += c;
    } else {
      char escaped[4];
      std::snprintf(escaped, sizeof escaped, "%%%02X", byte);
      uri += escaped;
    }
  }
  return uri + '?' + query;
}

}  // namespace

Database::Database(const std::filesystem::path& path, Access access) : path_(path) {
  const int status = sqlite3_open_v2(
      to_uri(path, query_of(access)).c_str(), &handle_,
      SQLITE_OPEN_URI | SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  const bool writes = access == Access::read_write;
  // SQLite falls back to reading where it may not write.
  const bool denied = status == SQLITE_OK && writes && sqlite3_db_readonly(handle_, "main") == 1;
  if (status == SQLITE_OK && !denied) {
    sqlite3_busy_timeout(handle_, kBusyTimeout_ms);
    defend(handle_);
    return;
  }
  try {
    if (denied) {
      throw BackendError(quoted(path) + " cannot be written. Change the permissions of " +
                         "the file and its folder, or give another file name.");
    }
    fail();
  } catch (...) {
    sqlite3_close(handle_);
    throw;
  }
}

Database::~Database() { sqlite3_close(handle_); }

Database::Database(Database&& other) noexcept
    : path_(std::move(other.path_)), handle_(std::exchange(other.handle_, nullptr)) {}

Database& Database::operator=(Database&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(handle_, other.handle_);
  return *this;
}

void Database::execute(const std::string& sql) const {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

std::int64_t Database::integer(const std::string& sql) const {
  Statement statement(*this, sql);
  return statement.step() ? statement.take_integer() : 0;
}

std::string Database::text(const std::string& sql) const {
  Statement statement(*this, sql);
  return statement.step() ? statement.take_text() : std::string();
}

void Database::limit_row(std::int64_t bytes) const {
  sqlite3_limit(handle_, SQLITE_LIMIT_LENGTH, static_cast<int>(bytes));
}

void Database::read_first(void* bytes, std::size_t count) const {
  sqlite3_file* file = nullptr;
  std::memset(bytes, 0, count);
  // SQLite fills a short read with zeros, and reports an error.
  const int status = sqlite3_file_control(handle_, "main", SQLITE_FCNTL_FILE_POINTER, &file);
  if (status != SQLITE_OK || file == nullptr || file->pMethods == nullptr) return;
  (void)file->pMethods->xRead(file, bytes, static_cast<int>(count), 0);
}

bool Database::has_moved() const {
  int moved = 0;
  const int status = sqlite3_file_control(handle_, "main", SQLITE_FCNTL_HAS_MOVED, &moved);
  return status == SQLITE_OK && moved != 0;
}

bool Database::is_in_transaction() const { return sqlite3_get_autocommit(handle_) == 0; }

void Database::vacuum() const {
  // VACUUM attaches the database that it writes.
  const int attached = sqlite3_limit(handle_, SQLITE_LIMIT_ATTACHED, 1);
  try {
    execute("VACUUM");
  } catch (...) {
    sqlite3_limit(handle_, SQLITE_LIMIT_ATTACHED, attached);
    throw;
  }
  sqlite3_limit(handle_, SQLITE_LIMIT_ATTACHED, attached);
}

std::int64_t Database::changes() const { return sqlite3_changes64(handle_); }

void Database::fail() const {
  const std::string name = quoted(path_);
  const std::string reason =
      handle_ != nullptr ? printable(sqlite3_errmsg(handle_)) : "out of memory";
  const int system_error = handle_ != nullptr ? sqlite3_system_errno(handle_) : 0;
  const std::string cause =
      system_error != 0 ? reason + ": " + std::strerror(system_error) : reason;
  switch (handle_ != nullptr ? sqlite3_errcode(handle_) & 0xff : SQLITE_NOMEM) {
    case SQLITE_NOTADB:
      throw InputError(name + " is not a Palpate state space, or its beginning is damaged (" +
                       reason + "). Give another file name.");
    case SQLITE_CORRUPT:
    case SQLITE_TOOBIG:
      throw InputError(name + " is damaged (" + reason +
                       "). Take a copy that is whole, or give another file name and compute it " +
                       "again.");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw BackendError(name + " is in use by another program that writes it. Wait until that " +
                         "one ends, or give another file name.");
    case SQLITE_FULL:
      throw BackendError("There is no space left to write " + name +
                         ". Free some and run again: " + "what was stored before is kept.");
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      throw BackendError(name + " cannot be written (" + cause + "). Change the permissions of " +
                         "the file and its folder, or give another file name.");
    case SQLITE_CANTOPEN:
      throw BackendError(name + " cannot be opened (" + cause + "). Check that its folder is " +
                         "there and may be used.");
    case SQLITE_NOMEM: throw MemoryError(not_enough_memory(("to use " + name).c_str()));
    default:
      throw BackendError(name + " cannot be read or written (" + cause + "). Check the disk and " +
                         "its free space; what was stored before is kept.");
  }
}

Statement::Statement(const Database& database, const std::string& sql) : database_(&database) {
  check(sqlite3_prepare_v2(database.handle(), sql.c_str(), -1, &handle_, nullptr));
}

Statement::~Statement() { sqlite3_finalize(handle_); }

Statement::Statement(Statement&& other) noexcept
    : database_(other.database_),
      handle_(std::exchange(other.handle_, nullptr)),
      parameter_(other.parameter_),
      column_(other.column_) {}

void Statement::check(int status) const {
  if (status != SQLITE_OK) database_->fail();
}

void Statement::bind(std::int64_t value) {
  check(sqlite3_bind_int64(handle_, ++parameter_, value));
}

void Statement::bind(double value) { check(sqlite3_bind_double(handle_, ++parameter_, value)); }

void Statement::bind(const std::string& value) {
  check(sqlite3_bind_text(handle_, ++parameter_, value.data(), static_cast<int>(value.size()),
                          SQLITE_TRANSIENT));
}

void Statement::bind(const void* data, std::size_t bytes) {
  check(sqlite3_bind_blob64(handle_, ++parameter_, data, bytes, SQLITE_STATIC));
}

bool Statement::step() {
  column_ = 0;
  const int status = sqlite3_step(handle_);
  if (status != SQLITE_ROW && status != SQLITE_DONE) database_->fail();
  return status == SQLITE_ROW;
}

void Statement::run() {
  try {
    step();
  } catch (...) {
    reset();
    throw;
  }
  reset();
}

void Statement::reset() {
  sqlite3_reset(handle_);
  parameter_ = 0;
  column_ = 0;
}

std::int64_t Statement::take_integer() { return sqlite3_column_int64(handle_, column_++); }

double Statement::take_double() {
  const int column = column_++;
  return sqlite3_column_type(handle_, column) == SQLITE_NULL
             ? std::numeric_limits<double>::quiet_NaN()
             : sqlite3_column_double(handle_, column);
}

std::string Statement::take_text() {
  const int column = column_++;
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(handle_, column));
  return text == nullptr
             ? std::string()
             : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(handle_, column)));
}

Statement::Blob Statement::take_blob() {
  const int column = column_++;
  const void* data = sqlite3_column_blob(handle_, column);
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(handle_, column))};
}

Transaction::Transaction(const Database& database)
    : database_(database.is_in_transaction() ? nullptr : &database) {
  if (database_ != nullptr) database.execute("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (database_ != nullptr) {
    sqlite3_exec(database_->handle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

void Transaction::commit() {
  if (database_ == nullptr) return;
  database_->execute("COMMIT");
  database_ = nullptr;
}

}  // namespace palpate::sqlite
