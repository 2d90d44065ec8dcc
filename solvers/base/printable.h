// SPDX-License-Identifier: BSD-3-Clause
// Foreign text in a message: names of files, of arrays, of tables, and the content of a file. It
// may contain control sequences for a terminal or a log, or be a million characters long.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// A longer name is shortened in the middle to this many bytes.
inline constexpr std::size_t kLongestName = 120;

/// The text with every control character, every character that changes the direction of writing,
/// and every byte that is not UTF-8 written as \xNN.
/// @param most The bytes of the text that are shown; a longer text is shortened in the middle.
[[nodiscard]] std::string printable(std::string_view text, std::size_t most = kLongestName);

/// The bytes of a message. A longer message repeats the content of a file in place of a name.
inline constexpr std::size_t kLongestMessage = 10'000;

/// A message made safe for a terminal, a log or a window: every line is made printable(), and lines
/// that are too long are shortened in the middle.
[[nodiscard]] std::string printable_message(std::string_view message);

/// The whole path made printable(), between quotes.
[[nodiscard]] std::string quoted(const std::filesystem::path& path);

}  // namespace palpate
