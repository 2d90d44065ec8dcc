// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/precompute.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "exploration/engine.h"
#include "exploration/monitor.h"
#include "exploration/record.h"
#include "exploration/transfer.h"
#include "interaction/interaction_spec.h"
#include "interpolation/error_estimate.h"
#include "linear/group.h"
#include "state_space/pod.h"

namespace palpate {
namespace {

/// Cells are halved this often at the most.
constexpr int kMaxDepth = 6;

/// Side of the coarsest cells of a rigid tool's space where it is not given, in half-widths of the
/// tool.
constexpr double kSpacingOfRadius = 0.4;
/// How many configurations more than the first round a tolerance takes, about: what the liver took
/// for 0.1 %.
constexpr double kMoreByTolerance = 3;
/// What the error of a cell is in one of its halves at the most where halving helps: it falls to an
/// eighth or less where the force is smooth, and where contact begins.
constexpr double kShrinks = 1.0 / 3;
/// A step onto another branch, as at a ridge, is halved this often before the body jumps. What it
/// jumps to is the same after eight halvings, in three times the time.
constexpr int kMostHalvingsOfStep = 3;
/// From so many places the time of a configuration is estimated.
constexpr std::size_t kTrials = 3;
/// A configuration without fields, in a file.
constexpr double kSummaryBytes = 512;

/// Makes the grid of a tool space that of the smallest cells that a tolerance may ask for.
void refine(const PrecomputeOptions& options, ToolSpaceSetup& setup) {
  setup.policy.tolerance = options.tolerance;
  setup.policy.tolerance_is_relative = options.tolerance_is_relative;
  setup.policy.history = History::flat;
  for (int depth = 0; depth < kMaxDepth; ++depth) {
    const std::int32_t finer = 2 * setup.grid.resolution - 1;
    if (finer > kLargestResolution) break;
    setup.grid.resolution = finer;
    setup.grid.coarsest *= 2;
  }
}

/// What the policies of all tool spaces have in common.
ExplorationPolicy policy_of(const PrecomputeOptions& options) {
  ExplorationPolicy policy;
  policy.force_limit = options.force_limit;
  policy.history = options.history;
  policy.intermediate_states = options.intermediate_states;
  policy.third_derivatives = options.equilibrium.third_derivatives;
  return policy;
}

/// @throws InputError a node where the tool cannot be.
std::vector<PlannedSpace> plan_grids(const Scene& scene, const PrecomputeOptions& options) {
  std::vector<Index> nodes = options.active_nodes;
  if (nodes.empty()) {
    for (Index p = 0; p < scene.mesh.num_points(); ++p) {
      if (scene.touchable[p] != 0 && scene.fixed[p] == 0) nodes.push_back(p);
    }
    if (nodes.empty()) {
      throw InputError(
          "No point of the body is touchable. Choose touchable points with Set "
          "Boundary or name active nodes.");
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  const BondedPatches patches(scene, options.tip_radius);
  std::vector<PlannedSpace> spaces;
  for (const Index node : nodes) {
    (void)patches.around(node);
    ToolSpaceSetup setup;
    setup.id = node;
    setup.interaction = bonded_patch_spec(scene, node, options.tip_radius);
    setup.grid.half_width = options.half_width;
    setup.grid.resolution = options.resolution;
    setup.policy = policy_of(options);
    if (options.tolerance > 0) refine(options, setup);
    spaces.push_back({setup, make_grid_plan(setup)});
  }
  return spaces;
}

/// @throws InputError a tool that is none, or that there is nothing to press with.
std::vector<PlannedSpace> plan_shell(const Scene& scene, const PrecomputeOptions& options,
                                     InteractionFactory& tools) {
  const ContactOptions& contact = *options.contact;
  ToolSpaceSetup setup;
  setup.id = kContactToolSpace;
  setup.interaction = rigid_contact_spec(with_defaults(contact.tool, scene));
  const std::shared_ptr<const ToolClearance> clearance = tools.clearance(setup.interaction);
  const double width = half_width(setup.interaction.tool);
  const double spacing = contact.spacing > 0 ? contact.spacing : kSpacingOfRadius * width;
  if (spacing > 2 * width) {
    throw InputError("The spacing is " + std::to_string(spacing) + " m, larger than the tool of " +
                     std::to_string(2 * width) +
                     " m: most contacts would lie between the places "
                     "that are computed. Take a quarter of the tool's size or less.");
  }
  setup.grid = make_shell_grid(*clearance, spacing);
  setup.policy = policy_of(options);
  setup.policy.history = History::flat;
  setup.policy.tolerance = options.tolerance;
  setup.policy.tolerance_is_relative = options.tolerance_is_relative;
  setup.policy.depth = contact.shell.depth;
  auto graph = std::make_shared<const StartGraph>(
      setup.id, shell_targets(*clearance, setup.grid, scene.touchable, contact.shell));
  return {{setup, std::move(graph)}};
}

/// What is expected of the first round of a shell, and with a tolerance of those after it too.
/// @throws InputError more configurations are to be expected than are allowed.
ExplorationEstimate estimate_shell(const PrecomputeOptions& options, const PlannedSpace& space,
                                   const StartGraph& graph, StateSolver& solver,
                                   const Assembly& assembly, int num_ranks) {
  ExplorationEstimate estimate;
  std::vector<CheckPoint> from_none;
  for (const StartGraph::Target& target : graph.targets()) {
    ++(target.is_free ? estimate.num_free : estimate.num_configurations);
    const bool begins = !target.starts.empty() && target.starts.front() == target.check_point;
    if (begins && !target.is_free) from_none.push_back(target.check_point);
  }
  const double more = options.tolerance > 0 ? kMoreByTolerance : 1;
  estimate.num_configurations =
      std::llround(more * static_cast<double>(estimate.num_configurations));
  estimate.num_free = std::llround(more * static_cast<double>(estimate.num_free));
  const auto number = static_cast<double>(estimate.num_configurations);
  // u and v, p and p_v; in a file of single precision.
  const double numbers = 4 * static_cast<double>(assembly.state_size());
  const double with_fields = numbers * sizeof(float) + kSummaryBytes;
  estimate.file_bytes =
      number * with_fields + kSummaryBytes * static_cast<double>(estimate.num_free);
  estimate.bytes_per_rank =
      number * (options.file.empty() ? (numbers * sizeof(double) + kSummaryBytes) / num_ranks
                                     : sizeof(ConfigurationSummary));
  if (estimate.num_configurations > options.contact->most_configurations) {
    throw InputError(
        "The space would have about " + std::to_string(estimate.num_configurations) +
        " configurations and take " + std::to_string(std::llround(estimate.file_bytes / 1e6)) +
        " MB; at most " + std::to_string(options.contact->most_configurations) +
        " are allowed. Take a larger spacing, less depth or a smaller region, or allow "
        "more.");
  }
  // Trials take a while.
  if (!options.expects) return estimate;
  double seconds = 0;
  const std::size_t trials = std::min(kTrials, from_none.size());
  for (std::size_t i = 0; i < trials; ++i) {
    const CheckPoint& p = from_none[(2 * i + 1) * from_none.size() / (2 * trials)];
    seconds += solver.begin(space.setup, space.setup.grid.place(p), Tangent::factorised).seconds;
  }
  if (trials > 0) estimate.seconds = seconds / static_cast<double>(trials) * number / num_ranks;
  return estimate;
}

EquilibriumOptions solver_options(const PrecomputeOptions& options, Monitor& monitor) {
  EquilibriumOptions result = options.equilibrium;
  // Depth first, the starts on the way down keep their factors beside those of a step.
  result.follow_folds = false;
  if (options.contact) result.max_halvings = std::min(result.max_halvings, kMostHalvingsOfStep);
  result.kept_factors =
      num_kept_factors(options.contact ? kShellLayers : (options.resolution - 1) / 2);
  result.abort_requested = [&monitor, asked = options.equilibrium.abort_requested] {
    return !monitor.go_on() || (asked && asked());
  };
  return result;
}

/// Who solves together with whom.
struct Groups {
  Groups(Communicator& all, int ranks_per_solve) {
    const int last = all.size() / ranks_per_solve - 1;
    own = all.split(std::min(all.rank() / ranks_per_solve, last));
    leaders = all.split(leads() ? 0 : 1);
  }
  [[nodiscard]] bool leads() const { return own->rank() == 0; }

  std::unique_ptr<Communicator> own;
  /// On those that lead.
  std::unique_ptr<Communicator> leaders;
};

/// @throws InputError
void validate_ranks_per_solve(const PrecomputeOptions& options, int num_ranks) {
  const int ranks = options.ranks_per_solve;
  if (ranks < 1 || ranks > num_ranks) {
    throw InputError("The ranks per solve are " + std::to_string(ranks) +
                     "; they must be from 1 to the number of ranks, " + std::to_string(num_ranks) +
                     '.');
  }
  const std::string solver =
      options.linear_solver.empty() ? linear_solver_names().front() : options.linear_solver;
  if (ranks > 1 && solver != "MUMPS") {
    throw InputError("The ranks per solve are " + std::to_string(ranks) +
                     "; with the linear solver " + solver + " there can be 1 alone.");
  }
}

/// Adds what another rank has to what one has.
template <class T>
void add(T& all, const T& one) {
  all += one;
}
template <class Key>
void add(std::map<Key, std::int64_t>& all, const std::map<Key, std::int64_t>& one) {
  for (const auto& [key, number] : one) all[key] += number;
}

/// Calls visit(figure, combine) for each figure of a report that the ranks combine, where
/// combine(all, one) takes in that of one more.
template <class Visit>
void for_each_figure(PrecomputeReport& report, Visit&& visit) {
  constexpr auto sum = [](auto& all, const auto& one) { add(all, one); };
  constexpr auto largest = [](auto& all, const auto& one) { all = std::max(all, one); };
  visit(report.num_solved, sum);
  visit(report.num_reused, sum);
  visit(report.num_by_outcome, sum);
  visit(report.num_by_flag, sum);
  visit(report.num_expected, sum);
  visit(report.num_transitions, sum);
  visit(report.num_levels, sum);
  visit(report.num_beyond_most_levels, sum);
  visit(report.iterations, sum);
  visit(report.num_states_given, sum);
  visit(report.num_intermediate_states, sum);
  visit(report.num_intermediate_states_failed, sum);
  visit(report.intermediate_seconds, sum);
  visit(report.work, sum);
  visit(report.num_rounds, largest);
  visit(report.complete, largest);
  visit(report.num_unknowns, largest);
  visit(report.exploration_seconds, largest);
  visit(report.finishing_seconds, largest);
}

/// The figures of a report.
Bytes packed(PrecomputeReport& report) {
  Packer figures;
  for_each_figure(report, [&](auto& figure, auto /*combine*/) { figures.put(figure); });
  return figures.take();
}

void take_in(PrecomputeReport& report, const Bytes& figures) {
  Unpacker one(figures);
  for_each_figure(report, [&](auto& figure, auto combine) {
    combine(figure, one.take<std::decay_t<decltype(figure)>>());
  });
}

/// Combines what each rank has; the ranks that serve others have nothing.
void combine(PrecomputeReport& report, Communicator& communicator) {
  const Bytes mine = packed(report);
  for_each_figure(report, [](auto& figure, auto /*combine*/) { figure = {}; });
  for (const Bytes& figures : communicator.all_gather(mine)) take_in(report, figures);
  report.schedule = sum(communicator, report.schedule);
  report.num_not_reached = report.num_expected - report.num_solved - report.num_reused;
}

/// The rounds in which cells of a rigid tool's space are halved. Every rank plans the same.
class ShellRounds {
 public:
  ShellRounds(PlannedSpace& space, const ToolClearance& clearance, const Vec3& begin_at)
      : space_(space), clearance_(clearance), begin_at_(begin_at) {
    take(static_cast<const StartGraph&>(*space.plan));
  }

  /// Plans the next round, after one that is complete.
  /// @returns false: there is none.
  /// @note Collective
  bool plan(Engine& engine, Communicator& communicator, PrecomputeReport& report) {
    gather_known(engine, communicator);
    bool goes_on = false;
    agree(communicator, [&] {
      const ToolSpaceSetup& setup = space_.setup;
      // What earlier runs have left of rounds to come does not count yet.
      std::map<CheckPoint, ConfigurationSummary> known;
      std::vector<ConfigurationSummary> found;
      for (const auto& [p, c] : known_) {
        if (asked_.count(p) == 0) continue;
        known.emplace(p, c);
        found.push_back(c);
      }
      const double tolerance = force_tolerance(setup.policy, found);
      if (!(tolerance > 0)) return;
      const Clearance clearance = [&](const Vec3& q) { return clearance_.clearance(q); };
      const Refinement refinement =
          plan_refinement(setup.grid, found, tolerance, 1, clearance,
                          [&](const CellEstimate& estimate) { return is_in_vain(estimate); });
      for (const CellEstimate& e : refinement.estimates) errors_[e.cell] = e.error;
      auto graph = std::make_shared<const StartGraph>(
          setup.id, refined_targets(clearance_, setup.grid, refinement.to_split, known, begin_at_));
      if (graph->targets().empty()) return;
      take(*graph);
      space_.plan = std::move(graph);
      engine.plan_anew();
      report.num_rounds = ++num_rounds_;
      goes_on = true;
    });
    return goes_on;
  }

 private:
  /// Whether halving has not helped: between the branches at a ridge it does not.
  [[nodiscard]] bool is_in_vain(const CellEstimate& estimate) const {
    const auto before = errors_.find(parent_of(estimate.cell, space_.setup.grid.reach()));
    return before != errors_.end() && !(estimate.error < kShrinks * before->second);
  }

  void take(const StartGraph& graph) {
    for (const StartGraph::Target& target : graph.targets()) asked_.insert(target.check_point);
  }

  /// @note Collective
  void gather_known(const Engine& engine, Communicator& communicator) {
    const std::vector<ConfigurationSummary>& here = engine.known_here(space_.setup.id);
    Packer mine;
    mine.put_list(std::vector<ConfigurationSummary>(
        here.begin() + static_cast<std::ptrdiff_t>(num_told_), here.end()));
    num_told_ = here.size();
    for (const Bytes& bytes : communicator.all_gather(mine.take())) {
      for (const auto& c : Unpacker(bytes).take_list<std::vector<ConfigurationSummary>>()) {
        known_[c.check_point] = c;
      }
    }
  }

  PlannedSpace& space_;
  const ToolClearance& clearance_;
  Vec3 begin_at_;
  /// Of the rounds so far.
  std::set<CheckPoint> asked_;
  std::map<CheckPoint, ConfigurationSummary> known_;
  /// The estimates of all cells so far, also of those that were split.
  std::map<Cell, double> errors_;
  std::size_t num_told_ = 0;
  int num_rounds_ = 0;
};

/// On ranks that solve.
/// @param make_solver Is called first: ranks may have begun to serve what it makes.
PrecomputeResult explore(const Scene& scene, const PrecomputeOptions& options,
                         Communicator& communicator, const Progress& progress,
                         const std::function<std::unique_ptr<LinearSolver>()>& make_solver) {
  PrecomputeResult result;
  PrecomputeReport& report = result.report;
  const Clock::time_point start = Clock::now();
  Monitor monitor(progress, communicator.network());
  std::vector<PlannedSpace> spaces;
  std::unique_ptr<EquilibriumSolver> solver;
  InteractionFactory tools(scene);
  std::optional<InteractionSolver> state_solver;
  // All that can be wrong, before a file is touched.
  agree(communicator, [&] {
    std::unique_ptr<LinearSolver> linear_solver = make_solver();
    solver = std::make_unique<EquilibriumSolver>(scene, solver_options(options, monitor),
                                                 std::move(linear_solver));
    state_solver.emplace(*solver, tools);
    if (!options.contact) {
      spaces = plan_grids(scene, options);
      return;
    }
    spaces = plan_shell(scene, options, tools);
    if (communicator.rank() != 0) return;
    const PlannedSpace& space = spaces.front();
    const ExplorationEstimate estimate =
        estimate_shell(options, space, static_cast<const StartGraph&>(*space.plan), *state_solver,
                       solver->assembly(), communicator.size());
    if (options.expects) options.expects(estimate);
  });
  std::vector<ToolSpaceSetup> setups;
  for (const PlannedSpace& space : spaces) setups.push_back(space.setup);
  const double tolerance = options.equilibrium.tolerance;
  const std::unique_ptr<Record> record =
      options.file.empty() ? make_memory_record(scene, setups, tolerance, communicator)
                           : make_file_record(options.file, scene, setups, tolerance, communicator);
  result.damaged = record->damaged();

  Engine engine(spaces, *state_solver, *record, communicator.network(), monitor, report);
  std::optional<ShellRounds> rounds;
  if (options.contact && options.tolerance > 0) {
    rounds.emplace(spaces.front(), *tools.clearance(setups.front().interaction),
                   options.contact->shell.begin_at);
  }
  do {
    report.complete = run(engine, communicator, &report.schedule);
    monitor.set_mail(nullptr);
  } while (report.complete && rounds && rounds->plan(engine, communicator, report));
  report.exploration_seconds = seconds_since(start);

  const Clock::time_point finish_start = Clock::now();
  result.space = record->finish(report.complete, options.touch_bound);
  report.finishing_seconds = seconds_since(finish_start);
  const auto held = tools.make(setups.front().interaction)->prescribed_points();
  report.num_unknowns = solver->assembly().pattern().size - 3 * static_cast<Index>(held.size());
  report.work = solver->work();
  return result;
}

/// On all ranks.
/// @note Collective
PrecomputeResult explore_on_ranks(const Scene& scene, const PrecomputeOptions& options,
                                  Communicator& communicator, const Progress& progress) {
  PrecomputeResult result;
  if (options.ranks_per_solve == 1) {
    result = explore(scene, options, communicator, progress, [&] {
      return options.linear_solver.empty() ? make_linear_solver()
                                           : make_linear_solver(options.linear_solver);
    });
  } else {
    const Groups groups(communicator, options.ranks_per_solve);
    const void* group = groups.own->mpi_comm();
    agree(communicator, [&] {
      if (groups.leads()) {
        result = explore(scene, options, *groups.leaders, progress,
                         [group] { return make_group_solver(group); });
      } else {
        serve_group_solver(group);
      }
    });
  }
  return result;
}

PrecomputeOptions without_nodes(const PrecomputeOptions& options) {
  PrecomputeOptions result = options;
  if (options.contact) result.active_nodes.clear();
  return result;
}

PrecomputeOptions without_contact(const PrecomputeOptions& options) {
  PrecomputeOptions result = options;
  result.contact.reset();
  return result;
}

/// Adds what was explored after the rest.
/// @param in_memory Else the file, and so the newer space, has all.
void append(PrecomputeResult& all, PrecomputeResult newer, bool in_memory) {
  PrecomputeReport& report = newer.report;
  // The later of the two says whether anything is left, and each has taken its time.
  report.exploration_seconds += all.report.exploration_seconds;
  report.finishing_seconds += all.report.finishing_seconds;
  all.report.complete = false;
  take_in(report, packed(all.report));
  report.schedule += all.report.schedule;
  const auto put_before = [](auto& list, auto& first) {
    list.insert(list.begin(), std::make_move_iterator(first.begin()),
                std::make_move_iterator(first.end()));
  };
  put_before(newer.damaged, all.damaged);
  if (in_memory) put_before(newer.space.tool_spaces, all.space.tool_spaces);
  all = std::move(newer);
}

}  // namespace

void validate(const PrecomputeOptions& options) {
  if (options.contact) {
    const auto& [tool, spacing, shell, most_configurations] = *options.contact;
    if (!(std::isfinite(spacing) && spacing >= 0)) {
      throw InputError("The spacing is " + std::to_string(spacing) +
                       "; it must be a length in m, or 0 for two fifths of the tool's radius.");
    }
    if (!(std::isfinite(shell.depth) && shell.depth >= 0)) {
      throw InputError("The depth is " + std::to_string(shell.depth) +
                       "; it must be a length in m, or 0 to go as deep as the force limit allows.");
    }
    if (!shell.begin_at.allFinite()) {
      throw InputError("The place where the exploration begins is not finite.");
    }
    if (shell.depth == 0 && options.force_limit == 0) {
      throw InputError(
          "Neither a depth nor a force limit is given: the tool would be pressed "
          "through the body. Set one of them.");
    }
    if (options.intermediate_states > 0 || options.history == History::levels) {
      throw InputError(
          "The space of a rigid tool has no levels or intermediate states. Set History "
          "to another value and IntermediateStates to 0.");
    }
  }
  const bool has_boxes = !options.contact || !options.active_nodes.empty();
  if (has_boxes && !(std::isfinite(options.half_width) && options.half_width > 0)) {
    throw InputError("The half-width is " + std::to_string(options.half_width) +
                     "; it must be a positive length in m.");
  }
  if (options.resolution < 3 || options.resolution % 2 == 0 ||
      options.resolution > kLargestCoarsestResolution) {
    throw InputError(
        "The resolution is " + std::to_string(options.resolution) +
        "; it must be odd, so that the rest position is a check-point, and from 3 to " +
        std::to_string(kLargestCoarsestResolution) + '.');
  }
  if (!(std::isfinite(options.force_limit) && options.force_limit >= 0)) {
    throw InputError("The force limit is " + std::to_string(options.force_limit) +
                     "; it must be a force in N, or 0 for none.");
  }
  if (!(std::isfinite(options.tolerance) && options.tolerance >= 0)) {
    throw InputError(
        "The tolerance is " + std::to_string(options.tolerance) +
        "; it must be a force in N or a share of the largest, or 0 for a uniform grid.");
  }
  if (options.history == History::levels && options.tolerance > 0) {
    throw InputError(
        "Levels are explored on a uniform grid. Choose a resolution instead of a "
        "tolerance, or another history.");
  }
  if (options.intermediate_states < 0 || options.intermediate_states > kMostIntermediateStates) {
    throw InputError("The intermediate states are " + std::to_string(options.intermediate_states) +
                     "; they must be from 0 to " + std::to_string(kMostIntermediateStates) + '.');
  }
  if (!(options.touch_bound >= kLeastPodBound && options.touch_bound < 1)) {
    throw InputError("The displacement bound is " + std::to_string(options.touch_bound) +
                     "; it must be a share from 0.00001 to below 1.");
  }
  validate(options.equilibrium);
}

PrecomputeResult precompute(const Scene& scene, const PrecomputeOptions& options,
                            Communicator& communicator, const Progress& progress) {
  const Clock::time_point start = Clock::now();
  const bool has_both = options.contact && !options.active_nodes.empty();
  agree(communicator, [&] {
    validate(options);
    validate_ranks_per_solve(options, communicator.size());
    // What is wrong with these is not told at the end of the first exploration.
    if (has_both) (void)plan_grids(scene, options);
  });
  PrecomputeResult result = explore_on_ranks(scene, without_nodes(options), communicator, progress);
  if (has_both && any(communicator, result.report.complete)) {
    append(result, explore_on_ranks(scene, without_contact(options), communicator, progress),
           options.file.empty());
  }
  PrecomputeReport& report = result.report;
  report.num_ranks = communicator.size();
  report.num_cells = scene.mesh.num_cells();
  combine(report, communicator);
  if (report.complete && progress) {
    const std::int64_t found = report.num_solved + report.num_reused;
    (void)progress({found, found, report.num_solved, seconds_since(start), 0});
  }
  return result;
}

}  // namespace palpate
