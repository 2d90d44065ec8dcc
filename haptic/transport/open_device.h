// SPDX-License-Identifier: BSD-3-Clause
// From what is plugged in to a device that the loop can use.
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
  /// That the profile was made from; empty: it needs none.
  Report feature;
};

/// @param which Its path (/dev/hidraw3), or vendor and product in hexadecimal digits (1234:0006);
///   empty: the first that can be opened.
/// @throws InputError there is no such device, or none of ours; the message says what there is.
/// @throws BackendError none of those can be opened; the message says for each why.
[[nodiscard]] OpenedDevice open_device(const std::string& which = {},
                                       const std::shared_ptr<Hid>& hid = hidapi(),
                                       Duration deadline = kAnswerTime);

/// What is plugged in, as a person chooses from it.
struct ListedDevice {
  DeviceInfo info;
  /// Whether it is a haptic device that is known; the rest is of these alone.
  bool known = false;
  /// Where it can be opened.
  std::optional<Specification> specification;
  /// Why it cannot be opened; empty: it can.
  std::string fault;
};

/// All HID devices, each once, whatever the number of its collections. Those that are known are
/// opened and closed: call this while no loop uses one of them.
/// @throws BackendError the system cannot say what is plugged in.
[[nodiscard]] std::vector<ListedDevice> list_devices(const std::shared_ptr<Hid>& hid = hidapi(),
                                                     Duration deadline = kAnswerTime);

/// One line: path, vendor and product, name.
[[nodiscard]] std::string to_string(const DeviceInfo& device);

}  // namespace palpate
