// SPDX-License-Identifier: BSD-3-Clause
// Creates, opens and closes the database of a state-space file, also after a writer was killed.
#pragma once

#include <filesystem>

#include "assembly/scene.h"
#include "storage/sqlite.h"

namespace palpate::storage {

/// Makes the file of a scene under a name that no file has. It appears complete or not at all.
/// @returns False: by now another file has this name.
/// @throws InputError its folder is missing, the body is too large, or a log is there without its
///   file.
[[nodiscard]] bool make_file(const std::filesystem::path& path, const Scene& scene,
                             const SettledBody& at_rest, double solver_tolerance);

/// Whether a log lies beside the file: then a writer is at work, or was killed.
[[nodiscard]] bool has_log(const std::filesystem::path& path);

/// Opens with the file locked for this program alone: then the log needs no shared memory, and
/// works on network disks. The schema is checked, see check_schema().
/// @throws InputError it is missing, or no state space. @throws BackendError another program has
/// it.
[[nodiscard]] sqlite::Database open_exclusively(const std::filesystem::path& path);

/// Opens to read, also where nothing may be written; the log of a writer that was killed is put
/// into the file.
/// @throws InputError, BackendError as open_exclusively() does.
[[nodiscard]] sqlite::Database open_to_read(const std::filesystem::path& path);

/// Closes a file that was opened exclusively: afterwards it has no log beside it, and is durable.
/// @throws BackendError the file was moved, or the log stays.
void close_as_single_file(sqlite::Database database);

/// @throws BackendError the log of a file cannot be put into it.
[[noreturn]] void throw_log_stays(const std::filesystem::path& path);

}  // namespace palpate::storage
