// SPDX-License-Identifier: BSD-3-Clause
// Reads and writes integers in a report byte by byte, the lowest first, on any machine.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "haptic/profile/report.h"

namespace palpate {

/// @note Realtime-safe.
template <class T>
void put(Report& report, std::size_t at, T value) noexcept {
  const auto bits = static_cast<std::make_unsigned_t<T>>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    report.data[at + i] = static_cast<std::uint8_t>(bits >> (8 * i));
  }
}

/// @note Realtime-safe.
template <class T>
[[nodiscard]] T get(const Report& report, std::size_t at) noexcept {
  std::make_unsigned_t<T> bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bits = static_cast<std::make_unsigned_t<T>>(
        bits | static_cast<std::make_unsigned_t<T>>(report.data[at + i]) << (8 * i));
  }
  return static_cast<T>(bits);
}

/// A number of units as an integer. It is rounded toward zero, so that it is never more than was
/// asked for; a number beyond 16 bits becomes the largest integer.
/// @note Realtime-safe.
[[nodiscard]] inline std::int16_t toward_zero(double units) noexcept {
  constexpr double kLargest = std::numeric_limits<std::int16_t>::max();
  return static_cast<std::int16_t>(std::trunc(std::fmin(std::fmax(units, -kLargest), kLargest)));
}

}  // namespace palpate
