// SPDX-License-Identifier: BSD-3-Clause
// A table whose rows belong to tool spaces and lie at check-points. Its sound rows are found and
// read also if others are damaged.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "storage/connection.h"
#include "storage/table.h"
#include "storage/tool_spaces.h"

namespace palpate::storage {

class ToolSpaceRows {
 protected:
  using Statement = sqlite::Statement;

  /// @param name The name of the table.
  ToolSpaceRows(Connection& connection, const ToolSpaces& tool_spaces, const std::string& name)
      : connection_(connection), tool_spaces_(tool_spaces), table_(name) {}
  ~ToolSpaceRows() = default;

  /// Reads the sound rows of a tool space, in the order of the key; others are left out.
  /// @param columns The columns that are read. @param condition A condition on the row, in SQL.
  /// @param take Takes the columns from the statement, and returns whether the row is sound.
  /// @param describe Gives the name of a record, for a message.
  template <class Record, class Take, class Describe>
  [[nodiscard]] std::vector<Record> read_rows(const ToolSpaceKey& key, const std::string& columns,
                                              const std::string& condition, const Take& take,
                                              const Describe& describe) const {
    std::vector<Record> records;
    const auto take_row = [&](Statement& select, std::int64_t row) {
      if (take(select, records.emplace_back())) return;
      connection_.damage().leave_out(describe(records.back()), table_.name(), row);
      records.pop_back();
    };
    try {
      Statement select(connection_.database(), "SELECT rowid, " + columns + " FROM " +
                                                   table_.name() + of_space(condition) +
                                                   " ORDER BY " + order(""));
      bind(key, select);
      while (select.step()) {
        const std::int64_t row = select.take_integer();
        take_row(select, row);
      }
      return records;
    } catch (const InputError&) {
      // A part of the table cannot be read: the other rows are read one by one.
      records.clear();
    }
    for (const auto& [row, check_point] : list_rows(key, condition)) {
      if (!read_alone(columns, row, take_row)) leave_out(key, row, check_point);
    }
    return records;
  }

  /// Binds the number of the body and that of the tool space.
  static void bind(const ToolSpaceKey& key, Statement& statement);
  /// The condition for the row of one configuration, whose parameters bind_key() binds.
  static constexpr char kAtKey[] =
      " WHERE scene_id = ? AND tool_space_id = ? AND i = ? AND j = ? AND k = ? AND level = ?";
  static void bind_key(const ToolSpaceKey& key, const CheckPoint& check_point, std::int32_t level,
                       Statement& statement);

  Connection& connection_;
  const ToolSpaces& tool_spaces_;
  Table table_;

 private:
  /// The condition " WHERE …" for the rows of a tool space.
  [[nodiscard]] static std::string of_space(const std::string& condition);
  /// The columns of the key after those of the tool space, each with a direction.
  [[nodiscard]] std::string order(const std::string& direction) const;
  /// The numbers and check-points of the rows, as far as they can be listed, in the order of the
  /// key.
  [[nodiscard]] std::vector<std::pair<std::int64_t, CheckPoint>> list_rows(
      const ToolSpaceKey& key, const std::string& condition) const;
  void leave_out(const ToolSpaceKey& key, std::int64_t row, const CheckPoint& check_point) const;

  /// @returns False: the row cannot be read.
  template <class TakeRow>
  [[nodiscard]] bool read_alone(const std::string& columns, std::int64_t row,
                                const TakeRow& take_row) const {
    try {
      Statement select(connection_.database(),
                       "SELECT rowid, " + columns + " FROM " + table_.name() + " WHERE rowid = ?");
      select.bind(row);
      if (!select.step()) return false;
      take_row(select, select.take_integer());
      return true;
    } catch (const InputError&) {
      return false;
    }
  }
};

}  // namespace palpate::storage
