// SPDX-License-Identifier: BSD-3-Clause
// A HID device that is not there: the kernel has it from this program by way of /dev/uhid, and
// gives it to others as one that is plugged in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

struct uhid_event;

namespace palpate::test {

class Uhid {
 public:
  Uhid();
  /// Unplugs.
  ~Uhid();
  Uhid(const Uhid&) = delete;
  Uhid& operator=(const Uhid&) = delete;

  void plug(const std::string& name, std::uint16_t vendor, std::uint16_t product,
            const std::uint8_t* descriptor, std::size_t size);
  void unplug();
  /// An input report.
  void send(const void* report, std::size_t size);
  /// The answer to a question for a feature report.
  void answer(std::uint32_t question, const void* report, std::size_t size);

  /// For poll(): readable when the kernel has something for the device.
  [[nodiscard]] int file() const { return file_; }
  [[nodiscard]] uhid_event next();

 private:
  void write(const uhid_event& event);

  int file_ = -1;
};

}  // namespace palpate::test
