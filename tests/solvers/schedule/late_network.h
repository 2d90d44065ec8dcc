// SPDX-License-Identifier: BSD-3-Clause
// A network that hands out what has come only after a random while. Messages of one sender keep
// their order, those of different ones do not.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
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

/// Another communicator with such a network.
class LateCommunicator final : public Communicator {
 public:
  LateCommunicator(Communicator& communicator, double latest, std::uint64_t seed)
      : communicator_(communicator), network_(communicator.network(), latest, seed) {}

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
  [[nodiscard]] Network& network() override { return network_; }

  [[nodiscard]] bool all_delivered() const { return network_.is_empty(); }

 private:
  Communicator& communicator_;
  LateNetwork network_;
};

}  // namespace palpate::test
