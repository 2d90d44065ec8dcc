// SPDX-License-Identifier: BSD-3-Clause
// A file that appears under its name when it is whole, or not at all.
//
// It is filled beside its place, under a name that no other file has and that no other program can
// be writing to, is on the disk before it gets its own name, and a link in its place stays: the
// file that the link leads to is the one that is written.
#pragma once

#include <filesystem>

namespace palpate {

/// Where a path leads if the file is a link, or a link to one; the file need not be there.
/// @throws InputError the links lead round in a circle.
[[nodiscard]] std::filesystem::path without_links(const std::filesystem::path& path);

/// The longest name of a file, bytes: what SQLite writes beside one has a longer name.
inline constexpr std::size_t kLongestFileName = 247;

/// @throws InputError the file has a longer name.
void require_short_name(const std::filesystem::path& path);

/// Removes what was left beside a file of new ones that did not become it, because the program or
/// the computer that made them came to an end. Call it when nobody can be making one any more.
void remove_unfinished(const std::filesystem::path& target);

class NewFile {
 public:
  /// Makes an empty file beside the place of the new one.
  /// @param target Without links.
  /// @throws BackendError it cannot be made there.
  explicit NewFile(std::filesystem::path target);
  /// Removes it, unless it was put in place.
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Where it is to be written.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Gives it its name, in place of a file that has it.
  /// @throws BackendError the disk failed, or it cannot be renamed.
  void replace();
  /// Gives it its name where no file has it.
  /// @returns False: there is one by now, and it stays as it is. @throws BackendError as replace().
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
