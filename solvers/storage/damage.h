// SPDX-License-Identifier: BSD-3-Clause
// Damage in a file: the rows that were found damaged while the file was read, and so were left out.
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

/// @throws InputError always: the file is damaged in such a way that it is of no use.
[[noreturn]] void throw_damaged(const std::filesystem::path& path, const std::string& what);

/// The rows that were found damaged, and so were left out.
class Damage {
 public:
  /// Notes a row that is left out.
  /// @param what The name of the row, for a message.
  /// @param row Its number in the table; 0: it is not known.
  void leave_out(const std::string& what, const std::string& table, std::int64_t row);
  /// How many rows there are.
  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  /// The names of the rows, each name once.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Whether any of the rows is in a table.
  [[nodiscard]] bool is_in(const std::string& table) const;
  /// Removes the rows from the file. @throws InputError it is not known where one of them is.
  void remove_from(const sqlite::Database& database) const;
  /// Says that the rows of a table were left behind when the table was made anew: there is nothing
  /// to remove, and their numbers may be those of other rows now.
  void leave_behind(const std::string& table);
  /// Forgets what was found.
  void clear() { rows_.clear(); }

 private:
  struct Place {
    std::string table;
    std::int64_t row = 0;
    bool is_in_file = true;
  };
  /// The place of each row, by its name and number.
  std::map<std::pair<std::string, std::int64_t>, Place> rows_;
};

/// Looks for rows that no reading finds: those whose key was damaged, so that they belong to
/// nothing, and those that are missing in the index of their table.
/// @returns A text for each table that has any.
[[nodiscard]] std::vector<std::string> list_lost_rows(const sqlite::Database& database);

}  // namespace palpate::storage
