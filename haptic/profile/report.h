// SPDX-License-Identifier: BSD-3-Clause
// The bytes of one HID report, as hidapi takes and gives them. Where a device numbers its reports
// the first byte is the number. Where it does not, a report that is read begins with the data, and
// one that is written begins with a 0 that is not sent.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace palpate {

struct Report {
  /// The interrupt reports of a full-speed device have 64 bytes at most; one more is for the
  /// number.
  static constexpr std::size_t kCapacity = 65;

  std::array<std::uint8_t, kCapacity> data{};
  /// The number of bytes that are used; 0: there is no report.
  std::size_t size = 0;

  [[nodiscard]] friend bool operator==(const Report& a, const Report& b) {
    return a.size == b.size && std::memcmp(a.data.data(), b.data.data(), a.size) == 0;
  }
};

}  // namespace palpate
