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

/// The whole path so, between quotes.
[[nodiscard]] std::string quoted(const std::filesystem::path& path);

}  // namespace palpate
