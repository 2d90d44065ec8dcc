// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/simulating/reduced_body_loop.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// After a step that takes longer than the period the loop waits for the period divided by this.
/// Otherwise, with real-time priority, nothing else would run on its processor.
constexpr int kRest = 10;

ReducedBodyOptions options_of_body(const ReducedBodyLoopOptions& options) {
  validate(options);
  ReducedBodyOptions result = options.body;
  result.time_step = seconds(options.period);
  return result;
}

void check_positive(const char* name, Duration value) {
  if (value.count() > 0) return;
  throw InputError(std::string(name) + " is " + quantity(seconds(value), "s") +
                   ". Give more than 0.");
}

}  // namespace

void validate(const ReducedBodyLoopOptions& options) {
  check_positive("The period of the reduced body", options.period);
  check_positive("The time without a command after which a tool of the reduced body is let go",
                 options.release_after);
  validate(options.body);
}

ReducedBodyLoop::ReducedBodyLoop(const ReducedModel& model,
                                 std::vector<std::shared_ptr<SimulatedTool>> tools, Clock& clock,
                                 const ReducedBodyLoopOptions& options, ReducedBodyOutbox& outbox)
    : clock_(clock),
      options_(options),
      outbox_(outbox),
      tools_(std::move(tools)),
      couplings_(tools_.size()),
      body_(model, options_of_body(options)) {
  const Eigen::Index num_tools = model.num_tool_coordinates / 3;
  if (static_cast<Eigen::Index>(tools_.size()) != num_tools) {
    throw InputError("The reduced model has " + std::to_string(num_tools) + " tool(s), but " +
                     std::to_string(tools_.size()) + " are given. Give one for each.");
  }
  places_.setZero(model.num_tool_coordinates);
  before_.setZero(model.num_tool_coordinates);
  newest_.coordinates.setZero(model.num_coordinates());
  for (Index tool = 0; tool < static_cast<Index>(tools_.size()); ++tool) body_.hold(tool, 0);
  // Three writes give each place of the triple buffer its memory.
  for (int i = 0; i < 3; ++i) {
    outbox_.newest.write(newest_);
    (void)outbox_.newest.read();
  }
}

void ReducedBodyLoop::step() noexcept {
  keep_time(clock_.now());
  lead_tools();
  before_ = body_.coordinates().tail(before_.size());
  (void)body_.step(places_.data());
  answer();
  const Duration taken = clock_.now() - begin_;
  outbox_.step_time.add(taken);
  if (taken > options_.period) ++newest_.counters.too_long;
  count();
  newest_.time = begin_;
  newest_.state = body_.state();
  newest_.coordinates = body_.coordinates();
  outbox_.newest.write(newest_);
}

void ReducedBodyLoop::wait() noexcept {
  due_ += options_.period;
  const Time now = clock_.now();
  clock_.sleep_until(now > due_ ? now + options_.period / kRest : due_);
}

void ReducedBodyLoop::keep_time(Time begin) noexcept {
  ReducedBodyCounters& counters = newest_.counters;
  if (counters.steps == 0) first_begin_ = due_ = begin;
  begin_ = begin;
  const Duration late = begin - due_;
  outbox_.lateness.add(late);
  if (late >= options_.period) {
    counters.missed += static_cast<std::uint64_t>(late / options_.period);
    due_ = begin;
  }
  ++counters.steps;
  counters.running = begin - first_begin_;
}

void ReducedBodyLoop::lead_tools() noexcept {
  const double step = seconds(options_.period);
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (tools_[i] == nullptr) continue;
    const ToolCommand& command = tools_[i]->command.read();
    const SimulatedToolOptions& options = tools_[i]->options;
    Coupling& coupling = couplings_[i];
    const auto tool = static_cast<Index>(i);
    const bool was_held = coupling.is_held;
    coupling.is_held = command.is_held && command.hand.allFinite() &&
                       begin_ - command.time <= options_.release_after;
    if (!coupling.is_held) {
      body_.hold(tool, 0);
      continue;
    }
    const Eigen::Index first = 3 * static_cast<Eigen::Index>(i);
    const Eigen::Index num_modes = body_.coordinates().size() - places_.size();
    coupling.hand = command.hand;
    if (!was_held) {
      coupling.stretch = coupling.hand - body_.coordinates().segment<3>(num_modes + first);
    }
    const double damping = options.coupling_damping / step;
    const double stiffness = options.coupling_stiffness + damping;
    body_.hold(tool, stiffness);
    places_.segment<3>(first) = coupling.hand - damping / stiffness * coupling.stretch;
  }
}

void ReducedBodyLoop::answer() noexcept {
  const Eigen::Index num_modes = body_.coordinates().size() - places_.size();
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (tools_[i] == nullptr) continue;
    const Eigen::Index first = 3 * static_cast<Eigen::Index>(i);
    Coupling& coupling = couplings_[i];
    ToolAnswer answer;
    answer.time = begin_;
    answer.step = options_.period;
    answer.displacement = body_.coordinates().segment<3>(num_modes + first);
    const Vec3 moved = answer.displacement - before_.segment<3>(first);
    answer.velocity = moved / seconds(options_.period);
    answer.force = body_.force().segment<3>(first);
    coupling.work += 0.5 * (coupling.force + answer.force).dot(moved);
    coupling.force = answer.force;
    coupling.stretch = coupling.hand - answer.displacement;
    answer.work = coupling.work;
    answer.outcome = body_.state().outcome;
    answer.trust = body_.state().trust;
    tools_[i]->answer.write(answer);
  }
}

void ReducedBodyLoop::count() noexcept {
  const ReducedState& state = body_.state();
  ReducedBodyCounters& counters = newest_.counters;
  if (state.outcome == ReducedOutcome::not_converged) ++counters.not_converged;
  if (state.outcome == ReducedOutcome::beyond_training) ++counters.beyond_training;
  if (state.outcome == ReducedOutcome::tools_ahead) ++counters.tools_ahead;
  if (state.trust > kLargestTrusted) ++counters.untrusted;
  counters.largest_trust = std::max(counters.largest_trust, state.trust);
  counters.most_tangents = std::max(counters.most_tangents, state.tangents);
  counters.most_iterations = std::max(counters.most_iterations, state.iterations);
}

}  // namespace palpate
