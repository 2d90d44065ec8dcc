// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/device/uhid.h"

#include <fcntl.h>
#include <linux/uhid.h>
#include <unistd.h>

#include <cstring>

#include "haptic/device/check.h"

namespace palpate::test {

Uhid::Uhid() : file_(open("/dev/uhid", O_RDWR | O_CLOEXEC)) { check(file_ >= 0, "/dev/uhid"); }

Uhid::~Uhid() { close(file_); }

void Uhid::plug(const std::string& name, std::uint16_t vendor, std::uint16_t product,
                const std::uint8_t* descriptor, std::size_t size) {
  uhid_event event{};
  event.type = UHID_CREATE2;
  uhid_create2_req& device = event.u.create2;
  name.copy(reinterpret_cast<char*>(device.name), sizeof device.name - 1);
  device.bus = BUS_USB;
  device.vendor = vendor;
  device.product = product;
  device.rd_size = static_cast<std::uint16_t>(size);
  std::memcpy(device.rd_data, descriptor, size);
  write(event);
}

void Uhid::unplug() {
  uhid_event event{};
  event.type = UHID_DESTROY;
  write(event);
}

void Uhid::send(const void* report, std::size_t size) {
  uhid_event event{};
  event.type = UHID_INPUT2;
  event.u.input2.size = static_cast<std::uint16_t>(size);
  std::memcpy(event.u.input2.data, report, size);
  write(event);
}

void Uhid::answer(std::uint32_t question, const void* report, std::size_t size) {
  uhid_event event{};
  event.type = UHID_GET_REPORT_REPLY;
  uhid_get_report_reply_req& reply = event.u.get_report_reply;
  reply.id = question;
  reply.size = static_cast<std::uint16_t>(size);
  std::memcpy(reply.data, report, size);
  write(event);
}

uhid_event Uhid::next() {
  uhid_event event{};
  check(read(file_, &event, sizeof event) > 0, "reading /dev/uhid");
  return event;
}

void Uhid::write(const uhid_event& event) {
  check(::write(file_, &event, sizeof event) == sizeof event, "writing /dev/uhid");
}

}  // namespace palpate::test
