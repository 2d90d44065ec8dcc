// SPDX-License-Identifier: BSD-3-Clause
// Opens a file for reading.
#pragma once

#include <filesystem>
#include <fstream>

namespace palpate {

/// Opens a regular file, and nothing else: a pipe would block the program until another one writes
/// to it, and a device may never end.
/// @throws InputError the file does not exist, may not be read, or is not a regular file.
[[nodiscard]] std::ifstream open_to_read(const std::filesystem::path& path);

}  // namespace palpate
