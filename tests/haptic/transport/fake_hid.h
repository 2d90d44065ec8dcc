// SPDX-License-Identifier: BSD-3-Clause
// HID devices that do what a test says, in place of hidapi's.
#pragma once

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <deque>
#include <future>
#include <map>

#include "base/error.h"
#include "haptic/transport/hid.h"

namespace palpate::test {

/// What a call gives: a report, 0 for nothing, or −errno.
struct Answer {
  Answer(int its_result) : result(its_result) {}
  Answer(const Report& its_report)
      : result(static_cast<int>(its_report.size)), report(its_report) {}

  int result;
  Report report;
};

class FakeDevice final : public HidDevice {
 public:
  int read(std::uint8_t* data, std::size_t size, int timeout_ms) noexcept override {
    timeouts.push_back(timeout_ms);
    return next(reads, data, size);
  }
  int write(const std::uint8_t* data, std::size_t size) noexcept override {
    Report report;
    std::copy_n(data, size, report.data.begin());
    report.size = size;
    written.push_back(report);
    if (writes.empty()) return static_cast<int>(size);
    const int result = writes.front();
    writes.pop_front();
    return result;
  }
  int get_feature(std::uint8_t* data, std::size_t size) noexcept override {
    asked_for = data[0];
    if (hangs.valid()) hangs.wait();
    return next(features, data, size);
  }

  std::deque<Answer> reads;
  std::deque<int> writes;
  std::deque<Answer> features;
  /// get_feature() returns when this is there.
  std::shared_future<void> hangs;

  std::vector<int> timeouts;
  std::vector<Report> written;
  std::atomic<int> asked_for{-1};

 private:
  static int next(std::deque<Answer>& answers, std::uint8_t* data, std::size_t size) {
    if (answers.empty()) return 0;
    const Answer answer = answers.front();
    answers.pop_front();
    std::copy_n(answer.report.data.begin(), std::min(answer.report.size, size), data);
    return answer.result;
  }
};

class FakeHid final : public Hid {
 public:
  std::vector<DeviceInfo> list() override { return devices; }
  std::shared_ptr<HidDevice> open(const std::string& path, int& error) override {
    opened.push_back(path);
    if (hangs.valid()) hangs.wait();
    const auto found = by_path.find(path);
    if (found == by_path.end()) {
      error = errors.count(path) != 0 ? errors[path] : ENOENT;
      return nullptr;
    }
    return found->second;
  }
  std::unique_ptr<Guardian> guard(const std::string& path, const Report& zero) override {
    guarded.emplace_back(path, zero);
    if (!why_unguarded.empty()) throw BackendError(why_unguarded);
    return nullptr;
  }

  /// @return The device behind the path, which can be opened.
  FakeDevice& add(const std::string& path, int vendor, int product, int page, int usage) {
    DeviceInfo info;
    info.path = path;
    info.vendor_id = static_cast<std::uint16_t>(vendor);
    info.product_id = static_cast<std::uint16_t>(product);
    info.usage_page = static_cast<std::uint16_t>(page);
    info.usage = static_cast<std::uint16_t>(usage);
    devices.push_back(info);
    return *(by_path[path] = std::make_shared<FakeDevice>());
  }
  void fail(const std::string& path, int error) {
    by_path.erase(path);
    errors[path] = error;
  }

  std::vector<DeviceInfo> devices;
  std::map<std::string, std::shared_ptr<FakeDevice>> by_path;
  std::map<std::string, int> errors;
  /// open() goes on when this is there.
  std::shared_future<void> hangs;
  std::vector<std::string> opened;
  /// What guardians were asked for, with the zero report; they are refused where this says why.
  std::vector<std::pair<std::string, Report>> guarded;
  std::string why_unguarded;
};

/// What a call throws, in words; empty: it throws nothing.
template <class Error, class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

[[nodiscard]] inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace palpate::test
