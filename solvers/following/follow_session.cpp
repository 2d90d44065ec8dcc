// SPDX-License-Identifier: BSD-3-Clause
#include "following/follow_session.h"

#include <cmath>
#include <utility>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/tangent_solver.h"
#include "exploration/chunk_record.h"
#include "exploration/plan_spaces.h"
#include "exploration/settle.h"
#include "schedule/communicator.h"
#include "state_space/shown_surface.h"

namespace palpate {
namespace {

/// @throws InputError
void require_followable(const PrecomputeOptions& options) {
  validate(options);
  if (!options.contact) {
    throw InputError(
        "A space can be explored around a hand for a rigid tool alone. Choose a tool.");
  }
  if (options.contact->tool.motion == ToolMotion::turned) {
    throw InputError(
        "A space that is explored around a hand holds no tool that is turned freely. Choose the "
        "Motion Translated or Trocar, or the Exploration Whole Space.");
  }
  if (options.intermediate_states > 0) {
    throw InputError(
        "A space that is explored around a hand has no intermediate states. Ask for none.");
  }
}

/// The place at rest of the touchable point that is nearest to where the exploration begins.
/// @throws InputError no touchable point of the surface is in the region.
Vec3 find_begin(const SpaceBody& body, const PrecomputeOptions& options) {
  const ShellOptions& shell = options.contact->shell;
  const Body& of = body.scene->body;
  std::optional<Vec3> nearest;
  for (Index p = 0; p < of.mesh.num_points(); ++p) {
    if (of.touchable[static_cast<std::size_t>(p)] == 0) continue;
    const Vec3 place = place_at_rest(of.mesh, body.at_rest, p);
    if (shell.region && !shell.region(place)) continue;
    if (!nearest || (place - shell.begin_at).norm() < (*nearest - shell.begin_at).norm()) {
      nearest = place;
    }
  }
  if (!nearest) throw_nothing_to_press(options);
  return *nearest;
}

}  // namespace

struct FollowSession::Impl {
  Impl(std::shared_ptr<const Scene> scene, const PrecomputeOptions& asked);

  void open_record();
  /// Keeps targets that were given up, with the last failed attempt, if there was one.
  void keep_given_up();
  /// Keeps what transitions between levels have reached.
  void keep_settled();
  /// Whether something is what was asked for. It may come from a program of another kind.
  [[nodiscard]] bool is_sound(const Transition& asked, const Configuration& found);

  PrecomputeOptions options;
  std::unique_ptr<Communicator> communicator = make_serial_communicator();
  std::vector<SpaceBody> bodies;
  std::unique_ptr<InteractionFactory> tools;
  ExplorerJob job;
  HandMotion first_hand;
  std::unique_ptr<ChunkRecord> record;
  std::unique_ptr<FollowTool> strategy;
  /// The usable configurations, which may be starts, by check-point and level.
  std::map<std::pair<CheckPoint, std::int32_t>, ConfigurationSummary> starts;
  /// Failed transitions whose targets may be reached from another start, with the sums of the
  /// iterations and times of all attempts.
  std::map<CheckPoint, ConfigurationSummary> failed;
  /// The tasks that are under way.
  std::map<std::int64_t, Transition> tasks;
  std::int64_t last_task = 0;
  /// Of the body, as the first configuration has them; −1: there is none yet.
  Eigen::Index num_pressures = -1;
  /// The strategy had nothing to be done when it was last asked.
  bool has_nothing_left = false;
  Figures figures;
};

FollowSession::Impl::Impl(std::shared_ptr<const Scene> scene, const PrecomputeOptions& asked)
    : options(asked) {
  require_followable(asked);
  SpaceBody& body = bodies.emplace_back();
  body.scene = std::move(scene);
  body.hash = hash(*body.scene);
  if (body.scene->has_load()) {
    const EquilibriumSolver solver(*body.scene, exploring(options),
                                   make_tangent_solver(options.linear_solver, *body.scene));
    body.at_rest = settle(*body.scene, solver, options.file, *communicator);
  }
  RigidTool& tool = options.contact->tool;
  if (has_earlier_layer(*body.scene, options)) tool = with_earlier_layer(tool, *body.scene);
  const Vec3 begin = find_begin(body, options);
  tools = std::make_unique<InteractionFactory>(body.scene->body, body.at_rest);
  job.scene = body.scene;
  job.at_rest = body.at_rest;
  job.setup = plan_tool(body, options, *tools);
  job.linear_solver = options.linear_solver;
  job.tolerance = options.equilibrium.tolerance;
  job.max_seconds = options.equilibrium.max_seconds;
  job.single_precision = options.equilibrium.single_precision;
  job.estimate_mesh_error = options.estimate_mesh_error;
  const auto clearance = tools->clearance(job.setup.interaction);
  first_hand.place = clearance->pressed(begin, clearance->approach(begin).out, 0);
  open_record();
}

void FollowSession::Impl::open_record() {
  const std::vector<ToolSpaceSetup> setups{job.setup};
  auto kept = options.file.empty()
                  ? make_memory_record(bodies, setups, *communicator)
                  : make_file_record(options.file, bodies, setups, options.equilibrium.tolerance,
                                     options.keep, options.touch_bound, *communicator);
  record = std::make_unique<ChunkRecord>(
      std::move(kept), bodies, [this](BodyId /*body*/) -> InteractionFactory& { return *tools; },
      setups, options.touch_bound, *communicator);
  strategy = std::make_unique<FollowTool>(job.setup, tools->clearance(job.setup.interaction),
                                          job.scene->body.touchable, options.contact->shell);
  const Known known = record->known(job.setup.key());
  for (const ConfigurationSummary& found : known.configurations) {
    strategy->recall(found);
    if (found.usable()) starts.emplace(std::pair(found.check_point, found.level), found);
  }
  for (const LevelTransition& transition : known.transitions) strategy->recall(transition);
}

void FollowSession::Impl::keep_given_up() {
  for (const CheckPoint& target : strategy->given_up()) {
    const auto last = failed.find(target);
    if (last == failed.end()) continue;
    record->keep(job.setup.key(), {last->second, {}, {}, {}, {}}, {});
    failed.erase(last);
  }
}

void FollowSession::Impl::keep_settled() {
  const ToolSpaceKey key = job.setup.key();
  for (const Settlement& settlement : strategy->settled()) {
    const LevelTransition& transition = settlement.transition;
    record->keep(key, transition);
    if (!settlement.has_candidate) continue;
    const std::int32_t level =
        candidate_level(transition.start, transition.start_level, transition.target);
    const ConfigurationSummary candidate = starts.extract({transition.target, level}).mapped();
    record->settle(key, candidate, settlement.is_new ? transition.reached : failed_to_reach);
    if (!settlement.is_new) continue;
    ConfigurationSummary& found = starts[{transition.target, transition.reached}];
    found = candidate;
    found.level = transition.reached;
  }
}

bool FollowSession::Impl::is_sound(const Transition& asked, const Configuration& found) {
  if (found.check_point != asked.target || found.level != level_of(asked) ||
      found.parent != asked.start || found.parent_level != asked.start_level) {
    return false;
  }
  if (found.outcome < Outcome::converged || found.outcome > Outcome::tool_inside) return false;
  if (!found.usable()) return true;
  const Vec3 place = job.setup.grid.place(asked.target);
  if (!found.force.allFinite() || !found.stiffness.allFinite() || !std::isfinite(found.energy) ||
      (found.t - place).norm() > 1e-9 * (1 + place.norm())) {
    return false;
  }
  const Eigen::Index size = 3 * Eigen::Index{job.scene->body.mesh.num_points()};
  if (found.u.size() == 0) return (found.flags & flags::touches_nothing) != 0;
  if (num_pressures < 0) num_pressures = found.p.size();
  return found.u.size() == size && found.v.rows() == size && found.v.cols() == 3 &&
         found.p.size() == num_pressures && found.p_v.rows() == num_pressures &&
         (num_pressures == 0 || found.p_v.cols() == 3) && found.u.allFinite() &&
         found.v.allFinite() && found.p.allFinite() && found.p_v.allFinite();
}

FollowSession::FollowSession(std::shared_ptr<const Scene> scene, const PrecomputeOptions& options)
    : impl_(std::make_unique<Impl>(std::move(scene), options)) {}

FollowSession::~FollowSession() = default;

const ExplorerJob& FollowSession::job() const { return impl_->job; }

const SpaceBody& FollowSession::body() const { return impl_->bodies.front(); }

TouchSpace FollowSession::empty_space() const {
  return make_empty_touch_space(ShownSurface(impl_->bodies));
}

const HandMotion& FollowSession::first_hand() const { return impl_->first_hand; }

bool FollowSession::has_found() const { return !impl_->starts.empty(); }

void FollowSession::follow(const HandPrediction& hand) {
  impl_->strategy->follow(hand);
  impl_->has_nothing_left = false;
}

std::optional<ExplorerTask> FollowSession::next() {
  const std::optional<Transition> transition = impl_->strategy->next();
  impl_->keep_given_up();
  impl_->keep_settled();
  impl_->has_nothing_left = !transition;
  if (!transition) return std::nullopt;
  ExplorerTask task;
  task.number = ++impl_->last_task;
  task.transition = *transition;
  // Levels are told apart by their inertia too, which takes a factor.
  task.leads_on = transition->finds_candidate || impl_->strategy->leads_on(transition->target);
  impl_->tasks.emplace(task.number, *transition);
  if (transition->needs_no_start()) return task;
  try {
    const ConfigurationSummary& start =
        impl_->starts.at({transition->start, transition->start_level});
    task.start = load(start);
    task.kept = kept(start);
  } catch (...) {
    lose(task.number);
    throw;
  }
  return task;
}

bool FollowSession::accept(const ExplorerResult& result) {
  const auto task = impl_->tasks.find(result.number);
  if (task == impl_->tasks.end()) return true;
  if (!result.refusal.empty()) throw InputError(result.refusal);
  const Configuration& found = result.found;
  if (!impl_->is_sound(task->second, found)) {
    lose(result.number);
    return false;
  }
  if (found.outcome == Outcome::aborted) {
    lose(result.number);
    return true;
  }
  if (found.usable()) {
    impl_->record->keep(impl_->job.setup.key(), found, {});
    impl_->starts.emplace(std::pair(found.check_point, found.level), found);
    if (found.level == 0) impl_->failed.erase(found.check_point);
  } else if (found.level == 0) {
    ConfigurationSummary& failed = impl_->failed[found.check_point];
    const std::int32_t iterations = failed.iterations;
    const double seconds = failed.seconds;
    failed = found;
    failed.iterations += iterations;
    failed.seconds += seconds;
  }
  impl_->tasks.erase(task);
  impl_->has_nothing_left = false;
  ++impl_->figures.num_solved;
  impl_->figures.seconds += found.seconds;
  impl_->strategy->accept(found);
  return true;
}

void FollowSession::lose(std::int64_t task) {
  const auto lost = impl_->tasks.find(task);
  if (lost == impl_->tasks.end()) return;
  impl_->strategy->lose(lost->second);
  impl_->has_nothing_left = false;
  impl_->tasks.erase(lost);
}

std::optional<SpaceChunk> FollowSession::take_chunk() { return impl_->record->take(); }

Configuration FollowSession::load(const ConfigurationSummary& summary) const {
  return impl_->record->load(impl_->job.setup.key(), summary);
}

Keep FollowSession::kept(const ConfigurationSummary& summary) const {
  return impl_->record->kept(impl_->job.setup.key(), summary);
}

FollowSession::Figures FollowSession::figures() const {
  Figures figures = impl_->figures;
  figures.coverage = impl_->strategy->coverage();
  figures.num_under_way = static_cast<std::int64_t>(impl_->tasks.size());
  figures.is_complete = impl_->has_nothing_left && impl_->tasks.empty();
  return figures;
}

TouchSpace FollowSession::finish() {
  return impl_->record->finish(false, impl_->options.touch_bound);
}

}  // namespace palpate
