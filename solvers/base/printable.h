// SPDX-License-Identifier: BSD-3-Clause
// Text of others in a message: names of files, of arrays, of tables, and what a file holds. Who
// made it may have put in what a terminal or a log obeys, or a million characters.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// Of a name that is longer than this the middle is left out, bytes.
inline constexpr std::size_t kLongestName = 120;

/// The text with each control character, each that changes the direction of writing, and each byte
/// that is no UTF-8 as \xNN.
/// @param most The bytes of the text that are shown; of a longer one the middle is left out.
[[nodiscard]] std::string printable(std::string_view text, std::size_t most = kLongestName);

/// The bytes of a message: one that is longer repeats what a file has in place of a name.
inline constexpr std::size_t kLongestMessage = 10'000;

/// A message as it may be shown in a terminal, a log or a window: each of its lines so, and of
/// those that are too long the middle left out.
[[nodiscard]] std::string printable_message(std::string_view message);

/// The whole path so, between quotes.
[[nodiscard]] std::string quoted(const std::filesystem::path& path);

}  // namespace palpate
