// SPDX-License-Identifier: BSD-3-Clause
#include "following/explorer.h"

#include <deque>
#include <exception>
#include <utility>
#include <vector>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/tangent_solver.h"
#include "exploration/conversion.h"
#include "exploration/make_configuration.h"
#include "exploration/precompute_options.h"
#include "exploration/transfer.h"

namespace palpate {
namespace {

/// The number of states that an explorer remembers. The solver keeps about as many factors.
constexpr std::size_t kRecent = 8;

PrecomputeOptions options_of(const ExplorerJob& job) {
  PrecomputeOptions options;
  if (job.setup.presses()) options.contact.emplace();
  options.equilibrium.tolerance = job.tolerance;
  options.equilibrium.max_seconds = job.max_seconds;
  options.equilibrium.single_precision = job.single_precision;
  options.equilibrium.third_derivatives = job.setup.policy.third_derivatives;
  // An explorer is one core of many.
  options.equilibrium.threads = 1;
  return options;
}

EquilibriumOptions solver_options(const ExplorerJob& job, std::function<bool()> abort_requested) {
  EquilibriumOptions options = exploring(options_of(job));
  options.abort_requested = std::move(abort_requested);
  return options;
}

SpaceBody body_of(const ExplorerJob& job) {
  SpaceBody body;
  body.number = job.setup.body;
  body.scene = job.scene;
  body.at_rest = job.at_rest;
  return body;
}

void put(const std::string& text, Packer& message) {
  message.put(std::vector<char>(text.begin(), text.end()));
}

std::string take_text(Unpacker& message) {
  const auto text = message.take<std::vector<char>>();
  return {text.begin(), text.end()};
}

void require_end(const Unpacker& message) { Unpacker::require(message.at_end()); }

}  // namespace

template <class Visit>
void for_each_part(Transition& transition, Visit&& visit) {
  visit(transition.target);
  visit(transition.start);
  visit(transition.start_level);
  visit(transition.finds_candidate);
}

struct Explorer::Impl {
  Impl(const ExplorerJob& job, std::function<bool()> abort_requested)
      : setup(job.setup),
        body(body_of(job)),
        solver(*job.scene, solver_options(job, std::move(abort_requested)),
               make_tangent_solver(job.linear_solver, *job.scene, 1)),
        tools(body.scene->body, body.at_rest),
        states(body, solver, tools, job.estimate_mesh_error) {}

  /// The state at the start of a task.
  [[nodiscard]] Equilibrium start_of(const ExplorerTask& task);
  /// Remembers a state from which others may start.
  void remember(const Configuration& found);

  ToolSpaceSetup setup;
  SpaceBody body;
  EquilibriumSolver solver;
  InteractionFactory tools;
  InteractionSolver states;
  /// The states that were found last. The solver still has factors of them, which it knows by
  /// fields that are the same to the last digit; those that a session has kept are rounded.
  std::deque<Configuration> recent;
};

Equilibrium Explorer::Impl::start_of(const ExplorerTask& task) {
  for (const Configuration& c : recent) {
    // Since it was found, a candidate may have become a level.
    if (c.check_point != task.start->check_point || c.energy != task.start->energy) continue;
    return to_equilibrium(Configuration(c));
  }
  const Equilibrium start = to_equilibrium(Configuration(*task.start));
  return task.kept < Keep::all ? states.restore(setup, start, task.kept) : start;
}

void Explorer::Impl::remember(const Configuration& found) {
  recent.push_front(found);
  if (recent.size() > kRecent) recent.pop_back();
}

Explorer::Explorer(const ExplorerJob& job, std::function<bool()> abort_requested)
    : impl_(std::make_unique<Impl>(job, std::move(abort_requested))) {}

Explorer::~Explorer() = default;

ExplorerResult Explorer::make(const ExplorerTask& task) {
  ExplorerResult result;
  result.number = task.number;
  try {
    std::optional<Equilibrium> start;
    if (task.start) start = impl_->start_of(task);
    result.found = make_configuration(impl_->states, impl_->setup, task.transition,
                                      start ? &*start : nullptr, level_of(task.transition),
                                      task.leads_on ? Tangent::factorised : Tangent::iterated);
    if (task.leads_on && result.found.usable()) impl_->remember(result.found);
  } catch (const InputError& error) {
    result.refusal = error.what();
  } catch (const std::exception& error) {
    result.failure = error.what();
    result.found = {};
    result.found.check_point = task.transition.target;
    result.found.parent = task.transition.start;
    result.found.parent_level = task.transition.start_level;
    result.found.level = level_of(task.transition);
    result.found.outcome = Outcome::not_converged;
  }
  return result;
}

Bytes pack(const ExplorerJob& job) {
  Packer message;
  message.put(*job.scene);
  message.put(job.at_rest);
  message.put(job.setup);
  put(job.linear_solver, message);
  message.put(job.tolerance);
  message.put(job.max_seconds);
  message.put(job.single_precision);
  message.put(job.estimate_mesh_error);
  return message.take();
}

ExplorerJob unpack_job(const Bytes& bytes) {
  Unpacker message(bytes);
  ExplorerJob job;
  job.scene = std::make_shared<const Scene>(message.take<Scene>());
  message.take(job.at_rest);
  message.take(job.setup);
  job.linear_solver = take_text(message);
  message.take(job.tolerance);
  message.take(job.max_seconds);
  message.take(job.single_precision);
  message.take(job.estimate_mesh_error);
  require_end(message);
  return job;
}

Bytes pack(const ExplorerTask& task) {
  Packer message;
  message.put(task.number);
  message.put(task.transition);
  message.put(task.kept);
  message.put(task.leads_on);
  message.put(task.start.has_value());
  if (task.start) message.put(*task.start);
  return message.take();
}

ExplorerTask unpack_task(const Bytes& bytes) {
  Unpacker message(bytes);
  ExplorerTask task;
  message.take(task.number);
  message.take(task.transition);
  message.take(task.kept);
  message.take(task.leads_on);
  if (message.take<bool>()) task.start = message.take<Configuration>();
  require_end(message);
  return task;
}

Bytes pack(const ExplorerResult& result) {
  Packer message;
  message.put(result.number);
  message.put(result.found);
  put(result.refusal, message);
  put(result.failure, message);
  return message.take();
}

ExplorerResult unpack_result(const Bytes& bytes) {
  Unpacker message(bytes);
  ExplorerResult result;
  message.take(result.number);
  message.take(result.found);
  result.refusal = take_text(message);
  result.failure = take_text(message);
  require_end(message);
  return result;
}

}  // namespace palpate
