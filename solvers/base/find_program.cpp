// SPDX-License-Identifier: BSD-3-Clause
#include "base/find_program.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

#include "base/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

bool runs(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

/// The folders of the library that this is linked into, and of the running program.
std::vector<fs::path> own_folders() {
  std::vector<fs::path> folders;
  const auto add = [&](const fs::path& file) {
    std::error_code error;
    const fs::path whole = fs::canonical(file, error);
    if (!error) folders.push_back(whole.parent_path());
  };
  Dl_info info;
  // For a program dladdr() gives the name it was called by, which need not be a path.
  const bool known = ::dladdr(reinterpret_cast<void*>(&find_program), &info) != 0;
  if (known && info.dli_fname != nullptr) add(info.dli_fname);
  add("/proc/self/exe");
  return folders;
}

}  // namespace

std::string find_program(const std::string& name, const std::string& variable,
                         const std::string& how) {
  if (const char* given = std::getenv(variable.c_str()); given != nullptr && *given != '\0') {
    if (runs(given)) return given;
    throw BackendError("The environment variable " + variable + " names no program: " + given +
                       ".");
  }
  const std::vector<fs::path> folders = own_folders();
  for (const fs::path& folder : folders) {
    if (runs(folder / name)) return folder / name;
    for (fs::path above = folder;; above = above.parent_path()) {
      if (runs(above / "bin" / name)) return above / "bin" / name;
      if (above == above.root_path()) break;
    }
  }
  throw BackendError("The program " + name + " is neither in " +
                     (folders.empty() ? std::string("any folder") : folders.front().string()) +
                     " nor in a folder `bin` above it. " + how +
                     ", or name it in the environment variable " + variable + ".");
}

}  // namespace palpate
