// SPDX-License-Identifier: BSD-3-Clause
// The tables of a state-space file as they were made, and as they are expected.
#pragma once

#include <cstdint>

#include "storage/sqlite.h"

namespace palpate {

inline constexpr std::int64_t kSchemaVersion = 10;
/// The oldest version that is read. The next writer of such a file makes it one of this version.
inline constexpr std::int64_t kOldestSchemaVersion = 5;

/// Makes the tables of an empty file.
void make_schema(const sqlite::Database& database);

/// Makes the table of reduced models, unless it is there.
void make_reduced_schema(const sqlite::Database& database);
[[nodiscard]] bool has_reduced_schema(const sqlite::Database& database);

/// Makes the table of the body force.
void make_body_force_schema(const sqlite::Database& database);
[[nodiscard]] bool has_body_force_schema(const sqlite::Database& database);
/// The same for the offset of a rigid tool's layer, unless the table is there.
void make_contact_offset_schema(const sqlite::Database& database);
[[nodiscard]] bool has_contact_offset_schema(const sqlite::Database& database);

/// Makes the table of what holds and loads the surface.
void make_boundary_schema(const sqlite::Database& database);
[[nodiscard]] bool has_boundary_schema(const sqlite::Database& database);

/// Checks the schema of a file, and gives its version. When this returns, the file holds the tables
/// of that version and nothing else: no trigger, no view, nothing that is computed when it is read.
/// @throws InputError the file is another program's, of another version, or has other tables than
///   those that Palpate makes.
[[nodiscard]] std::int64_t check_schema(const sqlite::Database& database);

/// Shows the tables of an older version under the names and with the columns of this one, to this
/// connection alone: as temporary views. What an older version lacks is NULL.
void show_as_this_version(const sqlite::Database& database, std::int64_t version);
/// Makes an end of that.
void show_as_it_is(const sqlite::Database& database);

/// Makes the tables of an older version those of this one. The tables `tool_space` and `basis` are
/// empty then, and columns that the older one lacks have no values.
void convert_schema(const sqlite::Database& database, std::int64_t version);

}  // namespace palpate
