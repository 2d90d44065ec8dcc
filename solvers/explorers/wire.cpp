// SPDX-License-Identifier: BSD-3-Clause
#include "explorers/wire.h"

#include <cerrno>
#include <cstring>
#include <iterator>
#include <utility>

#include "schedule/packing.h"

namespace palpate {
namespace {

/// Raised when a message changes its form.
constexpr std::uint32_t kVersion = 1;
/// A connection on which nothing has come for this time has ended, ms, and how often that is tried.
constexpr int kConnectionSilence = 20'000;
constexpr int kBetweenHeartbeats = 2'000;

std::optional<WireMessage> read(zmsg_t* message, std::string* from) {
  const std::size_t num_frames = from == nullptr ? 2 : 3;
  if (zmsg_size(message) != num_frames) return std::nullopt;
  if (from != nullptr) {
    const Frame address(zmsg_pop(message));
    from->assign(reinterpret_cast<const char*>(zframe_data(address.get())),
                 zframe_size(address.get()));
  }
  const Frame head(zmsg_pop(message));
  const Frame body(zmsg_pop(message));
  WireMessage result;
  if (zframe_size(head.get()) != 1 + sizeof result.job) return std::nullopt;
  const byte kind = *zframe_data(head.get());
  if (kind > static_cast<byte>(WireKind::stop)) return std::nullopt;
  result.kind = static_cast<WireKind>(kind);
  std::memcpy(&result.job, zframe_data(head.get()) + 1, sizeof result.job);
  const auto* first = reinterpret_cast<const std::byte*>(zframe_data(body.get()));
  result.bytes.assign(first, first + zframe_size(body.get()));
  return result;
}

}  // namespace

Bytes wire_layout() {
  Packer layout;
  layout.put(kVersion);
  layout.put(std::uint32_t{0x01020304});
  layout.put(std::uint64_t{sizeof(std::size_t)});
  layout.put(-1.5);
  return layout.take();
}

void watch_connections(zsock_t* socket) {
  zsock_set_heartbeat_ivl(socket, kBetweenHeartbeats);
  zsock_set_heartbeat_timeout(socket, kConnectionSilence);
  // With a limit of what waits to be read, libzmq reads no more from a connection where it is
  // reached; if that is then closed, libzmq 4.3 aborts the program at its next heartbeat.
  zsock_set_rcvhwm(socket, 0);
}

Bytes bytes_of(const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Bytes bytes_of(std::int64_t number) {
  Packer bytes;
  bytes.put(number);
  return bytes.take();
}

std::int64_t number_of(const Bytes& bytes) {
  std::int64_t number = 0;
  if (bytes.size() == sizeof number) std::memcpy(&number, bytes.data(), sizeof number);
  return number;
}

Sent send(zsock_t* socket, const WireMessage& message, const std::string* to) {
  Parts parts(zmsg_new());
  if (to != nullptr) zmsg_addmem(parts.get(), to->data(), to->size());
  byte head[1 + sizeof message.job];
  head[0] = static_cast<byte>(message.kind);
  std::memcpy(head + 1, &message.job, sizeof message.job);
  zmsg_addmem(parts.get(), head, sizeof head);
  zmsg_addmem(parts.get(), message.bytes.data(), message.bytes.size());
  zmsg_t* raw = parts.release();
  if (zmsg_send(&raw, socket) == 0) return Sent::yes;
  const bool is_gone = zmq_errno() == EHOSTUNREACH;
  zmsg_destroy(&raw);
  return is_gone ? Sent::gone : Sent::full;
}

std::optional<WireMessage> receive(zsock_t* socket, bool& is_garbage, std::string* from) {
  is_garbage = false;
  if ((zsock_events(socket) & ZMQ_POLLIN) == 0) return std::nullopt;
  const Parts message(zmsg_recv(socket));
  if (message == nullptr) return std::nullopt;
  std::optional<WireMessage> result = read(message.get(), from);
  is_garbage = !result;
  return result;
}

}  // namespace palpate
