// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/precompute.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "exploration/layered_grid.h"
#include "schedule/batch.h"
#include "state_space/pod.h"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;
using States = std::map<std::pair<Index, CheckPoint>, Configuration>;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A configuration as bytes, between ranks of one run: its figures, then u, then v.

Bytes to_bytes(const Configuration& c) {
  const ConfigurationSummary& summary = c;
  const auto u_bytes = static_cast<std::size_t>(c.u.size()) * sizeof(double);
  const auto v_bytes = static_cast<std::size_t>(c.v.size()) * sizeof(double);
  Bytes bytes(sizeof summary + u_bytes + v_bytes);
  std::memcpy(bytes.data(), static_cast<const void*>(&summary), sizeof summary);
  std::memcpy(bytes.data() + sizeof summary, c.u.data(), u_bytes);
  std::memcpy(bytes.data() + sizeof summary + u_bytes, c.v.data(), v_bytes);
  return bytes;
}

Configuration from_bytes(const Bytes& bytes, Index num_points) {
  Configuration c;
  ConfigurationSummary& summary = c;
  std::memcpy(static_cast<void*>(&summary), bytes.data(), sizeof summary);
  c.u.resize(3 * num_points);
  c.v.resize(3 * num_points, 3);
  const auto u_bytes = static_cast<std::size_t>(c.u.size()) * sizeof(double);
  std::memcpy(c.u.data(), bytes.data() + sizeof summary, u_bytes);
  std::memcpy(c.v.data(), bytes.data() + sizeof summary + u_bytes, 3 * u_bytes);
  return c;
}

Equilibrium to_equilibrium(const Configuration& c) {
  Equilibrium e;
  e.t = c.t;
  e.u = c.u;
  e.v = c.v;
  e.energy = c.energy;
  e.reaction = c.force;
  e.stiffness = c.stiffness;
  e.outcome = c.outcome;
  e.flags = c.flags;
  e.residual = c.residual;
  e.minimum_det_f = c.minimum_det_f;
  e.negative_pivots = c.negative_pivots;
  return e;
}

Configuration to_configuration(Equilibrium&& e, const Site& site, const Transition& transition,
                               const CheckPoint& parent) {
  Configuration c;
  c.check_point = transition.target;
  c.parent = parent;
  c.t = e.t;
  c.energy = e.energy;
  c.force = e.reaction;
  c.stiffness = e.stiffness;
  c.outcome = e.outcome;
  c.flags = e.flags;
  if (site.force_limit > 0 && c.force.norm() > site.force_limit) {
    c.flags |= flags::beyond_force_limit;
  }
  c.residual = e.residual;
  c.minimum_det_f = e.minimum_det_f;
  c.negative_pivots = e.negative_pivots;
  c.iterations = e.iterations;
  c.seconds = e.seconds;
  c.u = std::move(e.u);
  c.v = std::move(e.v);
  return c;
}

std::vector<Site> make_sites(const Scene& scene, const PrecomputeOptions& options) {
  std::vector<Index> nodes = options.active_nodes;
  if (nodes.empty()) {
    for (Index p = 0; p < scene.mesh.num_points(); ++p) {
      if (scene.touchable[p] != 0 && scene.fixed[p] == 0) nodes.push_back(p);
    }
    if (nodes.empty()) {
      throw InputError("No point of the body is touchable. Choose touchable points with Set "
                       "Boundary or name active nodes.");
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  const std::vector<char> on_boundary = boundary_points(scene.mesh);
  std::vector<Site> sites;
  for (Index node : nodes) {
    if (node >= 0 && node < scene.mesh.num_points() && on_boundary[node] == 0) {
      throw InputError("Active node " + std::to_string(node) + " is inside the body, where nothing "
                       "can touch it. Choose a point of the surface.");
    }
    sites.push_back({node, options.half_width, options.resolution, options.force_limit});
  }
  return sites;
}

/// Reports progress, and knows whether to go on.
class Monitor {
 public:
  Monitor(Progress progress, int num_ranks) : progress_(std::move(progress)), num_ranks_(num_ranks) {}

  void expect(std::int64_t num_configurations) { num_expected_ = num_configurations; }
  void solved_one() { ++num_done_here_; }
  /// What all ranks have done is known.
  void set_done(std::int64_t num_configurations) {
    num_done_ = num_configurations;
    num_done_here_ = 0;
  }

  /// False once an abort was asked for.
  bool go_on() {
    if (stopped_ || !progress_) return !stopped_;
    const auto done = static_cast<double>(num_done_ + num_done_here_ * num_ranks_);
    stopped_ = !progress_(std::min(1.0, done / static_cast<double>(num_expected_)));
    return !stopped_;
  }

 private:
  Progress progress_;
  int num_ranks_;
  std::int64_t num_expected_ = 1;
  std::int64_t num_done_ = 0;
  /// On this rank, in the batch that is being made.
  std::int64_t num_done_here_ = 0;
  bool stopped_ = false;
};

EquilibriumOptions with_abort(EquilibriumOptions options, Monitor& monitor) {
  const auto asked = std::move(options.abort_requested);
  options.abort_requested = [&monitor, asked] { return !monitor.go_on() || (asked && asked()); };
  return options;
}

/// Makes the transitions of one run.
class Engine {
 public:
  Engine(Index num_points, const std::vector<Site>& sites, EquilibriumSolver& solver,
         Record& record, Communicator& communicator, Monitor& monitor)
      : num_points_(num_points),
        solver_(solver),
        record_(record),
        communicator_(communicator),
        monitor_(monitor) {
    for (const Site& site : sites) site_of_node_[site.active_node] = site;
  }

  /// @returns false when it was aborted.
  bool explore(Frontier& frontier, PrecomputeReport& report) {
    monitor_.expect(frontier.num_expected());
    for (;;) {
      const std::vector<Transition> batch = frontier.next();
      if (batch.empty()) return true;
      const std::vector<char> known = find_known(batch);
      const std::vector<int> owners = share_out(known);
      const std::vector<Bytes> results =
          run_batch(communicator_, owners, [&](std::int64_t i) -> Bytes {
            if (known[i] != 0) return to_bytes(record_.load(batch[i].active_node, batch[i].target));
            return make(batch[i]);
          });
      const bool aborted = std::any_of(results.begin(), results.end(),
                                       [](const Bytes& result) { return result.empty(); });
      take_in(batch, known, results, frontier, report);
      if (any(communicator_, aborted || !monitor_.go_on())) return false;
    }
  }

 private:
  /// Which targets of a batch are in the record, as rank 0 knows it.
  std::vector<char> find_known(const std::vector<Transition>& batch) {
    Bytes mine;
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      for (const Transition& transition : batch) {
        mine.push_back(std::byte{record_.contains(transition.active_node, transition.target)});
      }
    });
    const Bytes of_rank_0 = communicator_.all_gather(mine).front();
    std::vector<char> known;
    for (const std::byte one : of_rank_0) known.push_back(std::to_integer<char>(one));
    return known;
  }

  /// What is known is loaded by rank 0; of the others each rank solves a run of neighbours.
  [[nodiscard]] std::vector<int> share_out(const std::vector<char>& known) const {
    const std::int64_t num_unknown = std::count(known.begin(), known.end(), 0);
    std::vector<int> owners;
    std::int64_t next = 0;
    for (const char is_known : known) {
      owners.push_back(
          is_known != 0 ? 0 : static_cast<int>(next++ * communicator_.size() / num_unknown));
    }
    return owners;
  }

  /// Solves a transition and keeps the result; empty when it was aborted.
  Bytes make(const Transition& transition) {
    if (!monitor_.go_on()) return {};
    const Site& site = site_of_node_.at(transition.active_node);
    if (held_node_ != site.active_node) {
      solver_.hold(hold_nodes({site.active_node}));
      held_node_ = site.active_node;
    }
    const Configuration found =
        transition.starts.empty() ? rest(site, transition) : reach(site, transition);
    if (found.outcome == Outcome::aborted) return {};
    record_.keep(site.active_node, found);
    monitor_.solved_one();
    return to_bytes(found);
  }

  /// @throws InputError the body is not held.
  Configuration rest(const Site& site, const Transition& transition) {
    Equilibrium e = solver_.rest();
    if (e.outcome != Outcome::converged) throw InputError(e.message);
    return to_configuration(std::move(e), site, transition, transition.target);
  }

  /// Tries one start after the other.
  Configuration reach(const Site& site, const Transition& transition) {
    const auto& [i, j, k] = transition.target;
    const Eigen::VectorXd t = site.spacing() * Vec3(i, j, k);
    Configuration found;
    for (const CheckPoint& start : transition.starts) {
      const int earlier_iterations = found.iterations;
      const double earlier_seconds = found.seconds;
      Equilibrium e = solver_.solve(t, to_equilibrium(states_.at({site.active_node, start})));
      found = to_configuration(std::move(e), site, transition, start);
      found.iterations += earlier_iterations;
      found.seconds += earlier_seconds;
      if (found.outcome == Outcome::converged || found.outcome == Outcome::aborted) break;
    }
    return found;
  }

  /// Takes in what all ranks found for a batch.
  void take_in(const std::vector<Transition>& batch, const std::vector<char>& known,
               const std::vector<Bytes>& results, Frontier& frontier, PrecomputeReport& report) {
    states_.clear();
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (results[i].empty()) continue;
      const Index node = batch[i].active_node;
      Configuration configuration = from_bytes(results[i], num_points_);
      if (communicator_.rank() == 0) record_.share(node, configuration);
      frontier.accept(node, configuration);
      count(configuration, known[i] != 0, report);
      states_.emplace(std::pair(node, batch[i].target), std::move(configuration));
    }
    monitor_.set_done(report.num_solved + report.num_reused);
  }

  static void count(const Configuration& found, bool reused, PrecomputeReport& report) {
    ++(reused ? report.num_reused : report.num_solved);
    ++report.num_by_outcome[found.outcome];
    if (!reused) report.iterations += found.iterations;
    for (Flags bit = 1; bit <= flags::inertia_not_computed; bit *= 2) {
      if ((found.flags & bit) != 0) ++report.num_by_flag[bit];
    }
  }

  Index num_points_;
  EquilibriumSolver& solver_;
  Record& record_;
  Communicator& communicator_;
  Monitor& monitor_;
  std::map<Index, Site> site_of_node_;
  Index held_node_ = -1;
  /// What the last batch found: the starts of this one.
  States states_;
};

/// Sites that are explored together so that no rank is idle in the first layer of 26 check-points.
int sites_to_occupy(int num_ranks) { return (4 * num_ranks + 25) / 26; }

/// Sum over the ranks.
Work total(const Work& mine, Communicator& communicator) {
  static_assert(std::is_trivially_copyable_v<Work>);
  Bytes bytes(sizeof mine);
  std::memcpy(bytes.data(), &mine, sizeof mine);
  Work sum;
  for (const Bytes& one : communicator.all_gather(bytes)) {
    Work work;
    std::memcpy(&work, one.data(), sizeof work);
    sum += work;
  }
  return sum;
}

}  // namespace

void validate(const PrecomputeOptions& options) {
  if (!(std::isfinite(options.half_width) && options.half_width > 0)) {
    throw InputError("The half-width is " + std::to_string(options.half_width) +
                     "; it must be a positive length in m.");
  }
  if (options.resolution < 3 || options.resolution % 2 == 0 ||
      options.resolution > kLargestResolution) {
    throw InputError("The resolution is " + std::to_string(options.resolution) +
                     "; it must be odd, so that the rest position is a check-point, and from 3 to " +
                     std::to_string(kLargestResolution) + '.');
  }
  if (!(std::isfinite(options.force_limit) && options.force_limit >= 0)) {
    throw InputError("The force limit is " + std::to_string(options.force_limit) +
                     "; it must be a force in N, or 0 for none.");
  }
  if (!(options.touch_bound >= kLeastPodBound && options.touch_bound < 1)) {
    throw InputError("The displacement bound is " + std::to_string(options.touch_bound) +
                     "; it must be a share from 0.00001 to below 1.");
  }
  validate(options.equilibrium);
}

PrecomputeResult precompute(const Scene& scene, const PrecomputeOptions& options,
                            Communicator& communicator, const Progress& progress) {
  PrecomputeResult result;
  PrecomputeReport& report = result.report;
  const Clock::time_point start = Clock::now();
  Monitor monitor(progress, communicator.size());
  std::vector<Site> sites;
  std::unique_ptr<EquilibriumSolver> solver;
  agree(communicator, [&] {
    validate(options);
    solver = std::make_unique<EquilibriumSolver>(
        scene, with_abort(options.equilibrium, monitor),
        options.linear_solver.empty() ? make_linear_solver()
                                      : make_linear_solver(options.linear_solver));
    sites = make_sites(scene, options);
    // Every node must be one that can be held, before a file is touched.
    for (const Site& site : sites) solver->hold(hold_nodes({site.active_node}));
  });
  const double tolerance = options.equilibrium.tolerance;
  const std::unique_ptr<Record> record =
      options.file.empty()
          ? make_memory_record(scene, sites, tolerance, communicator)
          : make_file_record(options.file, scene, sites, tolerance, communicator);

  LayeredGrid frontier(sites, sites_to_occupy(communicator.size()));
  Engine engine(scene.mesh.num_points(), sites, *solver, *record, communicator, monitor);
  report.complete = engine.explore(frontier, report);
  report.exploration_seconds = seconds_since(start);

  const Clock::time_point finish_start = Clock::now();
  result.space = record->finish(report.complete, options.touch_bound);
  report.finishing_seconds = seconds_since(finish_start);
  report.num_ranks = communicator.size();
  report.num_cells = scene.mesh.num_cells();
  report.num_unknowns = solver->assembly().pattern().size - 3;
  report.num_not_reached = frontier.num_expected() - report.num_solved - report.num_reused;
  report.work = total(solver->work(), communicator);
  return result;
}

}  // namespace palpate
