// SPDX-License-Identifier: BSD-3-Clause
// A file that is opened to be read.
#pragma once

#include <filesystem>
#include <fstream>

namespace palpate {

/// Opens a file of a disk, and nothing else: a pipe keeps a program waiting until somebody writes
/// to it, and a device may never end.
/// @throws InputError there is none, it may not be read, or it is no ordinary file.
[[nodiscard]] std::ifstream open_to_read(const std::filesystem::path& path);

}  // namespace palpate
