// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/transport/hid_transport.h"

#include <algorithm>
#include <cerrno>
#include <future>
#include <system_error>
#include <thread>

#include "base/error.h"

namespace palpate {
namespace {

std::string message(int error) { return std::generic_category().message(error); }

std::string in_seconds(Duration duration) {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
  return std::to_string(ms / 1000) + "." + std::to_string(ms / 100 % 10) + " s";
}

/// Runs a task on a thread of its own, which is left to itself when it takes too long.
template <class Task>
auto within(Duration deadline, const std::string& what, Task task) {
  std::packaged_task<decltype(task())()> packaged(std::move(task));
  auto result = packaged.get_future();
  std::thread(std::move(packaged)).detach();
  if (result.wait_for(deadline) != std::future_status::ready) {
    throw BackendError(what + " took more than " + in_seconds(deadline) +
                       ": unplug the device, wait a few seconds, plug it in again. Where that does "
                       "not help its firmware does not answer.");
  }
  return result.get();
}

std::string why_not_opened(const std::string& path, int error) {
  if (error == EACCES || error == EPERM) {
    return "There is no permission to use " + path +
           ": a udev rule has to give it. Install Palpate's, haptic/transport/70-palpate.rules: "
           "sudo cp 70-palpate.rules /etc/udev/rules.d/ && sudo udevadm control --reload && "
           "sudo udevadm trigger; then plug the device in again. For a board with Palpate's report "
           "put its vendor and product into the last line of the rule first.";
  }
  if (error == ENOTTY) return path + " is not a hidraw device: give a path like /dev/hidraw0.";
  if (error == ENOENT || error == ENODEV || error == ENXIO) {
    return path + " is not there: is the device plugged in?";
  }
  return path + " cannot be opened: " + message(error) + ".";
}

template <class Call>
int uninterrupted(Call call) noexcept {
  int result = -EINTR;
  for (int i = 0; i < HidTransport::kTries && result == -EINTR; ++i) result = call();
  return result;
}

}  // namespace

std::shared_ptr<HidDevice> open_hid_device(const std::shared_ptr<Hid>& hid, const std::string& path,
                                           Duration deadline) {
  using Opened = std::pair<std::shared_ptr<HidDevice>, int>;
  const Opened opened = within(deadline, "Opening " + path, [hid, path]() -> Opened {
    int error = 0;
    auto device = hid->open(path, error);
    return {std::move(device), error};
  });
  if (opened.first == nullptr) throw BackendError(why_not_opened(path, opened.second));
  return opened.first;
}

Report get_feature_report(const std::shared_ptr<HidDevice>& device, std::uint8_t number,
                          Duration deadline) {
  const std::string what = "The request for feature report " + std::to_string(number);
  const auto [report, result] = within(deadline, what, [device, number] {
    Report answer;
    answer.data[0] = number;
    const int bytes =
        uninterrupted([&] { return device->get_feature(answer.data.data(), answer.data.size()); });
    answer.size = static_cast<std::size_t>(std::max(bytes, 0));
    return std::pair(answer, bytes);
  });
  if (result <= 0) {
    throw BackendError(what + " failed: " + (result < 0 ? message(-result) : "no bytes came") +
                       ". The device's firmware has to answer it.");
  }
  return report;
}

TransportStatus HidTransport::read(Report& report, Duration timeout) noexcept {
  const auto whole = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  int wait = static_cast<int>(std::clamp<std::int64_t>(whole, 0, 1000));
  const auto call = [&] { return device_->read(report.data.data(), report.data.size(), wait); };
  int result = uninterrupted(call);
  if (result == 0) {
    wait = 0;
    result = uninterrupted(call);
  }
  report.size = static_cast<std::size_t>(std::max(result, 0));
  if (result > 0) return TransportStatus::data;
  if (result == 0) return TransportStatus::nothing;
  read_error_.store(-result, std::memory_order_relaxed);
  const bool gone = result == -ENODEV || result == -EIO;
  return gone ? TransportStatus::gone : TransportStatus::error;
}

TransportStatus HidTransport::write(const Report& report) noexcept {
  if (report.size == 0) return TransportStatus::nothing;
  const int result = uninterrupted([&] { return device_->write(report.data.data(), report.size); });
  if (result == static_cast<int>(report.size)) return TransportStatus::data;
  // Where fewer bytes were written, the device did not get a whole report.
  write_error_.store(result < 0 ? -result : EMSGSIZE, std::memory_order_relaxed);
  return result == -ENODEV ? TransportStatus::gone : TransportStatus::error;
}

std::string HidTransport::problem() const {
  std::string text = guardian_ ? guardian_->problem() : why_unguarded_;
  const auto add = [&](const char* what, int error) {
    if (error == 0) return;
    if (!text.empty()) text += ' ';
    text += what;
    text += error == ENODEV ? "the device is unplugged." : message(error) + ".";
  };
  add("Reading: ", read_error_.load(std::memory_order_relaxed));
  add("Writing: ", write_error_.load(std::memory_order_relaxed));
  return text;
}

}  // namespace palpate
