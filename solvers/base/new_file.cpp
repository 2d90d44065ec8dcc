// SPDX-License-Identifier: BSD-3-Clause
#include "base/new_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <random>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "base/folder.h"
#include "base/printable.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

/// Linux follows as many links.
constexpr int kMostLinks = 40;
constexpr int kMostTries = 100;
/// The temporary name begins with at most so many bytes of the file's name.
constexpr std::size_t kBytesOfName = 200;

constexpr std::size_t kDigits = 8;
constexpr char kEnding[] = ".part";

/// The common prefix of the names of all temporary files for this target.
std::string beginning(const fs::path& target) {
  return target.filename().native().substr(0, kBytesOfName) + '.';
}

/// A temporary name, another one at each call.
fs::path name_beside(const fs::path& target) {
  std::random_device random;
  char digits[kDigits + 1];
  std::snprintf(digits, sizeof digits, "%08x", static_cast<unsigned>(random()));
  return target.parent_path() / (beginning(target) + digits + kEnding);
}

/// Whether the error means that the file system cannot make the hard link.
bool has_no_links(int error) {
  return error == EPERM || error == ENOSYS || error == EOPNOTSUPP || error == ENOTSUP ||
         error == EMLINK || error == EACCES;
}

}  // namespace

fs::path without_links(const fs::path& path) {
  fs::path at = path;
  for (int links = 0; links < kMostLinks; ++links) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(at, error))) return at;
    const fs::path next = fs::read_symlink(at, error);
    if (error) return at;
    at = next.is_absolute() ? next : at.parent_path() / next;
  }
  throw InputError(quoted(path) + " is a link that leads to itself. Give another file name.");
}

void require_short_name(const fs::path& path) {
  const std::size_t bytes = path.filename().native().size();
  if (bytes <= kLongestFileName) return;
  throw InputError("The name of the file " + quoted(path) + " has " + std::to_string(bytes) +
                   " bytes, and may have " + std::to_string(kLongestFileName) +
                   ": more is needed for what is written beside it. Give a shorter file name.");
}

void remove_unfinished(const fs::path& target) {
  const std::string first = beginning(target);
  for (const std::string& name : names_beside(target)) {
    if (name.size() != first.size() + kDigits + sizeof kEnding - 1 ||
        name.compare(0, first.size(), first) != 0 ||
        name.compare(first.size() + kDigits, std::string::npos, kEnding) != 0 ||
        name.find_first_not_of("0123456789abcdef", first.size()) != first.size() + kDigits) {
      continue;
    }
    std::error_code error;
    fs::remove(target.parent_path() / name, error);
  }
}

NewFile::NewFile(fs::path target) : target_(std::move(target)) {
  for (int tries = 0; descriptor_ < 0; ++tries) {
    path_ = name_beside(target_);
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && (errno != EEXIST || tries == kMostTries)) fail("made", errno);
  }
}

NewFile::~NewFile() {
  ::close(descriptor_);
  if (is_there_) ::unlink(path_.c_str());
}

void NewFile::fail(const char* what, int error) const {
  throw BackendError("The file " + quoted(path_) + ", which is to become " + quoted(target_) +
                     ", cannot be " + what + ": " + std::strerror(error) +
                     ". Choose a folder that is there, may be written to and has room.");
}

void NewFile::sync() const {
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail("written", errno);
}

void NewFile::replace() {
  sync();
  if (::rename(path_.c_str(), target_.c_str()) != 0) fail("renamed", errno);
  is_there_ = false;
  sync_folder_of(target_);
}

bool NewFile::put_where_none_is() {
  sync();
  if (::link(path_.c_str(), target_.c_str()) == 0) {
    ::unlink(path_.c_str());
  } else {
    // The file that was there may have been removed since.
    const int reason = errno;
    if (reason == EEXIST || ::access(target_.c_str(), F_OK) == 0) return false;
    errno = reason;
    if (!has_no_links(errno)) fail("renamed", errno);
    // The process that creates the empty file owns the name.
    const int own = ::open(target_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (own < 0 && errno == EEXIST) return false;
    if (own < 0) fail("renamed", errno);
    ::close(own);
    if (::rename(path_.c_str(), target_.c_str()) != 0) fail("renamed", errno);
  }
  is_there_ = false;
  sync_folder_of(target_);
  return true;
}

}  // namespace palpate
