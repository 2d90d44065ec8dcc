// SPDX-License-Identifier: BSD-3-Clause
// A random graph of tasks in layers: a task leads to some of the next layer, several to the same
// one, which is to be executed once. The work of a rank is what is at owner there and what it was
// given.
#pragma once

#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <set>
#include <stdexcept>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/error.h"
#include "schedule/worker.h"

namespace palpate::test {

using Key = std::uint64_t;

struct RandomGraph {
  std::uint64_t seed = 1;
  int num_roots = 3;
  int num_layers = 12;
  int width = 40;
  int most_children = 4;

  [[nodiscard]] std::vector<Key> roots() const {
    std::vector<Key> keys;
    for (int i = 0; i < num_roots; ++i) keys.push_back(static_cast<Key>(i));
    return keys;
  }
  /// With repetitions.
  [[nodiscard]] std::vector<Key> children(Key key) const {
    const Key layer = key / static_cast<Key>(width) + 1;
    std::vector<Key> keys;
    if (layer >= static_cast<Key>(num_layers)) return keys;
    const std::uint64_t number = random(key, 0) % static_cast<std::uint64_t>(most_children + 1);
    for (std::uint64_t i = 0; i < number; ++i) {
      keys.push_back(layer * static_cast<Key>(width) +
                     random(key, i + 1) % static_cast<Key>(width));
    }
    return keys;
  }
  /// Uniform between 0 and 1.
  [[nodiscard]] double cost(Key key) const {
    return static_cast<double>(random(key, 99) >> 11) * 0x1p-53;
  }
  /// All that the roots lead to.
  [[nodiscard]] std::set<Key> reachable() const {
    std::set<Key> found;
    std::vector<Key> stack = roots();
    while (!stack.empty()) {
      const Key key = stack.back();
      stack.pop_back();
      if (!found.insert(key).second) continue;
      for (const Key child : children(key)) stack.push_back(child);
    }
    return found;
  }

 private:
  [[nodiscard]] std::uint64_t random(Key key, std::uint64_t i) const {
    return mix(mix(mix(seed) + key) + i);
  }
};

inline Bytes to_bytes(const std::vector<Key>& keys) {
  Bytes bytes(keys.size() * sizeof(Key));
  if (!keys.empty()) std::memcpy(bytes.data(), keys.data(), bytes.size());
  return bytes;
}

inline std::vector<Key> to_keys(const Bytes& bytes) {
  std::vector<Key> keys(bytes.size() / sizeof(Key));
  if (!keys.empty()) std::memcpy(keys.data(), bytes.data(), keys.size() * sizeof(Key));
  return keys;
}

/// Of a key of any length (FNV-1a, mixed).
[[nodiscard]] inline std::uint64_t hash_of(const Bytes& key) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::byte b : key) hash = (hash ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3u;
  return mix(hash);
}

struct HashOfBytes {
  [[nodiscard]] std::size_t operator()(const Bytes& key) const { return hash_of(key); }
};

/// What is known of the states that are at owner on this rank, by the whole of their keys: states
/// whose hashes collide stay apart.
template <class Value>
using TranspositionTable = std::unordered_map<Bytes, Value, HashOfBytes>;

class GraphWorker : public Worker {
 public:
  /// @param first Tasks that this rank posts at the start.
  GraphWorker(const RandomGraph& graph, std::vector<Key> first)
      : graph_(graph), first_(std::move(first)) {}

  void start(Mail& mail) override {
    for (const Key key : first_) post(key, mail);
  }
  void receive(int /*from*/, const Bytes& message, Mail& /*mail*/) override {
    if (known_.emplace(message, true).second) tasks_.push_back(to_keys(message).front());
  }
  [[nodiscard]] bool has_work() const override { return !tasks_.empty(); }
  void work(Mail& mail) override {
    const Key key = tasks_.back();
    tasks_.pop_back();
    executed.push_back(key);
    if (during) during(key, mail);
    for (const Key child : graph_.children(key)) post(child, mail);
  }
  [[nodiscard]] Bytes give() override {
    const auto half = static_cast<std::ptrdiff_t>(tasks_.size() / 2);
    const std::vector<Key> given(tasks_.begin(), tasks_.begin() + half);
    tasks_.erase(tasks_.begin(), tasks_.begin() + half);
    return to_bytes(given);
  }
  void take(const Bytes& share, Mail& /*mail*/) override {
    for (const Key key : to_keys(share)) tasks_.push_back(key);
  }
  void discard() override {
    tasks_.clear();
    was_discarded = true;
  }

  std::vector<Key> executed;
  bool was_discarded = false;
  /// What a task does besides.
  std::function<void(Key, Mail&)> during;

 private:
  void post(Key key, Mail& mail) {
    const Bytes message = to_bytes({key});
    mail.send_to_owner(hash_of(message), message);
  }

  const RandomGraph& graph_;
  std::vector<Key> first_;
  TranspositionTable<bool> known_;
  std::deque<Key> tasks_;
};

}  // namespace palpate::test
