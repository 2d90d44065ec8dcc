// SPDX-License-Identifier: BSD-3-Clause
// From what is plugged in to a device that the loop can use.
#pragma once

#include <memory>
#include <string>

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

/// One line: path, vendor and product, name.
[[nodiscard]] std::string to_string(const DeviceInfo& device);

}  // namespace palpate
