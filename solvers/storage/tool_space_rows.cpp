// SPDX-License-Identifier: BSD-3-Clause
#include "storage/tool_space_rows.h"

#include <algorithm>
#include <cstddef>
#include <set>

#include "base/join.h"
#include "storage/stored_kind.h"

namespace palpate::storage {

void ToolSpaceRows::bind(const ToolSpaceKey& key, Statement& statement) {
  statement.bind(key.body);
  statement.bind(key.id);
}

void ToolSpaceRows::bind_key(const ToolSpaceKey& key, const CheckPoint& check_point,
                             std::int32_t level, Statement& statement) {
  bind(key, statement);
  for (const std::int32_t x : check_point) statement.bind(std::int64_t{x});
  statement.bind(std::int64_t{level});
}

std::string ToolSpaceRows::of_space(const std::string& condition) {
  return " WHERE scene_id = ? AND tool_space_id = ? AND " + condition;
}

std::string ToolSpaceRows::order(const std::string& direction) const {
  std::vector<std::string> columns = table_.key_from("i");
  for (std::string& column : columns) column += direction;
  return join(columns);
}

std::vector<std::pair<std::int64_t, CheckPoint>> ToolSpaceRows::list_rows(
    const ToolSpaceKey& key, const std::string& condition) const {
  // Read from both ends up to where the rows cannot be read. The index of the key holds all columns
  // that are asked for.
  std::vector<std::pair<std::int64_t, CheckPoint>> listed;
  std::set<std::int64_t> numbers;
  for (const char* direction : {" ASC", " DESC"}) {
    const auto first = static_cast<std::ptrdiff_t>(listed.size());
    try {
      Statement select(connection_.database(), "SELECT rowid, i, j, k FROM " + table_.name() +
                                                   of_space(condition) + " ORDER BY " +
                                                   order(direction));
      bind(key, select);
      while (select.step()) {
        const std::int64_t row = select.take_integer();
        CheckPoint check_point;
        for (auto& x : check_point) x = static_cast<std::int32_t>(select.take_integer());
        if (numbers.insert(row).second) listed.emplace_back(row, check_point);
      }
      break;
    } catch (const InputError&) {
      connection_.damage().leave_out("rows of the table " + table_.name() + " of " +
                                         number_of(key) + " that cannot be told apart",
                                     table_.name(), 0);
    }
    if (first > 0) std::reverse(listed.begin() + first, listed.end());
  }
  return listed;
}

void ToolSpaceRows::leave_out(const ToolSpaceKey& key, std::int64_t row,
                              const CheckPoint& check_point) const {
  connection_.damage().leave_out("a row of the table " + table_.name() + " at " +
                                     describe(check_point) + " of " + number_of(key),
                                 table_.name(), row);
}

}  // namespace palpate::storage
