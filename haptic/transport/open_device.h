// SPDX-License-Identifier: BSD-3-Clause
// Lists the devices that are plugged in, and opens one that the loop can use.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptic/profile/profile.h"
#include "haptic/transport/hid_transport.h"

namespace palpate {

struct OpenedDevice {
  std::unique_ptr<Transport> transport;
  std::shared_ptr<const Profile> profile;
  DeviceInfo info;
  ProfileKind kind{};
  /// The feature report that the profile was made from; empty: it needs none.
  Report feature;
};

/// Opens a device.
/// @param which The path of the device (/dev/hidraw3), or its vendor and product in hexadecimal
///   digits (1234:0006); empty: the first device that can be opened.
/// @throws InputError there is no such device, or none that is known; the message lists the devices
///   that there are.
/// @throws BackendError no such device can be opened; the message says why for each.
[[nodiscard]] OpenedDevice open_device(const std::string& which = {},
                                       const std::shared_ptr<Hid>& hid = hidapi(),
                                       Duration deadline = kAnswerTime);

/// A device that is plugged in, for a person who chooses one.
struct ListedDevice {
  DeviceInfo info;
  /// Whether it is a haptic device that is known. Only such a device has the fields below.
  bool known = false;
  /// What the device can do; empty: it cannot be opened.
  std::optional<Specification> specification;
  /// Why the device cannot be opened; empty: it can.
  std::string fault;
};

/// All HID devices, each once, whatever the number of its collections. Those that are known are
/// opened and closed: call this while no loop uses one of them.
/// @throws BackendError the system cannot say what is plugged in.
[[nodiscard]] std::vector<ListedDevice> list_devices(const std::shared_ptr<Hid>& hid = hidapi(),
                                                     Duration deadline = kAnswerTime);

/// A line with path, vendor and product, and name.
[[nodiscard]] std::string to_string(const DeviceInfo& device);

}  // namespace palpate
