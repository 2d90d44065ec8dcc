// SPDX-License-Identifier: BSD-3-Clause
// What a loss of power leaves of a folder. The program that links this has its own open(), write(),
// fsync(), rename() and so on, which SQLite and the C++ library call too: they do what they are
// asked and note it. From the notes the folder is made as a disk may hold it that loses power at
// some instant: what was synced is there, of all else any part.
//
//   data      Each sector of a file holds what was written to it last before the sync, or after any
//   of
//             the writes since; so does the length of the file.
//   names     Making, renaming and removing a file reaches the disk with the sync of its folder.
//             Before that any of them may be missing, but of one name only the last ones.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace palpate::test {

/// The bytes of the files of a folder, by name.
using Folder = std::map<std::string, std::string>;

[[nodiscard]] Folder read_folder(const std::filesystem::path& path);
/// In place of what is there.
void write_folder(const std::filesystem::path& path, const Folder& files);

class Recording {
 public:
  /// Notes from now on what this program does to the files that lie in a folder. One at a time.
  explicit Recording(std::filesystem::path folder);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// Notes nothing any more.
  static void stop();

  /// How many operations were noted so far.
  [[nodiscard]] std::size_t size() const { return operations_.size(); }
  /// The folder as it may be after a loss of power at the instant after so many operations.
  [[nodiscard]] Folder after_power_loss(std::size_t num_operations, std::mt19937& random) const;

  // What the functions of the C library tell.
  void opened(const std::string& path, int descriptor, bool is_new);
  void closed(int descriptor);
  void written(int descriptor, std::size_t offset, const void* data, std::size_t bytes);
  void resized(int descriptor, std::size_t bytes);
  void synced(int descriptor);
  void removed(const std::string& path);
  void renamed(const std::string& from, const std::string& to);
  void linked(const std::string& from, const std::string& to);

 private:
  enum class Kind { make, remove, rename, link, write, resize, sync, sync_folder };
  struct Operation {
    Kind kind;
    int file = -1;
    std::string name;
    std::string new_name;
    std::size_t offset = 0;
    std::string data;
  };
  [[nodiscard]] bool is_inside(const std::string& path) const;

  std::filesystem::path folder_;
  Folder before_;
  /// Files are numbered; a name is that of one file after the other.
  std::map<std::string, int> file_of_name_;
  std::map<int, int> file_of_descriptor_;
  int num_files_ = 0;
  std::vector<Operation> operations_;
};

}  // namespace palpate::test
