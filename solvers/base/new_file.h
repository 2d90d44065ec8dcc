// SPDX-License-Identifier: BSD-3-Clause
// A file that appears under its name complete, or not at all.
//
// It is written beside its place, under a temporary name that no other file has and no other
// program writes to, and is synced to the disk before it is renamed. If the place is a link, the
// link stays, and the file that it leads to is replaced.
#pragma once

#include <filesystem>

namespace palpate {

/// The path after following it if it is a link, and further links; the file itself need not exist.
/// @throws InputError the links form a circle.
[[nodiscard]] std::filesystem::path without_links(const std::filesystem::path& path);

/// The longest permitted file name, bytes. It leaves room for the longer names of the files that
/// SQLite writes beside a database.
inline constexpr std::size_t kLongestFileName = 247;

/// @throws InputError the file's name is longer than kLongestFileName.
void require_short_name(const std::filesystem::path& path);

/// Removes unfinished new files beside `target`, which are left where a program or the computer
/// stopped while writing one. Call it only when no other process can be writing one.
void remove_unfinished(const std::filesystem::path& target);

class NewFile {
 public:
  /// Creates an empty temporary file beside the place of the new file.
  /// @param target The place of the new file, a path without links.
  /// @throws BackendError it cannot be created there.
  explicit NewFile(std::filesystem::path target);
  /// Removes the temporary file, unless it was renamed to its place.
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// The path of the temporary file, for writing to it.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Renames it to its place, and replaces a file that is there.
  /// @throws BackendError the disk failed, or it cannot be renamed.
  void replace();
  /// Renames it to its place if no file is there.
  /// @returns False if a file is there by now; that file does not change.
  /// @throws BackendError as replace().
  [[nodiscard]] bool put_where_none_is();

 private:
  void sync() const;
  [[noreturn]] void fail(const char* what, int error) const;

  std::filesystem::path target_;
  std::filesystem::path path_;
  int descriptor_ = -1;
  bool is_there_ = true;
};

}  // namespace palpate
