// SPDX-License-Identifier: BSD-3-Clause
#include "storage/schema.h"

#include <map>
#include <string>

#include "base/error.h"
#include "base/printable.h"
#include "storage/schema.sql.h"
#include "storage/versions.h"

namespace palpate::storage {
namespace {

using sqlite::Database;
using sqlite::Statement;

constexpr std::int64_t kApplicationId = 0x50616c70;

[[noreturn]] void refuse(const Database& database, const std::string& what) {
  throw InputError(quoted(database.path()) + " is not as Palpate makes its files: " + what +
                   ". It may have been changed on purpose: take a copy that you trust.");
}

}  // namespace

void make_schema(const Database& database) {
  database.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
  database.execute("PRAGMA user_version = " + std::to_string(kSchemaVersion));
  database.execute(kSchema);
}

bool has_table(const Database& database, const std::string& name) {
  return database.integer("SELECT count(*) FROM sqlite_master WHERE name = '" + name + '\'') > 0;
}

void make_table(const Database& database, const std::string& name) {
  for (const auto& [optional, schema] : optional_tables) {
    if (name == optional && !has_table(database, name)) database.execute(schema);
  }
}

std::int64_t check_schema(const Database& database) {
  if (database.integer("PRAGMA application_id") != kApplicationId) {
    throw InputError(quoted(database.path()) +
                     " is an SQLite file of another program, not a Palpate " +
                     "state space. Give another file name.");
  }
  const std::int64_t version = database.integer("PRAGMA user_version");
  if (version < kOldestSchemaVersion || version > kSchemaVersion) {
    throw InputError(
        quoted(database.path()) + " has version " + std::to_string(version) +
        " of the schema; this program knows versions " + std::to_string(kOldestSchemaVersion) +
        " to " + std::to_string(kSchemaVersion) + ". " +
        (version > kSchemaVersion ? "Use a newer Palpate." : "Compute the state space again."));
  }
  std::map<std::string, std::string> missing = tables_of_version(version);
  Statement select(database, "SELECT type, name, tbl_name, sql FROM sqlite_master");
  while (select.step()) {
    const std::string type = select.take_text();
    const std::string name = select.take_text();
    const std::string table = select.take_text();
    const std::string sql = select.take_text();
    // This is the index that SQLite makes for a primary key.
    if (type == "index" && sql.empty() && name == "sqlite_autoindex_" + table + "_1") continue;
    const auto expected = missing.find(name);
    if (type != "table" || expected == missing.end()) {
      refuse(database, "it has the " + printable(type) + " '" + printable(name) + '\'');
    }
    if (bare(sql) != expected->second) refuse(database, "its table '" + name + "' is another");
    missing.erase(expected);
  }
  for (const auto& [name, schema] : optional_tables) missing.erase(name);
  if (!missing.empty()) {
    refuse(database, "it lacks the table '" + missing.begin()->first + '\'');
  }
  return version;
}

}  // namespace palpate::storage
