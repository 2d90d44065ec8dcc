// SPDX-License-Identifier: BSD-3-Clause
// A port of this machine that passes everything on to another one, and whose connections can be
// cut.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace palpate::test {

[[nodiscard]] inline sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

[[nodiscard]] inline int port_of(const std::string& endpoint) {
  return std::stoi(endpoint.substr(endpoint.rfind(':') + 1));
}

/// A socket that is connected with a port of this machine; negative: nobody is there.
[[nodiscard]] inline int connect_to(int port) {
  const int file = socket(AF_INET, SOCK_STREAM, 0);
  const sockaddr_in address = loopback(port);
  if (connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return file;
  close(file);
  return -1;
}

class Relay {
 public:
  /// @param endpoint "tcp://host:port" of this machine, to which it passes on.
  explicit Relay(const std::string& endpoint) : to_(port_of(endpoint)) {
    sockaddr_in address = loopback(0);
    socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(listening_, any, size), 0);
    EXPECT_EQ(listen(listening_, 16), 0);
    EXPECT_EQ(getsockname(listening_, any, &size), 0);
    endpoint_ = "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::thread([this] { run(); });
  }
  ~Relay() {
    ends_ = true;
    thread_.join();
    cut_all();
    close(listening_);
  }
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }
  /// Cuts all connections, in the middle of whatever they carry.
  void cut() { cuts_ = true; }
  [[nodiscard]] int num_cut() const { return num_cut_; }

 private:
  void run() {
    while (!ends_) {
      if (cuts_.exchange(false)) cut_all();
      std::vector<pollfd> polled{{listening_, POLLIN, 0}};
      for (const auto& [a, b] : pairs_) {
        polled.push_back({a, POLLIN, 0});
        polled.push_back({b, POLLIN, 0});
      }
      if (poll(polled.data(), polled.size(), 5) <= 0) continue;
      for (std::size_t i = 0; i < pairs_.size(); ++i) {
        auto& [a, b] = pairs_[i];
        const bool is_open = (polled[1 + 2 * i].revents == 0 || pass(a, b)) &&
                             (polled[2 + 2 * i].revents == 0 || pass(b, a));
        if (is_open) continue;
        close(a);
        close(b);
        a = b = -1;
      }
      pairs_.erase(std::remove(pairs_.begin(), pairs_.end(), std::pair(-1, -1)), pairs_.end());
      if (polled[0].revents != 0) {
        const int from = accept(listening_, nullptr, nullptr);
        pairs_.emplace_back(from, connect_to(to_));
      }
    }
  }
  [[nodiscard]] bool pass(int from, int to) {
    const ssize_t size = read(from, buffer_.data(), buffer_.size());
    for (ssize_t sent = 0; sent < size;) {
      const ssize_t more =
          send(to, buffer_.data() + sent, static_cast<std::size_t>(size - sent), MSG_NOSIGNAL);
      if (more <= 0) return false;
      sent += more;
    }
    return size > 0;
  }
  void cut_all() {
    for (const auto& [a, b] : std::exchange(pairs_, {})) {
      close(a);
      close(b);
      ++num_cut_;
    }
  }

  int to_;
  int listening_ = socket(AF_INET, SOCK_STREAM, 0);
  std::string endpoint_;
  std::vector<std::pair<int, int>> pairs_;
  std::array<char, 1 << 16> buffer_{};
  std::atomic<bool> ends_{false};
  std::atomic<bool> cuts_{false};
  std::atomic<int> num_cut_{0};
  std::thread thread_;
};

}  // namespace palpate::test
