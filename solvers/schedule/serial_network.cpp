// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <deque>
#include <utility>

#include "schedule/network.h"

namespace palpate {
namespace {

class SerialNetwork final : public Network {
 public:
  [[nodiscard]] int rank() const override { return 0; }
  [[nodiscard]] int size() const override { return 1; }

  void send(int /*to*/, int tag, Bytes content) override {
    messages_.push_back({0, tag, std::move(content)});
  }

  [[nodiscard]] std::optional<Message> receive() override {
    if (messages_.empty()) return std::nullopt;
    std::optional<Message> message = std::move(messages_.front());
    messages_.pop_front();
    return message;
  }

  void flush() override {}

  [[nodiscard]] double now() const override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  /// No other rank could send anything.
  void rest(double /*until*/) override {}

 private:
  std::deque<Message> messages_;
};

}  // namespace

std::unique_ptr<Network> make_serial_network() { return std::make_unique<SerialNetwork>(); }

}  // namespace palpate
