// SPDX-License-Identifier: BSD-3-Clause
// What is used of hidapi: the rest of the transport goes by this, and tests put their own in its
// place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "haptic/guardian/guardian.h"
#include "haptic/profile/profile.h"

namespace palpate {

/// An open device; closed by the destructor. What fails gives −errno, as the system calls that
/// hidapi makes left it, and −ENODEV where the system says that the device is no more.
class HidDevice {
 public:
  virtual ~HidDevice() = default;
  /// @return Bytes; 0: none came in time, or an empty packet did.
  virtual int read(std::uint8_t* data, std::size_t size, int timeout_ms) noexcept = 0;
  /// @return Bytes.
  virtual int write(const std::uint8_t* data, std::size_t size) noexcept = 0;
  /// @param data Begins with the number of the report; is overwritten.
  /// @return Bytes.
  virtual int get_feature(std::uint8_t* data, std::size_t size) noexcept = 0;
};

class Hid {
 public:
  virtual ~Hid() = default;
  /// Without opening them: also those that there is no permission for.
  /// @note A device with several top-level collections is there several times.
  [[nodiscard]] virtual std::vector<DeviceInfo> list() = 0;
  /// @return nullptr: it cannot be opened, and error says why (an errno).
  [[nodiscard]] virtual std::shared_ptr<HidDevice> open(const std::string& path, int& error) = 0;
  /// Of an open device with motors; nullptr: it is none of the system's.
  /// @param zero Switches the motors off, whatever the device's state is.
  /// @throws BackendError it cannot be started.
  [[nodiscard]] virtual std::unique_ptr<Guardian> guard(const std::string& path,
                                                        const Report& zero) = 0;
};

/// hidapi over the kernel's hidraw.
[[nodiscard]] std::shared_ptr<Hid> hidapi();

}  // namespace palpate
