// SPDX-License-Identifier: BSD-3-Clause
// The tables of a state-space file as they were made, and as they are expected.
#pragma once

#include <cstdint>

#include "state_space/sqlite.h"

namespace palpate {

inline constexpr std::int64_t kSchemaVersion = 6;
/// The oldest version that is read. The next writer of such a file makes it one of this version.
inline constexpr std::int64_t kOldestSchemaVersion = 5;

/// Makes the tables of an empty file.
void make_schema(const sqlite::Database& database);

/// Checks the schema of a file, and gives its version. When this returns, the file holds the tables
/// of that version and nothing else: no trigger, no view, nothing that is computed when it is read.
/// @throws InputError the file is another program's, of another version, or has other tables than
///   those that Palpate makes.
[[nodiscard]] std::int64_t check_schema(const sqlite::Database& database);

/// Adds the columns that an older version lacks, without values, and says that it is of this
/// version.
void extend_schema(const sqlite::Database& database);

}  // namespace palpate
