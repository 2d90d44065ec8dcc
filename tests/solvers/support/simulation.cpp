// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/simulation.h"

#include <ucontext.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <new>
#include <utility>

namespace palpate::test {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Of a rank: the workers' calls, with room for the frames of a sanitizer.
constexpr std::size_t kStackBytes = 256 << 10;

}  // namespace

/// A function on a stack of its own, which may be left in its middle and gone on with later. Its
/// end never comes: what is on the stack when the fiber goes must not need a destructor.
class Simulation::Fiber {
 public:
  explicit Fiber(std::function<void()> forever)
      : forever_(std::move(forever)), stack_(new std::byte[kStackBytes]) {
    getcontext(&own_);
    own_.uc_stack.ss_sp = stack_.get();
    own_.uc_stack.ss_size = kStackBytes;
    own_.uc_link = nullptr;
    // makecontext() passes ints: the address in two halves.
    const auto address = reinterpret_cast<std::uintptr_t>(this);
    makecontext(&own_, reinterpret_cast<void (*)()>(&enter), 2,
                static_cast<unsigned>(address >> 32), static_cast<unsigned>(address));
  }

  /// Goes on with the function until it leaves.
  void resume() { swapcontext(&outside_, &own_); }
  /// Within the function.
  void leave() { swapcontext(&own_, &outside_); }

 private:
  static void enter(unsigned high, unsigned low) {
    const auto address = static_cast<std::uintptr_t>(high) << 32 | low;
    reinterpret_cast<Fiber*>(address)->forever_();
  }

  std::function<void()> forever_;
  std::unique_ptr<std::byte[]> stack_;
  ucontext_t own_{};
  ucontext_t outside_{};
};

class Simulation::RankNetwork final : public Network {
 public:
  RankNetwork(Simulation& simulation, int rank) : simulation_(simulation), rank_(rank) {}

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return simulation_.size(); }
  void send(int to, int tag, Bytes content) override {
    simulation_.post(rank_, to, tag, std::move(content));
  }
  [[nodiscard]] std::optional<Message> receive() override {
    Rank& me = simulation_.ranks_[rank_];
    if (me.num_sound_calls >= 0 && me.num_sound_calls-- == 0) throw std::bad_alloc();
    if (me.arrived.empty()) return std::nullopt;
    me.clock += simulation_.machine_.overhead;
    std::optional<Message> message = std::move(me.arrived.front());
    me.arrived.pop_front();
    --simulation_.under_way_.messages;
    simulation_.under_way_.bytes -= message->content.size() + kMessageBytes;
    return message;
  }
  void flush() override {}
  [[nodiscard]] double now() const override { return simulation_.now(rank_); }
  void rest(double /*until*/) override {}

 private:
  Simulation& simulation_;
  int rank_;
};

/// The earliest is the largest.
bool Simulation::Event::operator<(const Event& other) const {
  return time != other.time ? time > other.time : number > other.number;
}

Simulation::Simulation(int num_ranks, const Machine& machine)
    : machine_(machine), ranks_(static_cast<std::size_t>(num_ranks)), random_(mix(machine.seed)) {
  for (int r = 0; r < num_ranks; ++r) ranks_[r].network = std::make_unique<RankNetwork>(*this, r);
}

Simulation::~Simulation() = default;

Network& Simulation::network(int rank) { return *ranks_[rank].network; }

void Simulation::spend(int rank, double seconds) { ranks_[rank].clock += seconds; }

void Simulation::work_on(int rank, double seconds) {
  ranks_[rank].clock += seconds;
  ranks_[rank].fiber->leave();
}

void Simulation::burden(int rank, std::size_t bytes) { ranks_[rank].burden += bytes; }

double Simulation::now(int rank) const { return ranks_[rank].clock; }

void Simulation::let_receive_fail(int rank, int num_before) {
  ranks_[rank].num_sound_calls = num_before;
}

bool Simulation::run(const std::vector<Worker*>& workers, const ScheduleOptions& options) {
  std::vector<std::unique_ptr<Scheduler>> schedulers;
  for (int r = 0; r < size(); ++r) {
    Rank& rank = ranks_[r];
    schedulers.push_back(std::make_unique<Scheduler>(*workers[r], *rank.network, options));
    rank.fiber = std::make_unique<Fiber>([&rank, &scheduler = *schedulers.back()] {
      for (;;) {
        try {
          rank.step = scheduler.step();
        } catch (...) {
          scheduler.fail();
        }
        rank.fiber->leave();
      }
    });
    // As after the agreement at the end of a run.
    rank.clock = makespan_;
    rank.planned = kNever;
    plan(r, makespan_);
  }
  for (int num_left = size(); num_left > 0;) {
    const Event event = events_.top();
    events_.pop();
    Rank& rank = ranks_[event.rank];
    if (event.message >= 0) {
      rank.arrived.push_back(std::move(messages_[event.message]));
      free_.push_back(event.message);
      // A busy one sees it when it is done.
      if (rank.idle) plan(event.rank, std::max(rank.clock, event.time + machine_.reaction));
      continue;
    }
    if (event.time != rank.planned) continue;
    rank.planned = kNever;
    rank.clock = std::max(rank.clock, event.time);
    rank.step = Scheduler::Step::busy;  // unless it comes to the end of one
    rank.fiber->resume();
    rank.idle = rank.step == Scheduler::Step::idle;
    if (rank.step == Scheduler::Step::over) {
      --num_left;
      makespan_ = std::max(makespan_, rank.clock);
    } else if (rank.idle && rank.arrived.empty()) {
      plan(event.rank, std::max(rank.clock, schedulers[event.rank]->idle_until()));
    } else {
      plan(event.rank, rank.clock);
    }
  }
  reports_.clear();
  for (const auto& scheduler : schedulers) reports_.push_back(scheduler->report());
  for (const auto& scheduler : schedulers) {
    if (scheduler->error()) std::rethrow_exception(scheduler->error());
  }
  return !schedulers.front()->stopped() && !schedulers.front()->paused();
}

void Simulation::post(int from, int to, int tag, Bytes content) {
  Rank& sender = ranks_[from];
  sender.clock += machine_.overhead;
  ++under_way_.messages;
  under_way_.bytes += content.size() + kMessageBytes;
  most_under_way_.messages = std::max(most_under_way_.messages, under_way_.messages);
  most_under_way_.bytes = std::max(most_under_way_.bytes, under_way_.bytes);
  const auto bytes = content.size() + kMessageBytes + std::exchange(sender.burden, 0);
  sender.out_is_free =
      std::max(sender.out_is_free, sender.clock) + static_cast<double>(bytes) / machine_.bandwidth;
  double arrival = sender.out_is_free + machine_.latency;
  if (machine_.distance) arrival += machine_.distance(from, to);
  if (machine_.jitter > 0) {
    const double uniform = static_cast<double>(mix(++random_) >> 11) * 0x1p-53;
    arrival += machine_.jitter * std::pow(uniform, 16);
    const auto pair = static_cast<std::uint64_t>(from) * ranks_.size() + to;
    double& last = last_arrival_[pair];
    last = arrival = std::max(arrival, last);
  }
  if (free_.empty()) {
    free_.push_back(static_cast<std::int64_t>(messages_.size()));
    messages_.emplace_back();
  }
  const std::int64_t message = free_.back();
  free_.pop_back();
  messages_[message] = {from, tag, std::move(content)};
  add_event(arrival, to, message);
}

/// The next time a rank goes on is the earliest of those that were planned.
void Simulation::plan(int rank, double time) {
  if (time >= ranks_[rank].planned) return;
  ranks_[rank].planned = time;
  add_event(time, rank, -1);
}

void Simulation::add_event(double time, int rank, std::int64_t message) {
  events_.push({time, num_events_++, rank, message});
}

}  // namespace palpate::test
