// SPDX-License-Identifier: BSD-3-Clause
// Names on the disk. That a file was made, renamed or removed outlives a loss of power only when
// the folder of the file was synced afterwards.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// Waits until the names of the folder that holds a file are on the disk. Does nothing where the
/// file system cannot sync a folder.
/// @throws BackendError the disk failed.
void sync_folder_of(const std::filesystem::path& file);

/// The names of what is in the folder that holds a file, in no order; none where it cannot be
/// listed. (std::filesystem::directory_iterator ends the process where memory is short.)
[[nodiscard]] std::vector<std::string> names_beside(const std::filesystem::path& file);

}  // namespace palpate
