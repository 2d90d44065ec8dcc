// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/schema.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <string>

#include "base/error.h"
#include "state_space/schema.sql.h"

namespace palpate {
namespace {

using sqlite::Database;
using sqlite::Statement;

constexpr std::int64_t kApplicationId = 0x50616c70;

/// What version 5 does not have, in the tables `scene` and `site`.
constexpr char kChecksumColumn[] = "checksum INTEGER";

std::string quoted(const Database& database) { return '\'' + database.path().string() + '\''; }

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// The statement without its comments and with no more spaces than are needed to tell words apart.
std::string bare(const std::string& sql) {
  std::string result;
  bool after_space = false;
  for (std::size_t i = 0; i < sql.size(); ++i) {
    if (sql.compare(i, 2, "--") == 0) i = std::min(sql.find('\n', i), sql.size() - 1);
    if (std::isspace(static_cast<unsigned char>(sql[i])) != 0) {
      after_space = true;
      continue;
    }
    if (after_space && is_word(sql[i]) && !result.empty() && is_word(result.back())) result += ' ';
    result += sql[i];
    after_space = false;
  }
  return result;
}

/// The statements that make the tables of a version, by table.
std::map<std::string, std::string> expected_tables(std::int64_t version) {
  constexpr char kCreate[] = "CREATE TABLE ";
  const std::string all = bare(kSchema);
  std::map<std::string, std::string> tables;
  for (std::size_t begin = 0; begin < all.size();) {
    const std::size_t end = all.find(';', begin);
    std::string statement = all.substr(begin, end - begin);
    const std::size_t at = sizeof kCreate - 1;
    const std::string name = statement.substr(at, statement.find('(') - at);
    if (version < kSchemaVersion && (name == "scene" || name == "site")) {
      const std::string added = std::string(",") + kChecksumColumn;
      statement.erase(statement.find(added), added.size());
    }
    tables[name] = statement;
    begin = end + 1;
  }
  return tables;
}

[[noreturn]] void refuse(const Database& database, const std::string& what) {
  throw InputError(quoted(database) + " is not as Palpate makes its files: " + what +
                   ". It may have been changed on purpose: take a copy that you trust.");
}

}  // namespace

void make_schema(const Database& database) {
  database.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
  database.execute("PRAGMA user_version = " + std::to_string(kSchemaVersion));
  database.execute(kSchema);
}

std::int64_t check_schema(const Database& database) {
  if (database.integer("PRAGMA application_id") != kApplicationId) {
    throw InputError(quoted(database) + " is an SQLite file of another program, not a Palpate " +
                     "state space. Give another file name.");
  }
  const std::int64_t version = database.integer("PRAGMA user_version");
  if (version < kOldestSchemaVersion || version > kSchemaVersion) {
    throw InputError(
        quoted(database) + " has version " + std::to_string(version) +
        " of the schema; this program knows versions " + std::to_string(kOldestSchemaVersion) +
        " to " + std::to_string(kSchemaVersion) + ". " +
        (version > kSchemaVersion ? "Use a newer Palpate." : "Compute the state space again."));
  }
  std::map<std::string, std::string> missing = expected_tables(version);
  Statement select(database, "SELECT type, name, tbl_name, sql FROM sqlite_master");
  while (select.step()) {
    const std::string type = select.take_text();
    const std::string name = select.take_text();
    const std::string table = select.take_text();
    const std::string sql = select.take_text();
    // What a primary key is looked up by.
    if (type == "index" && sql.empty() && name == "sqlite_autoindex_" + table + "_1") continue;
    const auto expected = missing.find(name);
    if (type != "table" || expected == missing.end()) {
      refuse(database, "it has the " + type + " '" + name + '\'');
    }
    if (bare(sql) != expected->second) refuse(database, "its table '" + name + "' is another");
    missing.erase(expected);
  }
  if (!missing.empty()) {
    refuse(database, "it lacks the table '" + missing.begin()->first + '\'');
  }
  return version;
}

void extend_schema(const Database& database) {
  for (const char* table : {"scene", "site"}) {
    database.execute(std::string("ALTER TABLE ") + table + " ADD COLUMN " + kChecksumColumn);
  }
  database.execute("PRAGMA user_version = " + std::to_string(kSchemaVersion));
}

}  // namespace palpate
