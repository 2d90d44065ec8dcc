// SPDX-License-Identifier: BSD-3-Clause
#include "base/printable.h"

#include <cstdio>

namespace palpate {
namespace {

/// A character of UTF-8; `bytes` is 0 where the text has no valid one.
struct Character {
  char32_t code = 0;
  std::size_t bytes = 0;
};

Character first_of(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >> 5 == 0x6 ? 2 : lead >> 4 == 0xe ? 3 : lead >> 3 == 0x1e ? 4 : 0;
  if (bytes == 0 || bytes > text.size()) return {};
  char32_t code = lead & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if (byte(i) >> 6 != 0x2) return {};
    code = code << 6 | (byte(i) & 0x3fU);
  }
  constexpr char32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
  if (code < kLeast[bytes] || code > 0x10ffff || is_surrogate) return {};
  return {code, bytes};
}

/// Whether the character is not printed but has an effect: C0, C1, line and paragraph separators,
/// directions.
bool is_control(char32_t c) {
  return c < 0x20 || (c >= 0x7f && c <= 0x9f) || c == 0x061c || c == 0x200e || c == 0x200f ||
         (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069) || c == 0xfeff;
}

/// The place at which to cut UTF-8 text without cutting a character: `at`, or up to three bytes
/// before.
std::size_t cut_before(std::string_view text, std::size_t at) {
  for (std::size_t i = at; i > 0 && at - i < 4; --i) {
    if ((static_cast<unsigned char>(text[i]) >> 6) != 0x2) return i;
  }
  return at;
}

void append(std::string_view text, std::string& to) {
  while (!text.empty()) {
    const Character c = first_of(text);
    const std::size_t bytes = c.bytes == 0 ? 1 : c.bytes;
    for (std::size_t i = 0; i < bytes; ++i) {
      if (c.bytes > 0 && !is_control(c.code)) {
        to += text[i];
        continue;
      }
      char escaped[5];
      std::snprintf(escaped, sizeof escaped, "\\x%02x", static_cast<unsigned char>(text[i]));
      to += escaped;
    }
    text.remove_prefix(bytes);
  }
}

}  // namespace

std::string printable(std::string_view text, std::size_t most) {
  std::string shown;
  if (text.size() <= most) {
    append(text, shown);
    return shown;
  }
  append(text.substr(0, cut_before(text, most / 2)), shown);
  shown += "[… of " + std::to_string(text.size()) + " bytes …]";
  append(text.substr(cut_before(text, text.size() - most / 2)), shown);
  return shown;
}

std::string printable_message(std::string_view message) {
  std::string shown;
  for (std::size_t end = 0; end != message.npos;) {
    end = message.find('\n');
    shown += printable(message.substr(0, end), kLongestMessage) + (end == message.npos ? "" : "\n");
    message.remove_prefix(end == message.npos ? 0 : end + 1);
  }
  return shown;
}

std::string quoted(const std::filesystem::path& path) {
  const std::string& text = path.native();
  return '\'' + printable(text, text.size()) + '\'';
}

}  // namespace palpate
