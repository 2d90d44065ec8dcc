// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/simulating/reduced_body_thread.h"

#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "haptic/realtime/memory_lock.h"
#include "haptic/realtime/realtime_thread.h"

namespace palpate {
namespace {

std::vector<std::shared_ptr<SimulatedTool>> make_tools(
    const std::vector<SimulatedToolOptions>& options) {
  std::vector<std::shared_ptr<SimulatedTool>> tools;
  for (const SimulatedToolOptions& of_tool : options) {
    tools.push_back(std::make_shared<SimulatedTool>(of_tool));
  }
  return tools;
}

const ReducedBodyLoopOptions& checked(const ReducedBodyThreadOptions& options) {
  validate(options);
  return options.loop;
}

/// A servo loop would take a body without a first step for one that has stopped, and its interlock
/// would trip. So start() waits for that step, but no longer than this.
constexpr Duration kFirstStep = std::chrono::seconds(1);

}  // namespace

void validate(const ReducedBodyThreadOptions& options) {
  validate(options.loop);
  if (options.priority >= 0 && options.priority <= 99) return;
  throw InputError("The real-time priority of the reduced body is " +
                   std::to_string(options.priority) + ". Give 1 to 99, or 0 for none.");
}

struct ReducedBodyThread::Shared {
  Shared(std::shared_ptr<const ReducedModel> its_model,
         const std::vector<SimulatedToolOptions>& its_tools, std::shared_ptr<Clock> its_clock,
         const ReducedBodyThreadOptions& its_options)
      : options(its_options),
        model(std::move(its_model)),
        tools(make_tools(its_tools)),
        clock(std::move(its_clock)),
        loop(*model, tools, *clock, checked(its_options), outbox) {}

  const ReducedBodyThreadOptions options;
  const std::shared_ptr<const ReducedModel> model;
  const std::vector<std::shared_ptr<SimulatedTool>> tools;
  const std::shared_ptr<Clock> clock;
  ReducedBodyOutbox outbox;
  ReducedBodyLoop loop;
  std::thread thread;
  bool was_started = false;
  std::atomic<bool> stop{false};
  std::atomic<bool> realtime_priority{false};
  std::atomic<bool> memory_locked{false};
  std::mutex mutex;
  /// Guarded by the mutex, which the loop never takes.
  std::string problem;

  void tell(const std::string& what) {
    const std::lock_guard guard(mutex);
    problem = what;
  }

  void run() noexcept {
    try {
      std::optional<MemoryLock> lock;
      if (options.priority != 0) {
        const std::string why_not = take_realtime_priority(options.priority, "The reduced body");
        realtime_priority = why_not.empty();
        tell(why_not);
        MemoryRanges ranges{own_stack(), {this, sizeof *this}};
        loop.body().add_memory(ranges);
        for (const auto& tool : tools) ranges.push_back({tool.get(), sizeof *tool});
        lock.emplace(ranges);
        memory_locked = lock->complete();
      }
      while (!stop.load(std::memory_order_relaxed)) {
        loop.step();
        loop.wait();
      }
    } catch (const std::exception& error) {
      tell(std::string("The reduced body has ended: ") + error.what());
    }
  }
};

ReducedBodyThread::ReducedBodyThread(std::shared_ptr<const ReducedModel> model,
                                     const std::vector<SimulatedToolOptions>& tools,
                                     std::shared_ptr<Clock> clock,
                                     const ReducedBodyThreadOptions& options)
    : shared_(std::make_unique<Shared>(std::move(model), tools, std::move(clock), options)) {}

ReducedBodyThread::~ReducedBodyThread() { stop(); }

void ReducedBodyThread::start() {
  if (std::exchange(shared_->was_started, true)) {
    throw BackendError("The reduced body was started before. Make a new one.");
  }
  const SignalsBlocked blocked;
  try {
    shared_->thread = std::thread([shared = shared_.get()] { shared->run(); });
  } catch (const std::system_error& error) {
    throw BackendError(std::string("The thread of the reduced body cannot be started: ") +
                       error.what());
  }
  MonotonicClock clock;
  for (const Time end = clock.now() + kFirstStep; latest().counters.steps == 0;) {
    if (clock.now() > end) break;
    clock.sleep_until(clock.now() + std::chrono::milliseconds(1));
  }
}

void ReducedBodyThread::stop() noexcept {
  shared_->stop = true;
  if (shared_->thread.joinable()) shared_->thread.join();
}

Index ReducedBodyThread::num_tools() const { return static_cast<Index>(shared_->tools.size()); }

const std::shared_ptr<SimulatedTool>& ReducedBodyThread::tool(Index number) const {
  return shared_->tools.at(static_cast<std::size_t>(number));
}

const ReducedBodyOutbox::Newest& ReducedBodyThread::latest() {
  return shared_->outbox.newest.read();
}

ReducedBodyStatistics ReducedBodyThread::statistics() {
  ReducedBodyStatistics statistics;
  static_cast<ReducedBodyCounters&>(statistics) = latest().counters;
  statistics.lateness = shared_->outbox.lateness.percentiles();
  statistics.step_time = shared_->outbox.step_time.percentiles();
  statistics.realtime_priority = shared_->realtime_priority;
  statistics.memory_locked = shared_->memory_locked;
  return statistics;
}

std::string ReducedBodyThread::problem() {
  std::string text;
  {
    const std::lock_guard lock(shared_->mutex);
    text = shared_->problem;
  }
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : " ") + more; };
  const ReducedBodyOutbox::Newest& newest = latest();
  // A few steps are missed at the beginning and after each pause of the machine.
  constexpr std::uint64_t kManySteps = 1000;
  constexpr std::uint64_t kShare = 50;
  const ReducedBodyCounters& counters = newest.counters;
  if (counters.steps > kManySteps && counters.missed > counters.steps / kShare) {
    add("The reduced body has missed " + std::to_string(counters.missed) + " of " +
        std::to_string(counters.steps + counters.missed) +
        " steps, and moves slower than it should: give it a longer period, or a smaller model.");
  }
  if (newest.state.trust > kLargestTrusted) {
    add("The body is moved by " + quantity(newest.state.trust, "") +
        " times what its reduced model was trained for: its forces are not to be trusted.");
  }
  return text;
}

}  // namespace palpate
