// SPDX-License-Identifier: BSD-3-Clause
// What the scheduler needs of its environment: messages between ranks, and a clock.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace palpate {

using Bytes = std::vector<std::byte>;

struct Message {
  int from = 0;
  int tag = 0;
  Bytes content;
};

class Network {
 public:
  virtual ~Network() = default;
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;

  /// Sends a message of any length and returns at once. Messages of one rank to another arrive in
  /// the order in which they were sent.
  /// @param to Another rank, or this one.
  /// @param tag 0 … 1000
  virtual void send(int to, int tag, Bytes content) = 0;
  /// The next message that has arrived completely. A large message needs both its sender and its
  /// receiver to call this repeatedly.
  [[nodiscard]] virtual std::optional<Message> receive() = 0;
  /// Waits until all messages have left; their receivers must go on to call receive().
  virtual void flush() = 0;

  /// Time since a start that each rank has for itself, s.
  [[nodiscard]] virtual double now() const = 0;
  /// Waits for a moment, at most until the time `until`, if nothing arrives before. The moment
  /// grows from yielding the core to 1 ms while nothing arrives, so that idle ranks leave the cores
  /// to busy ones where there are more ranks than cores.
  virtual void rest(double until) = 0;

 protected:
  Network() = default;
};

/// The network of a single rank.
[[nodiscard]] std::unique_ptr<Network> make_serial_network();

}  // namespace palpate
