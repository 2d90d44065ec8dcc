// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_disk.h"

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>

namespace palpate::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSector = 512;
constexpr int kTheFolder = -2;

Recording* recording = nullptr;

/// A file of which a part is on the disk.
struct File {
  std::string on_disk;
  /// Places in the list of operations.
  std::vector<std::size_t> pending;
};

}  // namespace

Folder read_folder(const fs::path& path) {
  Folder files;
  for (const auto& entry : fs::directory_iterator(path)) {
    std::ifstream in(entry.path(), std::ios::binary);
    files[entry.path().filename().string()] = {std::istreambuf_iterator<char>(in), {}};
  }
  return files;
}

void write_folder(const fs::path& path, const Folder& files) {
  fs::remove_all(path);
  fs::create_directory(path);
  for (const auto& [name, bytes] : files) {
    std::ofstream(path / name, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
}

Recording::Recording(fs::path folder)
    : folder_(fs::canonical(folder)), before_(read_folder(folder_)) {
  for (const auto& [name, bytes] : before_) file_of_name_[name] = num_files_++;
  recording = this;
}

Recording::~Recording() { stop(); }

void Recording::stop() { recording = nullptr; }

bool Recording::is_inside(const std::string& path) const {
  return fs::absolute(path).parent_path() == folder_;
}

void Recording::opened(const std::string& path, int descriptor, bool is_new) {
  if (fs::absolute(path) == folder_) {
    file_of_descriptor_[descriptor] = kTheFolder;
    return;
  }
  if (!is_inside(path)) return;
  const std::string name = fs::path(path).filename();
  if (is_new) {
    file_of_name_[name] = num_files_++;
    operations_.push_back({Kind::make, file_of_name_[name], name, {}, 0, {}});
  }
  file_of_descriptor_[descriptor] = file_of_name_.at(name);
}

void Recording::closed(int descriptor) { file_of_descriptor_.erase(descriptor); }

void Recording::written(int descriptor, std::size_t offset, const void* data, std::size_t bytes) {
  const auto file = file_of_descriptor_.find(descriptor);
  if (file == file_of_descriptor_.end()) return;
  operations_.push_back({Kind::write,
                         file->second,
                         {},
                         {},
                         offset,
                         std::string(static_cast<const char*>(data), bytes)});
}

void Recording::resized(int descriptor, std::size_t bytes) {
  const auto file = file_of_descriptor_.find(descriptor);
  if (file == file_of_descriptor_.end()) return;
  operations_.push_back({Kind::resize, file->second, {}, {}, bytes, {}});
}

void Recording::synced(int descriptor) {
  const auto file = file_of_descriptor_.find(descriptor);
  if (file == file_of_descriptor_.end()) return;
  const Kind kind = file->second == kTheFolder ? Kind::sync_folder : Kind::sync;
  operations_.push_back({kind, file->second, {}, {}, 0, {}});
}

void Recording::removed(const std::string& path) {
  if (!is_inside(path)) return;
  const std::string name = fs::path(path).filename();
  file_of_name_.erase(name);
  operations_.push_back({Kind::remove, -1, name, {}, 0, {}});
}

void Recording::renamed(const std::string& from, const std::string& to) {
  if (!is_inside(from)) return;
  const std::string name = fs::path(from).filename();
  const std::string new_name = fs::path(to).filename();
  file_of_name_[new_name] = file_of_name_.at(name);
  file_of_name_.erase(name);
  operations_.push_back({Kind::rename, -1, name, new_name, 0, {}});
}

void Recording::linked(const std::string& from, const std::string& to) {
  if (!is_inside(from)) return;
  const std::string name = fs::path(from).filename();
  const std::string new_name = fs::path(to).filename();
  file_of_name_[new_name] = file_of_name_.at(name);
  operations_.push_back({Kind::link, -1, name, new_name, 0, {}});
}

Folder Recording::after_power_loss(std::size_t num_operations, std::mt19937& random) const {
  // All of what was not synced, nothing of it, or some.
  const double share = std::array<double, 5>{0, 0.2, 0.5, 0.8, 1}[random() % 5];
  std::bernoulli_distribution reaches_disk(share);

  std::map<std::string, int> names;
  std::vector<File> files(static_cast<std::size_t>(num_files_));
  for (const auto& [name, bytes] : before_) {
    names[name] = static_cast<int>(names.size());
    files[static_cast<std::size_t>(names[name])].on_disk = bytes;
  }
  std::vector<std::size_t> pending_names;

  const auto apply_name = [&](const Operation& operation) {
    if (operation.kind == Kind::make) {
      names[operation.name] = operation.file;
    } else if (const auto old = names.find(operation.name); old != names.end()) {
      if (operation.kind != Kind::remove) names[operation.new_name] = old->second;
      if (operation.kind != Kind::link) names.erase(operation.name);
    }
  };
  /// @param reaches Of the sector with a number: whether this write of it does.
  const auto apply_data = [](const Operation& operation, std::string& bytes, const auto& reaches) {
    if (operation.kind == Kind::resize) {
      if (reaches(operation.offset / kSector)) bytes.resize(operation.offset);
      return;
    }
    const std::size_t end = operation.offset + operation.data.size();
    for (std::size_t at = operation.offset; at < end;) {
      const std::size_t next = std::min(end, (at / kSector + 1) * kSector);
      if (reaches(at / kSector)) {
        if (bytes.size() < next) bytes.resize(next);
        bytes.replace(at, next - at, operation.data, at - operation.offset, next - at);
      }
      at = next;
    }
  };
  const auto sync = [&](File& file) {
    for (const std::size_t o : file.pending) {
      apply_data(operations_[o], file.on_disk, [](std::size_t) { return true; });
    }
    file.pending.clear();
  };

  for (std::size_t o = 0; o < num_operations; ++o) {
    const Operation& operation = operations_[o];
    switch (operation.kind) {
      case Kind::make:
      case Kind::remove:
      case Kind::link:
      case Kind::rename: pending_names.push_back(o); break;
      case Kind::write:
      case Kind::resize:
        files[static_cast<std::size_t>(operation.file)].pending.push_back(o);
        break;
      case Kind::sync: sync(files[static_cast<std::size_t>(operation.file)]); break;
      case Kind::sync_folder:
        for (const std::size_t n : pending_names) apply_name(operations_[n]);
        pending_names.clear();
        break;
    }
  }

  // Where one operation on a name or a sector is missing, so are those that follow on it.
  std::set<std::string> missing_names;
  for (const std::size_t o : pending_names) {
    const Operation& operation = operations_[o];
    if (missing_names.count(operation.name) + missing_names.count(operation.new_name) == 0 &&
        reaches_disk(random)) {
      apply_name(operation);
    } else {
      missing_names.insert(operation.name);
      if (!operation.new_name.empty()) missing_names.insert(operation.new_name);
    }
  }
  Folder folder;
  for (const auto& [name, number] : names) {
    const File& file = files[static_cast<std::size_t>(number)];
    std::string bytes = file.on_disk;
    std::set<std::size_t> missing_sectors;
    for (const std::size_t o : file.pending) {
      apply_data(operations_[o], bytes, [&](std::size_t sector) {
        const bool reaches = missing_sectors.count(sector) == 0 && reaches_disk(random);
        if (!reaches) missing_sectors.insert(sector);
        return reaches;
      });
    }
    folder[name] = std::move(bytes);
  }
  return folder;
}

}  // namespace palpate::test

// In place of those of the C library, for everything in this program.
extern "C" {

// NOLINTBEGIN(readability-identifier-naming)
static int opened(const char* path, int flags, mode_t mode) {
  const bool is_new = (flags & O_CREAT) != 0 && access(path, F_OK) != 0;
  const int descriptor = static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
  if (descriptor >= 0 && palpate::test::recording != nullptr) {
    palpate::test::recording->opened(path, descriptor, is_new);
  }
  return descriptor;
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return opened(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return opened(path, flags, mode);
}

int close(int descriptor) {
  if (palpate::test::recording != nullptr) palpate::test::recording->closed(descriptor);
  return static_cast<int>(syscall(SYS_close, descriptor));
}

ssize_t write(int descriptor, const void* data, size_t bytes) {
  const off_t offset = lseek(descriptor, 0, SEEK_CUR);
  const ssize_t written = syscall(SYS_write, descriptor, data, bytes);
  if (written > 0 && offset >= 0 && palpate::test::recording != nullptr) {
    palpate::test::recording->written(descriptor, static_cast<std::size_t>(offset), data,
                                      static_cast<std::size_t>(written));
  }
  return written;
}

ssize_t pwrite64(int descriptor, const void* data, size_t bytes, off64_t offset) {
  const ssize_t written = syscall(SYS_pwrite64, descriptor, data, bytes, offset);
  if (written > 0 && palpate::test::recording != nullptr) {
    palpate::test::recording->written(descriptor, static_cast<std::size_t>(offset), data,
                                      static_cast<std::size_t>(written));
  }
  return written;
}

ssize_t pwrite(int descriptor, const void* data, size_t bytes, off_t offset) {
  return pwrite64(descriptor, data, bytes, offset);
}

int ftruncate64(int descriptor, off64_t bytes) {
  const auto status = static_cast<int>(syscall(SYS_ftruncate, descriptor, bytes));
  if (status == 0 && palpate::test::recording != nullptr) {
    palpate::test::recording->resized(descriptor, static_cast<std::size_t>(bytes));
  }
  return status;
}

int ftruncate(int descriptor, off_t bytes) { return ftruncate64(descriptor, bytes); }

// The disk itself is not waited for.
int fsync(int descriptor) {
  if (palpate::test::recording != nullptr) palpate::test::recording->synced(descriptor);
  return 0;
}

int fdatasync(int descriptor) { return fsync(descriptor); }

int unlink(const char* path) {
  const auto status = static_cast<int>(syscall(SYS_unlinkat, AT_FDCWD, path, 0));
  if (status == 0 && palpate::test::recording != nullptr) palpate::test::recording->removed(path);
  return status;
}

int remove(const char* path) {
  const int status = unlink(path);
  return status == 0 || errno != EISDIR ? status : rmdir(path);
}

int link(const char* from, const char* to) {
  const auto status = static_cast<int>(syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0));
  if (status == 0 && palpate::test::recording != nullptr) {
    palpate::test::recording->linked(from, to);
  }
  return status;
}

int rename(const char* from, const char* to) {
  const auto status = static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
  if (status == 0 && palpate::test::recording != nullptr) {
    palpate::test::recording->renamed(from, to);
  }
  return status;
}
// NOLINTEND(readability-identifier-naming)
}
