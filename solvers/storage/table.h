// SPDX-License-Identifier: BSD-3-Clause
// The columns of a table, as schema.sql.h has them: no statement names them once more.
#pragma once

#include <string>
#include <vector>

namespace palpate::storage {

class Table {
 public:
  /// @param name One of the tables of schema.sql.h.
  explicit Table(std::string name);

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Its columns from `first` to the one before `end`, or to the last: "i, j, k".
  [[nodiscard]] std::string columns(const std::string& first, const std::string& end) const;
  /// The columns of its key from `first` on.
  [[nodiscard]] std::vector<std::string> key_from(const std::string& first) const;
  /// "INSERT OR REPLACE INTO … (…)": all columns.
  /// @param where_there_is_one What SQLite does where there is one already: REPLACE, IGNORE or
  ///   ABORT.
  [[nodiscard]] std::string insert_into(const std::string& where_there_is_one = "REPLACE") const;
  /// "?1, ?2, …", for each column.
  [[nodiscard]] std::string parameters() const;
  /// A statement that stores a row of values, which are bound in the order of the columns.
  [[nodiscard]] std::string insert(const std::string& where_there_is_one = "REPLACE") const {
    return insert_into(where_there_is_one) + " VALUES (" + parameters() + ')';
  }

 private:
  std::string name_;
  std::vector<std::string> columns_;
  std::vector<std::string> key_;
};

}  // namespace palpate::storage
