// SPDX-License-Identifier: BSD-3-Clause
#include "storage/versions.h"

#include <algorithm>
#include <cctype>

#include "storage/schema.h"
#include "storage/schema.sql.h"

namespace palpate::storage {
namespace {

using sqlite::Database;

/// The table that stood in place of `tool_space` before version 7.
constexpr char kSite[] =
    "CREATE TABLE site(scene_id INTEGER NOT NULL REFERENCES scene,active_node INTEGER NOT NULL,"
    "tip_radius,half_width,resolution INTEGER NOT NULL,force_limit,coarsest INTEGER NOT NULL,"
    "tolerance,tolerance_is_relative INTEGER NOT NULL,history INTEGER NOT NULL,intermediate_states "
    "INTEGER NOT NULL,third_derivatives INTEGER NOT NULL,complete INTEGER NOT NULL,"
    "checksum INTEGER,PRIMARY KEY(scene_id,active_node))";
/// The table `tool_space` in version 7, which knew no rigid tool.
constexpr char kToolSpaceOf7[] =
    "CREATE TABLE tool_space(scene_id INTEGER NOT NULL REFERENCES scene,tool_space_id INTEGER NOT "
    "NULL,interaction INTEGER NOT NULL,material_point BLOB NOT NULL,active_node INTEGER NOT NULL,"
    "tip_radius,half_width,resolution INTEGER NOT NULL,force_limit,coarsest INTEGER NOT NULL,"
    "tolerance,tolerance_is_relative INTEGER NOT NULL,history INTEGER NOT NULL,intermediate_states "
    "INTEGER NOT NULL,third_derivatives INTEGER NOT NULL,complete INTEGER NOT NULL,"
    "checksum INTEGER NOT NULL,PRIMARY KEY(scene_id,tool_space_id))";
/// The columns that were added since, with the values of a bonded tool.
constexpr char kNoRigidTool[] =
    "0 AS tool_shape, 0.0 AS tool_radius, X'00000000000000000000000000000000000000000000F03F' AS "
    "tool_axis, 0.0 AS tool_length, NULL AS tool_points, NULL AS tool_triangles, 0.0 AS "
    "contact_thickness, 0.0 AS contact_stiffness, zeroblob(24) AS origin, 0 AS sparse, 0.0 AS "
    "depth";
/// The tables `basis` and `mode` in version 9, in which each mode had a row: numbers of half or of
/// single precision.
constexpr char kBasisOf9[] =
    "CREATE TABLE basis(scene_id INTEGER NOT NULL REFERENCES scene,tool_space_id INTEGER NOT NULL,"
    "number INTEGER NOT NULL,first_i INTEGER NOT NULL,first_j INTEGER NOT NULL,first_k INTEGER NOT "
    "NULL,last_i INTEGER NOT NULL,last_j INTEGER NOT NULL,last_k INTEGER NOT NULL,keep INTEGER NOT "
    "NULL,num_modes INTEGER NOT NULL,num_pressure_modes INTEGER NOT NULL,num_pressures INTEGER NOT "
    "NULL,largest_displacement,displacement_error,sensitivity_error,checksum INTEGER NOT NULL,"
    "PRIMARY KEY(scene_id,tool_space_id,number))";
constexpr char kModeOf9[] =
    "CREATE TABLE mode(scene_id INTEGER NOT NULL REFERENCES scene,tool_space_id INTEGER NOT NULL,"
    "basis INTEGER NOT NULL,of_pressure INTEGER NOT NULL,number INTEGER NOT NULL,checksum INTEGER "
    "NOT NULL,field BLOB NOT NULL,PRIMARY KEY(scene_id,tool_space_id,basis,of_pressure,number))";
/// The column that the tables `scene` and `site` lack in version 5.
constexpr char kChecksumColumn[] = "checksum INTEGER";
/// The tables whose key has the number of a tool space, which was an active node before version 7.
constexpr const char* kTablesOfToolSpaces[] = {"configuration", "transition", "intermediate",
                                               "test_point"};
constexpr char kToolSpaceId[] = "tool_space_id";
constexpr char kActiveNode[] = "active_node";

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

}  // namespace

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

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
    text.replace(at, what.size(), by);
  }
  return text;
}

}  // namespace

std::map<std::string, std::string> tables_of_version(std::int64_t version) {
  constexpr char kCreate[] = "CREATE TABLE ";
  const std::string all = bare(kSchema);
  std::map<std::string, std::string> tables;
  for (std::size_t begin = 0; begin < all.size();) {
    const std::size_t end = all.find(';', begin);
    std::string statement = all.substr(begin, end - begin);
    const std::size_t at = sizeof kCreate - 1;
    std::string name = statement.substr(at, statement.find('(') - at);
    begin = end + 1;
    if (name == "basis" && version < 9) continue;
    if (name == "basis" && version == 9) {
      statement = kBasisOf9;
      tables["mode"] = kModeOf9;
    }
    if (version < 7 && name == "tool_space") {
      name = "site";
      statement = kSite;
    } else if (version < 8 && name == "tool_space") {
      statement = kToolSpaceOf7;
    } else if (version < 7) {
      statement = replaced(std::move(statement), kToolSpaceId, kActiveNode);
    }
    if (version < 6 && (name == "scene" || name == "site")) {
      const std::string added = std::string(",") + kChecksumColumn;
      statement.erase(statement.find(added), added.size());
    }
    tables[name] = statement;
  }
  if (version >= 10) {
    for (const auto& [name, schema] : optional_tables) {
      const std::string made = bare(schema);
      tables[name] = made.substr(0, made.find(';'));
    }
  }
  return tables;
}

void show_as_this_version(const Database& database, std::int64_t version) {
  if (version == 9) {
    database.execute(
        "CREATE TEMP VIEW basis AS SELECT rowid AS rowid, *, 0 AS modes_checksum FROM main.basis");
  }
  if (version >= 8) return;
  if (version == 7) {
    database.execute(std::string("CREATE TEMP VIEW tool_space AS SELECT rowid AS rowid, *, ") +
                     kNoRigidTool + " FROM main.tool_space");
    return;
  }
  const std::string checksum = version < 6 ? "NULL AS checksum" : "checksum";
  // The material point is where the active node is at rest.
  database.execute(
      std::string(
          "CREATE TEMP VIEW tool_space AS SELECT rowid AS rowid, scene_id, active_node AS "
          "tool_space_id, "
          "0 AS interaction, substr((SELECT points FROM main.scene AS s WHERE s.scene_id = "
          "site.scene_id), 24 * active_node + 1, 24) AS material_point, active_node, tip_radius, "
          "half_width, resolution, force_limit, coarsest, tolerance, tolerance_is_relative, "
          "history, "
          "intermediate_states, third_derivatives, complete, ") +
      kNoRigidTool + ", " + checksum + " FROM main.site");
  for (const std::string table : kTablesOfToolSpaces) {
    database.execute("CREATE TEMP VIEW " + table + " AS SELECT rowid AS rowid, *, " + kActiveNode +
                     " AS " + kToolSpaceId + " FROM main." + table);
  }
}

void show_as_it_is(const Database& database) {
  database.execute("DROP VIEW IF EXISTS temp.tool_space");
  database.execute("DROP VIEW IF EXISTS temp.basis");
  for (const std::string table : kTablesOfToolSpaces) {
    database.execute("DROP VIEW IF EXISTS temp." + table);
  }
}

void convert_schema(const Database& database, std::int64_t version) {
  if (version < 6) {
    database.execute(std::string("ALTER TABLE scene ADD COLUMN ") + kChecksumColumn);
  }
  if (version < 7) {
    for (const std::string table : kTablesOfToolSpaces) {
      database.execute("ALTER TABLE " + table + " RENAME COLUMN " + kActiveNode + " TO " +
                       kToolSpaceId);
    }
  }
  database.execute(version < 7 ? "DROP TABLE site" : "DROP TABLE tool_space");
  const std::map<std::string, std::string> tables = tables_of_version(kSchemaVersion);
  database.execute(tables.at("tool_space"));
  if (version == 9) database.execute("DROP TABLE basis; DROP TABLE mode");
  database.execute(tables.at("basis"));
  database.execute("PRAGMA user_version = " + std::to_string(kSchemaVersion));
}

}  // namespace palpate::storage
