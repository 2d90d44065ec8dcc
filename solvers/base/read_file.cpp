// SPDX-License-Identifier: BSD-3-Clause
#include "base/read_file.h"

#include <cerrno>
#include <string>
#include <system_error>

#include "base/error.h"
#include "base/printable.h"

namespace palpate {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw InputError("The file " + quoted(path) + why);
}

}  // namespace

std::ifstream open_to_read(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (is_directory(status)) refuse(path, " is a folder. Name a file in it.");
  if (is_other(status)) {
    refuse(path,
           " is a pipe, a device or the like. Put what comes from it into a file, and name that.");
  }
  std::ifstream stream;
  if (is_regular_file(status)) {
    errno = 0;
    stream.open(path, std::ios::binary);
    error = {errno, std::generic_category()};
  }
  if (!stream.is_open()) {
    refuse(path, " cannot be opened: " + error.message() +
                     ". Name a file that is there and may be read.");
  }
  return stream;
}

}  // namespace palpate
