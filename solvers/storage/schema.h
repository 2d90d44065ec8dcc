// SPDX-License-Identifier: BSD-3-Clause
// The tables of a state-space file as they are made, and as they are expected.
#pragma once

#include <cstdint>
#include <string>

#include "storage/sqlite.h"

namespace palpate::storage {

inline constexpr std::int64_t kSchemaVersion = 10;
/// The oldest version that is read. The next writer of such a file makes it one of this version.
inline constexpr std::int64_t kOldestSchemaVersion = 5;

/// Makes the tables of an empty file, but those that not every file has.
void make_schema(const sqlite::Database& database);

[[nodiscard]] bool has_table(const sqlite::Database& database, const std::string& name);
/// Makes a table that not every file has, see optional_tables, unless it is there.
void make_table(const sqlite::Database& database, const std::string& name);

/// Checks the schema of a file, and gives its version. When this returns, the file holds the tables
/// of that version and nothing else: no trigger, no view, nothing that is computed when it is read.
/// @throws InputError the file is another program's, of another version, or has other tables than
///   those that Palpate makes.
[[nodiscard]] std::int64_t check_schema(const sqlite::Database& database);

}  // namespace palpate::storage
