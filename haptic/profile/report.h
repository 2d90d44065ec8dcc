// SPDX-License-Identifier: BSD-3-Clause
// The bytes of one HID report, as hidapi takes and gives them: where a device numbers its reports
// the first byte is the number; where it does not, what is read begins with the data, and what is
// written begins with a 0 that is not sent.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace palpate {

struct Report {
  /// A full-speed device's interrupt reports are 64 bytes at the most, and one for the number.
  static constexpr std::size_t kCapacity = 65;

  std::array<std::uint8_t, kCapacity> data{};
  /// Bytes that count; 0: there is no report.
  std::size_t size = 0;

  [[nodiscard]] friend bool operator==(const Report& a, const Report& b) {
    return a.size == b.size && std::memcmp(a.data.data(), b.data.data(), a.size) == 0;
  }
};

}  // namespace palpate
