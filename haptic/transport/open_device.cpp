// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/transport/open_device.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "base/error.h"

namespace palpate {
namespace {

std::string vendor_and_product(const DeviceInfo& device) {
  char text[10];
  std::snprintf(text, sizeof text, "%04x:%04x", device.vendor_id, device.product_id);
  return text;
}

bool is_meant(const DeviceInfo& device, std::string which) {
  if (which.empty() || which == device.path) return true;
  std::transform(which.begin(), which.end(), which.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return which == vendor_and_product(device);
}

OpenedDevice open(const DeviceInfo& info, ProfileKind kind, const std::shared_ptr<Hid>& hid,
                  Duration deadline) {
  const auto device = open_hid_device(hid, info.path, deadline);
  OpenedDevice opened;
  opened.kind = kind;
  if (const auto number = feature_report(kind)) {
    opened.feature = get_feature_report(device, *number, deadline);
  }
  opened.profile = make_profile(kind, opened.feature);
  std::unique_ptr<Guardian> guardian;
  std::string why_unguarded;
  if (opened.profile->specification().max_linear_force > 0) {
    try {
      // This zero report is made without a state of the device, and only switches the motors off.
      guardian = hid->guard(info.path, opened.profile->zero_force({}));
    } catch (const BackendError& error) {
      why_unguarded = error.what();
    }
  }
  opened.transport = std::make_unique<HidTransport>(device, std::move(guardian), why_unguarded);
  opened.info = info;
  return opened;
}

}  // namespace

std::vector<ListedDevice> list_devices(const std::shared_ptr<Hid>& hid, Duration deadline) {
  std::vector<ListedDevice> listed;
  for (const DeviceInfo& info : hid->list()) {
    const auto kind = match(info);
    const auto same = std::find_if(listed.begin(), listed.end(), [&](const ListedDevice& other) {
      return other.info.path == info.path;
    });
    // A device is known by one of its collections.
    if (same != listed.end() && (same->known || !kind)) continue;
    ListedDevice& device = same != listed.end() ? *same : listed.emplace_back();
    device.info = info;
    device.known = kind.has_value();
    if (!kind) continue;
    try {
      device.specification = open(info, *kind, hid, deadline).profile->specification();
    } catch (const std::runtime_error& error) {
      device.fault = error.what();
    }
  }
  return listed;
}

std::string to_string(const DeviceInfo& device) {
  std::string text = device.path + ' ' + vendor_and_product(device);
  if (!device.manufacturer.empty()) text += ' ' + device.manufacturer;
  if (!device.product.empty()) text += ' ' + device.product;
  return text;
}

OpenedDevice open_device(const std::string& which, const std::shared_ptr<Hid>& hid,
                         Duration deadline) {
  std::vector<std::string> others;
  std::string failures;
  for (const DeviceInfo& info : hid->list()) {
    const std::string line = "\n  " + to_string(info);
    const auto kind = match(info);
    if (!kind || !is_meant(info, which)) {
      // A device is listed once, whatever the number of its collections.
      if (std::find(others.begin(), others.end(), line) == others.end()) others.push_back(line);
      continue;
    }
    try {
      return open(info, *kind, hid, deadline);
    } catch (const std::runtime_error& error) {
      failures += line + ": " + error.what();
    }
  }
  if (!failures.empty()) throw BackendError("No haptic device could be opened:" + failures);
  std::string what = "There is no haptic device";
  if (!which.empty()) what += " " + which;
  what += " (haptic/README.md says which can be used). ";
  what += others.empty() ? "No HID device is plugged in at all." : "What is plugged in:";
  for (const std::string& line : others) what += line;
  throw InputError(what);
}

}  // namespace palpate
