// SPDX-License-Identifier: BSD-3-Clause
// Names on the disk. The creation, renaming or removal of a file survives a loss of power only once
// the folder of the file has been synced.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// Waits until the names of the folder that holds a file are on the disk. Does nothing where the
/// file system cannot sync a folder.
/// @throws BackendError the disk failed.
void sync_folder_of(const std::filesystem::path& file);

/// The names in the folder that holds a file, unsorted; empty where it cannot be listed.
/// (std::filesystem::directory_iterator ends the process when memory runs out.)
[[nodiscard]] std::vector<std::string> names_beside(const std::filesystem::path& file);

}  // namespace palpate
