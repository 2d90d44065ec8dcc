// SPDX-License-Identifier: BSD-3-Clause
// What the leader of an exploration around a hand and its explorers send each other. Each message
// has a kind, the number of the job that it is of, and bytes.
//
//   explorer → leader    hello (layout)      ready    result (ExplorerResult)    failed (text)
//                        alive (number of the task that is being made, or 0)
//   leader → explorer    job (ExplorerJob; empty: none)   task (ExplorerTask)   who   refuse (text)
//                        alive   stop
//
// An explorer says hello when it comes, and whenever it is asked who it is, as after a lost
// connection. It is given the job, says ready, or that the job has failed, and gets one task after
// the other. Twice a second it says that it is alive, and with what: so the leader sees if a job or
// a task was lost on the way. A new job ends the task of the old one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "explorers/handles.h"
#include "schedule/communicator.h"

namespace palpate {

enum class WireKind : std::uint8_t {
  hello,
  ready,
  result,
  failed,
  alive,
  job,
  task,
  who,
  refuse,
  stop
};

struct WireMessage {
  WireKind kind = WireKind::alive;
  std::int64_t job = 0;
  Bytes bytes;
};

/// The version of this program, and how it lays out numbers: bytes that both sides must have alike.
[[nodiscard]] Bytes wire_layout();

[[nodiscard]] Bytes bytes_of(const std::string& text);
[[nodiscard]] std::string text_of(const Bytes& bytes);

/// Ends connections on which nothing comes any more.
void watch_connections(zsock_t* socket);

enum class Sent {
  yes,
  /// What was sent before has not left yet.
  full,
  /// There is no connection.
  gone
};

/// Sends a message, without waiting.
/// @param to The address of the explorer if the socket is the leader's; else null.
Sent send(zsock_t* socket, const WireMessage& message, const std::string* to = nullptr);

[[nodiscard]] Bytes bytes_of(std::int64_t number);
/// 0 if the bytes are no number.
[[nodiscard]] std::int64_t number_of(const Bytes& bytes);

/// Takes a message that has come, without waiting.
/// @param from The address of the explorer if the socket is the leader's; else null.
/// @returns Nothing: there is none, or it is no message of this kind; then `is_garbage` is true.
[[nodiscard]] std::optional<WireMessage> receive(zsock_t* socket, bool& is_garbage,
                                                 std::string* from = nullptr);

}  // namespace palpate
