// SPDX-License-Identifier: BSD-3-Clause
// Two haptic devices that are not there, in place of hidapi's: a library for LD_PRELOAD. Each is a
// file of the folder PALPATE_FAKE_HID, that the guardian writes its zeros to:
//
//   buttons      it has two of them; plain: it has none
//   NAME.hand    where its handle is [3], m from the centre of its workspace, and what is pressed:
//                four doubles, written by a test
//   NAME.sent    every report that the program sends it
//
// It measures each millisecond. Both have motors.
#include <fcntl.h>
#include <hidapi/hidapi.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <string>

#include "haptic/profile/palpate_report.h"

using namespace palpate;

struct hid_device_ {
  std::string path;
  palpate_report::Feature feature;
  int hand = -1;
  int sent = -1;
  std::uint16_t counter = 0;
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
};

namespace {

constexpr std::array kNames = {"buttons", "plain"};

std::string path_of(const char* name) {
  const char* const folder = std::getenv("PALPATE_FAKE_HID");
  return std::string(folder != nullptr ? folder : ".") + '/' + name;
}

palpate_report::Feature feature_of(const std::string& path) {
  palpate_report::Feature feature;
  const bool has_buttons = path == path_of("buttons");
  feature.num_buttons = has_buttons ? 2 : 0;
  feature.model = has_buttons ? "Buttons" : "Plain";
  return feature;
}

int copy(const Report& report, unsigned char* data, std::size_t size) {
  std::copy_n(report.data.begin(), std::min(size, report.size), data);
  return static_cast<int>(report.size);
}

palpate_report::Input measure(hid_device& device) {
  std::array<double, 4> hand{};
  (void)!::pread(device.hand, hand.data(), sizeof hand, 0);
  palpate_report::Input input;
  input.counter = device.counter;
  input.time_us = 1000U * device.counter;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    input.position[axis] =
        static_cast<std::int32_t>(std::lround(1e9 * hand[axis] / device.feature.position_unit_nm));
  }
  input.buttons = static_cast<std::uint8_t>(hand[3]);
  return input;
}

}  // namespace

extern "C" {

hid_device_info* hid_enumerate(unsigned short, unsigned short) {
  hid_device_info* first = nullptr;
  for (auto name = kNames.rbegin(); name != kNames.rend(); ++name) {
    auto* const info = static_cast<hid_device_info*>(std::calloc(1, sizeof(hid_device_info)));
    info->path = ::strdup(path_of(*name).c_str());
    info->usage_page = palpate_report::kUsagePage;
    info->usage = palpate_report::kUsage;
    info->next = first;
    first = info;
  }
  return first;
}

void hid_free_enumeration(hid_device_info* first) {
  while (first != nullptr) {
    hid_device_info* const next = first->next;
    std::free(first->path);
    std::free(first);
    first = next;
  }
}

hid_device* hid_open_path(const char* path) {
  auto* const device = new hid_device_();
  device->path = path;
  device->feature = feature_of(path);
  device->hand = ::open((device->path + ".hand").c_str(), O_RDONLY | O_CLOEXEC);
  device->sent =
      ::open((device->path + ".sent").c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  return device;
}

void hid_close(hid_device* device) {
  ::close(device->hand);
  ::close(device->sent);
  delete device;
}

int hid_read_timeout(hid_device* device, unsigned char* data, std::size_t size, int) {
  const auto since = std::chrono::steady_clock::now() - device->begin;
  const auto due = std::chrono::duration_cast<std::chrono::milliseconds>(since).count();
  // After a pause one report is there, not all that were missed.
  if (static_cast<std::uint16_t>(due) == device->counter) return 0;
  device->counter = static_cast<std::uint16_t>(due);
  return copy(palpate_report::encode_input(measure(*device)), data, size);
}

int hid_write(hid_device* device, const unsigned char* data, std::size_t size) {
  return static_cast<int>(::write(device->sent, data, size));
}

int hid_get_feature_report(hid_device* device, unsigned char* data, std::size_t size) {
  return copy(palpate_report::encode_feature(device->feature), data, size);
}

/// The one question that hidraw alone can answer.
int ioctl(int file, unsigned long request, ...) noexcept {
  constexpr unsigned long kDescriptorSize = _IOR('H', 0x01, int);
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  struct stat status {};
  if (request == kDescriptorSize && ::fstat(file, &status) == 0 && S_ISREG(status.st_mode)) {
    *static_cast<int*>(argument) = 1;
    return 0;
  }
  return static_cast<int>(::syscall(SYS_ioctl, file, request, argument));
}
}
