// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

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

}  // namespace palpate
