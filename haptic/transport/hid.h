// SPDX-License-Identifier: BSD-3-Clause
// The part of hidapi that is used. The rest of the transport goes through this interface, and tests
// put their own in its place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "haptic/guardian/guardian.h"
#include "haptic/profile/profile.h"

namespace palpate {

/// An open device, which the destructor closes. A call that fails gives −errno, as the system calls
/// of hidapi have left it, and −ENODEV where the system says that the device is gone.
class HidDevice {
 public:
  virtual ~HidDevice() = default;
  /// @return The number of bytes; 0: no report came in time, or an empty packet came.
  virtual int read(std::uint8_t* data, std::size_t size, int timeout_ms) noexcept = 0;
  /// @return The number of bytes.
  virtual int write(const std::uint8_t* data, std::size_t size) noexcept = 0;
  /// @param data The number of the report in the first byte; the answer overwrites all.
  /// @return The number of bytes.
  virtual int get_feature(std::uint8_t* data, std::size_t size) noexcept = 0;
};

class Hid {
 public:
  virtual ~Hid() = default;
  /// Lists all devices without opening them, so that those without permission are listed too.
  /// @note A device with several top-level collections is listed several times.
  [[nodiscard]] virtual std::vector<DeviceInfo> list() = 0;
  /// @return The device; nullptr: it cannot be opened, and `error` says why (an errno).
  [[nodiscard]] virtual std::shared_ptr<HidDevice> open(const std::string& path, int& error) = 0;
  /// Starts the guardian of an open device with motors; nullptr: it is not a device of the system.
  /// @param zero The report that switches the motors off, whatever the device's state is.
  /// @throws BackendError it cannot be started.
  [[nodiscard]] virtual std::unique_ptr<Guardian> guard(const std::string& path,
                                                        const Report& zero) = 0;
};

/// hidapi over the kernel's hidraw.
[[nodiscard]] std::shared_ptr<Hid> hidapi();

}  // namespace palpate
