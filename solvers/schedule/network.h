// SPDX-License-Identifier: BSD-3-Clause
// What the scheduler needs of the outside: messages between ranks, and a clock.
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

  /// Returns at once; the content may have any length. What a rank sends to another one arrives in
  /// the order in which it was sent.
  /// @param to Another rank, or this one.
  /// @param tag 0 … 1000
  virtual void send(int to, int tag, Bytes content) = 0;
  /// The next message that has come whole. A large one needs both its ends to call this now and
  /// then.
  [[nodiscard]] virtual std::optional<Message> receive() = 0;
  /// Waits until all that was sent has left; the receivers must go on to receive.
  virtual void flush() = 0;

  /// s, from a start of this rank's own.
  [[nodiscard]] virtual double now() const = 0;
  /// Has nothing to do before the time `until` unless something comes: rests for a moment, a longer
  /// one the longer nothing has come, 1 ms at the most. So idle ranks leave the cores to busy ones
  /// where there are more ranks than cores.
  virtual void rest(double until) = 0;

 protected:
  Network() = default;
};

/// One rank.
[[nodiscard]] std::unique_ptr<Network> make_serial_network();

}  // namespace palpate
