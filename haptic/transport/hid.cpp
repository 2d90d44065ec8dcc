// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/transport/hid.h"

#include <fcntl.h>
#include <hidapi/hidapi.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>

namespace palpate {
namespace {

/// This is HIDIOCGRDESCSIZE of linux/hidraw.h; files of other kinds refuse it (ENOTTY).
constexpr unsigned long kDescriptorSize = _IOR('H', 0x01, int);

/// Guards the calls that are not about an open device: hidapi keeps one error text for all of them,
/// so that no two may run at once.
std::mutex& global_calls() {
  static std::mutex mutex;
  return mutex;
}

std::string utf8(const wchar_t* text) {
  std::string result;
  for (; text != nullptr && *text != 0; ++text) {
    const auto c = static_cast<std::uint32_t>(*text);
    const auto add = [&](std::uint32_t byte) { result += static_cast<char>(byte); };
    const auto tail = [&](int shift) { add(0x80U | (c >> shift & 0x3FU)); };
    if (c < 0x80) {
      add(c);
    } else if (c < 0x800) {
      add(0xC0U | c >> 6);
      tail(0);
    } else if (c < 0x10000) {
      add(0xE0U | c >> 12);
      tail(6);
      tail(0);
    } else {
      add(0xF0U | c >> 18);
      tail(12);
      tail(6);
      tail(0);
    }
  }
  return result;
}

class HidapiDevice final : public HidDevice {
 public:
  explicit HidapiDevice(hid_device* device) : device_(device) {}
  ~HidapiDevice() override {
    const std::lock_guard lock(global_calls());
    hid_close(device_);
  }

  int read(std::uint8_t* data, std::size_t size, int timeout_ms) noexcept override {
    // When poll() says that the device hung up, hidapi fails without an errno.
    errno = 0;
    return result(hid_read_timeout(device_, data, size, timeout_ms));
  }
  int write(const std::uint8_t* data, std::size_t size) noexcept override {
    errno = 0;
    return result(hid_write(device_, data, size));
  }
  int get_feature(std::uint8_t* data, std::size_t size) noexcept override {
    errno = 0;
    return result(hid_get_feature_report(device_, data, size));
  }

 private:
  [[nodiscard]] static int result(int bytes) noexcept {
    if (bytes >= 0) return bytes;
    return errno != 0 ? -errno : -ENODEV;
  }

  hid_device* device_;
};

class Hidapi final : public Hid {
 public:
  std::vector<DeviceInfo> list() override {
    const std::lock_guard lock(global_calls());
    hid_device_info* const first = hid_enumerate(0, 0);
    std::vector<DeviceInfo> devices;
    for (const hid_device_info* d = first; d != nullptr; d = d->next) {
      DeviceInfo device;
      device.path = d->path != nullptr ? d->path : "";
      device.vendor_id = d->vendor_id;
      device.product_id = d->product_id;
      device.usage_page = d->usage_page;
      device.usage = d->usage;
      device.interface_number = d->interface_number;
      device.manufacturer = utf8(d->manufacturer_string);
      device.product = utf8(d->product_string);
      device.serial_number = utf8(d->serial_number);
      devices.push_back(std::move(device));
    }
    hid_free_enumeration(first);
    return devices;
  }

  std::shared_ptr<HidDevice> open(const std::string& path, int& error) override {
    // This first open wakes the device, which can take long, and says by errno why it fails.
    // hidapi's own open comes after it and is quick, so that the lock is not held for long. The
    // size of the descriptor is asked for here as well, because hidapi (0.13.1) crashes where it
    // does not get it.
    const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
    int size = 0;
    if (file < 0 || ::ioctl(file, kDescriptorSize, &size) < 0) {
      error = errno;
      if (file >= 0) ::close(file);
      return nullptr;
    }
    hid_device* device = nullptr;
    {
      const std::lock_guard lock(global_calls());
      device = hid_open_path(path.c_str());
    }
    ::close(file);
    if (device == nullptr) {
      error = ENODEV;  // it could be opened just before
      return nullptr;
    }
    return std::make_shared<HidapiDevice>(device);
  }

  std::unique_ptr<Guardian> guard(const std::string& path, const Report& zero) override {
    return std::make_unique<Guardian>(path, zero);
  }
};

}  // namespace

std::shared_ptr<Hid> hidapi() { return std::make_shared<Hidapi>(); }

}  // namespace palpate
