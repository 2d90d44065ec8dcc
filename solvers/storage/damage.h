// SPDX-License-Identifier: BSD-3-Clause
// What is damaged in a file: what was found so, and was left out, as all of a file is read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "storage/sqlite.h"

namespace palpate {

/// The message "3 parts of 'a.palpate' are damaged: …, … and 1 more." for a list that is not empty.
[[nodiscard]] std::string describe_left_out(const std::filesystem::path& path,
                                            const std::vector<std::string>& left_out);

}  // namespace palpate

namespace palpate::storage {

/// @throws InputError the file is damaged, such that it is of no use.
[[noreturn]] void throw_damaged(const std::filesystem::path& path, const std::string& what);

/// The rows that were found damaged, and so were left out.
class Damage {
 public:
  /// @param what Its name for a message. @param row Its number in the table; 0: it is not known.
  void leave_out(const std::string& what, const std::string& table, std::int64_t row);
  /// How many rows there are.
  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  /// What they are called, each name once.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Whether one is in a table.
  [[nodiscard]] bool is_in(const std::string& table) const;
  /// Removes them from the file. @throws InputError the place of one is not known.
  void remove_from(const sqlite::Database& database) const;
  /// Forgets what was found.
  void clear() { rows_.clear(); }

 private:
  struct Place {
    std::string table;
    std::int64_t row = 0;
  };
  /// By name and row.
  std::map<std::pair<std::string, std::int64_t>, Place> rows_;
};

/// The rows that belong to nothing, since their key was damaged, and those that are not in the
/// index of their table, and so are not found by their key; for each table a text.
[[nodiscard]] std::vector<std::string> list_lost_rows(const sqlite::Database& database);

}  // namespace palpate::storage
