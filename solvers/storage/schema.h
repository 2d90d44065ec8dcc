// SPDX-License-Identifier: BSD-3-Clause
// Makes the tables of a state-space file, and checks that a file has these tables.
#pragma once

#include <cstdint>
#include <string>

#include "storage/sqlite.h"

namespace palpate::storage {

inline constexpr std::int64_t kSchemaVersion = 10;
/// The oldest version that is read. The next writer of such a file makes it one of this version.
inline constexpr std::int64_t kOldestSchemaVersion = 5;

/// Makes the tables of an empty file, except the optional ones.
void make_schema(const sqlite::Database& database);

[[nodiscard]] bool has_table(const sqlite::Database& database, const std::string& name);
/// Makes an optional table (see optional_tables), unless the file has it.
void make_table(const sqlite::Database& database, const std::string& name);

/// Checks the schema of a file, and gives its version. When this returns, the file holds the tables
/// of that version and nothing else: no trigger, no view, no column that is computed when it is
/// read.
/// @throws InputError the file is another program's, of another version, or has other tables than
///   those that Palpate makes.
[[nodiscard]] std::int64_t check_schema(const sqlite::Database& database);

}  // namespace palpate::storage
