// SPDX-License-Identifier: BSD-3-Clause
// Networks that make it hard: one that hands out what has come only after a random while, where
// messages of one sender keep their order and those of different ones do not; and one that is short
// of memory.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <new>
#include <utility>

#include "schedule/communicator.h"
#include "schedule/owner.h"

namespace palpate::test {

class LateNetwork final : public Network {
 public:
  /// @param latest The longest while, s; most are far shorter.
  LateNetwork(Network& network, double latest, std::uint64_t seed)
      : network_(network), latest_(latest), random_(mix(seed + 1000u * network.rank())) {}

  [[nodiscard]] int rank() const override { return network_.rank(); }
  [[nodiscard]] int size() const override { return network_.size(); }
  void send(int to, int tag, Bytes content) override { network_.send(to, tag, std::move(content)); }
  [[nodiscard]] std::optional<Message> receive() override {
    while (auto message = network_.receive()) {
      const double uniform = static_cast<double>(mix(++random_) >> 11) * 0x1p-53;
      const double delay = latest_ * std::pow(uniform, 4);
      auto& held = held_[message->from];
      const double after = held.empty() ? 0 : held.back().first;
      held.emplace_back(std::max(now() + delay, after), std::move(*message));
    }
    for (auto& [from, held] : held_) {
      if (held.empty() || held.front().first > now()) continue;
      std::optional<Message> message = std::move(held.front().second);
      held.pop_front();
      return message;
    }
    return std::nullopt;
  }
  void flush() override { network_.flush(); }
  [[nodiscard]] double now() const override { return network_.now(); }
  void rest(double until) override { network_.rest(until); }

  [[nodiscard]] bool is_empty() const {
    return std::all_of(held_.begin(), held_.end(),
                       [](const auto& of) { return of.second.empty(); });
  }

 private:
  Network& network_;
  double latest_;
  std::uint64_t random_;
  /// By sender, each with the time from which on it may be seen.
  std::map<int, std::deque<std::pair<double, Message>>> held_;
};

/// A network in which there is not enough memory for some of what comes: it stays where it is.
class ShortNetwork final : public Network {
 public:
  /// @param first, count The calls of receive() that fail.
  ShortNetwork(Network& network, int first, int count)
      : network_(network), first_(first), count_(count) {}

  [[nodiscard]] int rank() const override { return network_.rank(); }
  [[nodiscard]] int size() const override { return network_.size(); }
  void send(int to, int tag, Bytes content) override { network_.send(to, tag, std::move(content)); }
  [[nodiscard]] std::optional<Message> receive() override {
    const int call = num_calls_++;
    if (call >= first_ && call < first_ + count_) throw std::bad_alloc();
    return network_.receive();
  }
  void flush() override { network_.flush(); }
  [[nodiscard]] double now() const override { return network_.now(); }
  void rest(double until) override { network_.rest(until); }

 private:
  Network& network_;
  int first_;
  int count_;
  int num_calls_ = 0;
};

/// Another communicator with another network.
template <class OtherNetwork>
class CommunicatorWith : public Communicator {
 public:
  /// @param parameters Of the network, after that of the communicator.
  template <class... Parameters>
  explicit CommunicatorWith(Communicator& communicator, Parameters... parameters)
      : communicator_(communicator), network_(communicator.network(), parameters...) {}

  [[nodiscard]] int rank() const override { return communicator_.rank(); }
  [[nodiscard]] int size() const override { return communicator_.size(); }
  [[nodiscard]] std::vector<Bytes> all_gather(const Bytes& mine) override {
    return communicator_.all_gather(mine);
  }
  [[nodiscard]] std::vector<Bytes> gather(const Bytes& mine) override {
    return communicator_.gather(mine);
  }
  [[nodiscard]] std::vector<Bytes> exchange(const std::vector<Bytes>& to) override {
    return communicator_.exchange(to);
  }
  [[nodiscard]] std::unique_ptr<Communicator> split(int colour) override {
    return communicator_.split(colour);
  }
  void share(Failure& failure) override { communicator_.share(failure); }
  [[nodiscard]] int num_shared_failures() const override {
    return communicator_.num_shared_failures();
  }
  [[nodiscard]] OtherNetwork& network() override { return network_; }

 private:
  Communicator& communicator_;
  OtherNetwork network_;
};

using LateCommunicator = CommunicatorWith<LateNetwork>;
using ShortCommunicator = CommunicatorWith<ShortNetwork>;

}  // namespace palpate::test
