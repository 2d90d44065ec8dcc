// SPDX-License-Identifier: BSD-3-Clause
#include "base/folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "base/error.h"

namespace palpate {

void sync_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // It may be written to, but not be listed.
  const bool failed = ::fsync(descriptor) != 0 && errno == EIO;
  ::close(descriptor);
  if (failed) {
    throw BackendError("The folder '" + folder.string() + "' cannot be written to the disk (" +
                       std::strerror(EIO) + "). Check the disk.");
  }
}

std::vector<std::string> names_beside(const std::filesystem::path& file) {
  const std::filesystem::path parent = file.parent_path();
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(::opendir(parent.empty() ? "." : parent.c_str()),
                                                   ::closedir);
  std::vector<std::string> names;
  if (folder == nullptr) return names;
  while (const dirent* entry = ::readdir(folder.get())) names.emplace_back(entry->d_name);
  return names;
}

}  // namespace palpate
