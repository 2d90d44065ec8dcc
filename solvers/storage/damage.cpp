// SPDX-License-Identifier: BSD-3-Clause
#include "storage/damage.h"

#include <algorithm>

#include "base/error.h"
#include "base/printable.h"
#include "storage/schema.h"

namespace palpate {

std::string describe_left_out(const std::filesystem::path& path,
                              const std::vector<std::string>& left_out) {
  constexpr std::size_t kNamed = 5;
  std::string names;
  for (std::size_t i = 0; i < std::min(kNamed, left_out.size()); ++i) {
    names += (i > 0 ? ", " : "") + left_out[i];
  }
  if (left_out.size() > kNamed)
    names += " and " + std::to_string(left_out.size() - kNamed) + " more";
  return (left_out.size() == 1 ? "A part of " : std::to_string(left_out.size()) + " parts of ") +
         quoted(path) + (left_out.size() == 1 ? " is" : " are") + " damaged: " + names + '.';
}

}  // namespace palpate

namespace palpate::storage {
namespace {

/// The thing that the rows of a table belong to, besides a body.
enum class Owner { body, tool_space, model };

struct Rows {
  std::string table;
  Owner owner = Owner::tool_space;
  /// The first columns of the key, by which rows are looked for.
  std::string key = "scene_id, tool_space_id";
};

const std::vector<Rows>& all_rows() {
  static const std::vector<Rows> all = {
      {"tool_space", Owner::body},
      {"test_point", Owner::body, "scene_id, tool_space_id, tip_radius, half_width, seed"},
      {"configuration"},
      {"mesh_error"},
      {"turn_derivative"},
      {"transition"},
      {"intermediate"},
      {"basis"},
      {"reduced_array", Owner::model, "scene_id, model, name"},
  };
  return all;
}

}  // namespace

void throw_damaged(const std::filesystem::path& path, const std::string& what) {
  throw InputError(quoted(path) + " is damaged (" + what + "). Take a copy that is " +
                   "whole, or give another file name and compute it again.");
}

void Damage::leave_out(const std::string& what, const std::string& table, std::int64_t row) {
  rows_[{what, row}] = Place{table, row, true};
}

void Damage::leave_behind(const std::string& table) {
  for (auto& [key, place] : rows_) {
    if (place.table == table) place.is_in_file = false;
  }
}

std::vector<std::string> Damage::names() const {
  std::vector<std::string> names;
  for (const auto& [key, place] : rows_) {
    if (names.empty() || names.back() != key.first) names.push_back(key.first);
  }
  return names;
}

bool Damage::is_in(const std::string& table) const {
  return std::any_of(rows_.begin(), rows_.end(),
                     [&](const auto& row) { return row.second.table == table; });
}

void Damage::remove_from(const sqlite::Database& database) const {
  for (const auto& [key, place] : rows_) {
    if (!place.is_in_file) continue;
    if (place.row == 0) throw_damaged(database.path(), key.first);
    sqlite::Statement remove(database, "DELETE FROM " + place.table + " WHERE rowid = ?");
    remove.bind(place.row);
    remove.run();
  }
}

std::vector<std::string> list_lost_rows(const sqlite::Database& database) {
  std::vector<std::string> names;
  for (const auto& [table, owner, key] : all_rows()) {
    // Not every file has these tables.
    const bool may_lack = table == "basis" || table == "mesh_error" || table == "turn_derivative" ||
                          owner == Owner::model;
    if (may_lack && !has_table(database, table)) continue;
    const std::string of_table = "rows of the table " + table;
    const auto count = [&](const std::string& from) {
      return database.integer("SELECT count(*) FROM " + from);
    };
    try {
      const std::string no_tool_space =
          " OR (scene_id, tool_space_id) NOT IN (SELECT scene_id, tool_space_id FROM tool_space)";
      const std::int64_t of_nothing =
          count(table + " WHERE scene_id NOT IN (SELECT scene_id FROM scene)" +
                (owner == Owner::tool_space ? no_tool_space : ""));
      if (of_nothing > 0) {
        names.push_back(std::to_string(of_nothing) + ' ' + of_table + " that belong to no " +
                        (owner == Owner::model ? "model" : "tool space"));
      }
      const std::string found = "(SELECT DISTINCT " + key + " FROM " + table +
                                " NOT INDEXED) CROSS JOIN " + table + " USING (" + key + ")";
      if (count(found) != count(table + " NOT INDEXED") || count(table) != count(found)) {
        names.push_back(of_table + " that are not in its index");
      }
    } catch (const InputError&) {
      names.push_back(of_table + " that cannot be listed");
    }
  }
  return names;
}

}  // namespace palpate::storage
