// SPDX-License-Identifier: BSD-3-Clause
// The tables of files of older versions, which are shown as those of this version, or converted.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "storage/sqlite.h"

namespace palpate::storage {

/// A statement without its comments and with no more spaces than are needed to tell words apart.
[[nodiscard]] std::string bare(const std::string& sql);

/// The bare statements that make the tables of a version, by table.
[[nodiscard]] std::map<std::string, std::string> tables_of_version(std::int64_t version);

/// Shows the tables of an older version under the names and with the columns of this one, to this
/// connection alone: as temporary views. What an older version lacks is NULL.
void show_as_this_version(const sqlite::Database& database, std::int64_t version);
/// Removes these views again.
void show_as_it_is(const sqlite::Database& database);

/// Makes the tables of an older version those of this one. The tables `tool_space` and `basis` are
/// empty then, and columns that the older one lacks have no values.
void convert_schema(const sqlite::Database& database, std::int64_t version);

}  // namespace palpate::storage
