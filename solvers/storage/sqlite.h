// SPDX-License-Identifier: BSD-3-Clause
// The little of SQLite that the state-space file needs, with errors that say what to do. A file may
// come from anywhere: nothing that it brings along is run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace palpate::sqlite {

enum class Access {
  read_only,
  /// As read_only, for a file that nobody can be writing: it is not locked and needs no journal.
  immutable,
  read_write,
};

/// An open file. Every member throws as `Database::fail` says.
class Database {
 public:
  Database(const std::filesystem::path& path, Access access);
  ~Database();
  Database(Database&& other) noexcept;
  Database& operator=(Database&& other) noexcept;

  /// Runs statements whose rows, if any, do not matter.
  void execute(const std::string& sql) const;
  /// The first column of the first row; 0 or an empty text where there is no row.
  [[nodiscard]] std::int64_t integer(const std::string& sql) const;
  [[nodiscard]] std::string text(const std::string& sql) const;
  /// Sets the largest size of a value or a row, bytes. A larger one counts as damaged from now on.
  void limit_row(std::int64_t bytes) const;
  /// The first bytes of the file, zero beyond its end.
  void read_first(void* bytes, std::size_t count) const;
  /// Whether the file was moved or removed since it was opened.
  [[nodiscard]] bool has_moved() const;
  /// Whether a transaction is open.
  [[nodiscard]] bool is_in_transaction() const;
  /// Writes the file anew, without free pages.
  void vacuum() const;
  /// The number of rows that the last INSERT, UPDATE or DELETE has touched.
  [[nodiscard]] std::int64_t changes() const;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] sqlite3* handle() const { return handle_; }

  /// Throws the error that SQLite has reported last.
  /// @throws InputError the file is no state space, or damaged.
  /// @throws BackendError it cannot be opened, read or written.
  [[noreturn]] void fail() const;

 private:
  std::filesystem::path path_;
  sqlite3* handle_ = nullptr;
};

/// A prepared statement. Parameters and columns are taken in order, one call after another.
class Statement {
 public:
  Statement(const Database& database, const std::string& sql);
  ~Statement();
  Statement(Statement&& other) noexcept;
  Statement& operator=(Statement&&) = delete;

  void bind(std::int64_t value);
  /// NaN becomes NULL: SQLite has no NaN.
  void bind(double value);
  void bind(const std::string& value);
  /// The data must outlive the next step; nullptr becomes NULL.
  void bind(const void* data, std::size_t bytes);

  /// True when there is a row.
  bool step();
  /// Runs a statement without rows, and makes it ready for the next time.
  void run();
  void reset();

  [[nodiscard]] std::int64_t take_integer();
  /// NULL gives NaN.
  [[nodiscard]] double take_double();
  [[nodiscard]] std::string take_text();
  struct Blob {
    const void* data;
    std::size_t bytes;
  };
  /// The data is valid until the next step.
  [[nodiscard]] Blob take_blob();

 private:
  void check(int status) const;

  const Database* database_;
  sqlite3_stmt* handle_ = nullptr;
  int parameter_ = 0;
  int column_ = 0;
};

/// Changes that are made while a transaction exists are undone at its end, unless commit() was
/// called. A transaction that begins within another one is a part of that one.
class Transaction {
 public:
  explicit Transaction(const Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  /// Null: the transaction is a part of another one, or has ended.
  const Database* database_;
};

}  // namespace palpate::sqlite
