// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/batch.h"

#include <cstring>

namespace palpate {
namespace {

void append(Bytes& message, const void* data, std::size_t size) {
  const auto* first = static_cast<const std::byte*>(data);
  message.insert(message.end(), first, first + size);
}

}  // namespace

std::vector<Bytes> run_batch(Communicator& communicator, const std::vector<int>& owners,
                             const std::function<Bytes(std::int64_t)>& execute) {
  // A rank's results in the order of its tasks, each behind its length.
  Bytes message;
  agree(communicator, [&] {
    for (std::size_t i = 0; i < owners.size(); ++i) {
      if (owners[i] != communicator.rank()) continue;
      const Bytes result = execute(static_cast<std::int64_t>(i));
      const auto length = static_cast<std::uint64_t>(result.size());
      append(message, &length, sizeof length);
      append(message, result.data(), result.size());
    }
  });
  const std::vector<Bytes> messages = communicator.all_gather(message);
  std::vector<std::size_t> read(messages.size(), 0);
  std::vector<Bytes> results;
  results.reserve(owners.size());
  for (const int owner : owners) {
    const Bytes& from = messages[owner];
    std::size_t& at = read[owner];
    std::uint64_t length = 0;
    std::memcpy(&length, from.data() + at, sizeof length);
    at += sizeof length;
    results.emplace_back(from.begin() + static_cast<std::ptrdiff_t>(at),
                         from.begin() + static_cast<std::ptrdiff_t>(at + length));
    at += length;
  }
  return results;
}

}  // namespace palpate
