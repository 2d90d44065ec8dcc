// SPDX-License-Identifier: BSD-3-Clause
// Converts the values of a recording to text and back. A value that is read equals the one that was
// written, bit for bit.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>

#include "haptic/profile/profile.h"
#include "haptic/profile/report.h"
#include "haptic/realtime/clock.h"

namespace palpate::recording {

inline constexpr std::string_view kProfiles[] = {"palpate_report", "wooden_haptics", "space_mouse"};
inline constexpr std::uint64_t kNanosecondsInASecond = 1'000'000'000;

template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
void append(std::string& text, Number value) {
  if constexpr (std::is_same_v<Number, bool>) {
    text.push_back(value ? '1' : '0');
  } else {
    if constexpr (std::is_floating_point_v<Number>) {
      // The sign of a NaN means nothing, and ParaView takes "-nan" for a word.
      if (std::isnan(value)) {
        text.append("nan");
        return;
      }
    }
    char buffer[32];
    text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  }
}

template <class Enum, std::enable_if_t<std::is_enum_v<Enum>, int> = 0>
void append(std::string& text, Enum value) {
  append(text, static_cast<std::underlying_type_t<Enum>>(value));
}

inline void append(std::string& text, ProfileKind kind) {
  text.append(kProfiles[static_cast<int>(kind)]);
}

/// Appends a duration in s with nine decimals. It does not go through a double, which would not
/// hold each nanosecond.
inline void append(std::string& text, Duration duration) {
  if (duration.count() < 0) text.push_back('-');
  const auto count = static_cast<std::uint64_t>(std::abs(duration.count()));
  append(text, count / kNanosecondsInASecond);
  const std::string decimals = std::to_string(count % kNanosecondsInASecond);
  text.append(".").append(9 - decimals.size(), '0').append(decimals);
}

/// Appends a report as the letter x and hexadecimal digits. The x lets readers of tables take it
/// for a word even where all digits are decimal.
inline void append(std::string& text, const Report& report) {
  constexpr std::string_view digits = "0123456789abcdef";
  text.push_back('x');
  for (std::size_t i = 0; i < report.size; ++i) {
    text.push_back(digits[report.data[i] >> 4]);
    text.push_back(digits[report.data[i] & 15]);
  }
}

/// Appends words; characters that would end the value early become spaces.
inline void append(std::string& text, const std::string& words) {
  for (const char c : words) {
    const bool safe = static_cast<unsigned char>(c) >= ' ' && c != ';' && c != '"';
    text.push_back(safe ? c : ' ');
  }
}

/// Reads a value.
/// @return Whether the whole text is such a value.
template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
[[nodiscard]] bool parse(std::string_view text, Number& value) {
  if constexpr (std::is_same_v<Number, bool>) {
    value = text == "1";
    return value || text == "0";
  } else {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && stop == end && !text.empty();
  }
}

template <class Enum, std::enable_if_t<std::is_enum_v<Enum>, int> = 0>
[[nodiscard]] bool parse(std::string_view text, Enum& value) {
  std::underlying_type_t<Enum> number{};
  if (!parse(text, number)) return false;
  value = static_cast<Enum>(number);
  return true;
}

[[nodiscard]] inline bool parse(std::string_view text, ProfileKind& kind) {
  for (int i = 0; i < 3; ++i) {
    if (text != kProfiles[i]) continue;
    kind = static_cast<ProfileKind>(i);
    return true;
  }
  return false;
}

[[nodiscard]] inline bool parse(std::string_view text, Duration& duration) {
  const bool negative = !text.empty() && text.front() == '-';
  if (negative) text.remove_prefix(1);
  const std::size_t point = text.find('.');
  std::uint32_t decimals = 0;
  std::uint64_t whole = 0;
  if (point == text.npos || text.size() - point != 10 || !parse(text.substr(0, point), whole) ||
      !parse(text.substr(point + 1), decimals)) {
    return false;
  }
  constexpr std::uint64_t largest = std::numeric_limits<std::int64_t>::max();
  if (whole > largest / kNanosecondsInASecond) return false;
  const std::uint64_t count = kNanosecondsInASecond * whole + decimals;
  if (count > largest) return false;
  duration = Duration(static_cast<std::int64_t>(count));
  if (negative) duration = -duration;
  return true;
}

[[nodiscard]] inline bool parse(std::string_view text, Report& report) {
  if (text.empty() || text.front() != 'x' || text.size() % 2 == 0 ||
      text.size() > 1 + 2 * Report::kCapacity) {
    return false;
  }
  report = {};
  for (text.remove_prefix(1); !text.empty(); text.remove_prefix(2)) {
    const auto [stop, error] =
        std::from_chars(text.data(), text.data() + 2, report.data[report.size++], 16);
    if (error != std::errc() || stop != text.data() + 2) return false;
  }
  return true;
}

[[nodiscard]] inline bool parse(std::string_view text, std::string& words) {
  words = text;
  return true;
}

}  // namespace palpate::recording
