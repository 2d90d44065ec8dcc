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
  /// As read_only, of a file that nobody can be writing: takes no lock and looks for no journal.
  immutable,
  read_write,
  /// As read_write; the file is made.
  create,
};

/// An open file. Every member throws as `Database::fail` says.
class Database {
 public:
  Database(const std::filesystem::path& path, Access access);
  ~Database();
  Database(Database&& other) noexcept;
  Database& operator=(Database&& other) noexcept;

  /// Runs statements that give no rows that matter.
  void execute(const std::string& sql) const;
  /// First column of the first row; 0 where there is none.
  [[nodiscard]] std::int64_t integer(const std::string& sql) const;
  [[nodiscard]] std::string text(const std::string& sql) const;
  /// No value and no row may be larger from now on: one that is counts as damaged.
  void limit_row(std::int64_t bytes) const;
  /// Rows that the last INSERT, UPDATE or DELETE touched.
  [[nodiscard]] std::int64_t changes() const;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] sqlite3* handle() const { return handle_; }

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
  /// NaN becomes NULL: SQLite has none.
  void bind(double value);
  void bind(const std::string& value);
  /// The data must outlive the step; nullptr becomes NULL.
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
  /// Valid until the next step.
  [[nodiscard]] Blob take_blob();

 private:
  void check(int status) const;

  const Database* database_;
  sqlite3_stmt* handle_ = nullptr;
  int parameter_ = 0;
  int column_ = 0;
};

/// Undone when it goes out of scope without commit.
class Transaction {
 public:
  explicit Transaction(const Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  const Database* database_;
};

}  // namespace palpate::sqlite
