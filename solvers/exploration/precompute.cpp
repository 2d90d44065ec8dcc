// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/precompute.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/own_seconds.h"
#include "equilibrium/tangent_solver.h"
#include "exploration/plan_spaces.h"
#include "linear/group.h"

namespace palpate {
namespace {

/// The ranks, in groups that solve together.
struct Groups {
  Groups(Communicator& all, int ranks_per_solve) {
    const int last = all.size() / ranks_per_solve - 1;
    own = all.split(std::min(all.rank() / ranks_per_solve, last));
    leaders = all.split(leads() ? 0 : 1);
  }
  [[nodiscard]] bool leads() const { return own->rank() == 0; }

  std::unique_ptr<Communicator> own;
  /// The communicator of the ranks that lead a group.
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

ExplorationSession::MakeSolver solver_maker(const Scene& scene, const PrecomputeOptions& options) {
  return [&scene, name = options.linear_solver, threads = options.equilibrium.threads] {
    return name.empty() ? choose_tangent_solver(scene, threads) : make_tangent_solver(name);
  };
}

/// Explores, on the ranks that lead a solve.
PrecomputeResult explore(std::shared_ptr<const Scene> scene, const PrecomputeOptions& options,
                         Communicator& communicator, const Progress& progress,
                         const ExplorationSession::MakeSolver& make_solver) {
  ExplorationSession session(std::move(scene), options, communicator, progress, make_solver);
  session.run();
  return session.finish();
}

/// Explores, on all ranks.
/// @note Collective
PrecomputeResult explore_on_ranks(const std::shared_ptr<const Scene>& scene,
                                  const PrecomputeOptions& options, Communicator& communicator,
                                  const Progress& progress) {
  PrecomputeResult result;
  if (options.ranks_per_solve == 1) {
    result = explore(scene, options, communicator, progress, solver_maker(*scene, options));
  } else {
    const Groups groups(communicator, options.ranks_per_solve);
    const void* group = groups.own->mpi_comm();
    agree(communicator, prepare_group_solver);
    agree(communicator, [&] {
      if (groups.leads()) {
        // Make the solver first: the other ranks already serve it, and if anything fails its
        // destructor releases them.
        auto solver = make_group_solver(group);
        result = explore(scene, options, *groups.leaders, progress,
                         [&solver] { return std::move(solver); });
      } else {
        serve_group_solver(group);
      }
    });
  }
  return result;
}

bool has_both(const PrecomputeOptions& options) {
  return options.contact && !options.active_nodes.empty();
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

/// Adds the results of an earlier exploration to those of a later one.
/// @param in_memory true: the spaces are joined here. false: the file, and so the later result, has
///   all.
void append(PrecomputeResult& all, PrecomputeResult newer, bool in_memory) {
  add_earlier(newer.report, all.report);
  const auto put_before = [](auto& list, auto& first) {
    list.insert(list.begin(), std::make_move_iterator(first.begin()),
                std::make_move_iterator(first.end()));
  };
  put_before(newer.damaged, all.damaged);
  if (in_memory) put_before(newer.space.tool_spaces, all.space.tool_spaces);
  all = std::move(newer);
}

/// Checks the options, and replaces those that depend on the ranks and on the file.
/// @note Collective
PrecomputeOptions resolved(const Scene& scene, const PrecomputeOptions& asked,
                           Communicator& communicator) {
  agree(communicator, [&] {
    validate(asked);
    validate_ranks_per_solve(asked, communicator.size());
    // Check the active nodes now, and not after the first exploration.
    if (has_both(asked)) (void)plan_grids(scene, asked);
  });
  PrecomputeOptions options = asked;
  options.equilibrium.threads = num_threads(communicator, asked.equilibrium.threads);
  if (asked.contact) {
    bool is_earlier = false;
    agree(communicator,
          [&] { is_earlier = communicator.rank() == 0 && has_earlier_layer(scene, asked); });
    if (any(communicator, is_earlier)) {
      options.contact->tool = with_earlier_layer(asked.contact->tool, scene);
    }
  }
  return options;
}

}  // namespace

std::unique_ptr<ExplorationSession> begin_exploration(std::shared_ptr<const Scene> scene,
                                                      const PrecomputeOptions& asked,
                                                      Communicator& communicator,
                                                      const Progress& progress,
                                                      TakeChunk take_chunk) {
  const PrecomputeOptions options = resolved(*scene, asked, communicator);
  assert(!has_both(options) && options.ranks_per_solve == 1);
  std::unique_ptr<ExplorationSession> session;
  agree(communicator, [&] {
    const auto make_solver = solver_maker(*scene, options);
    session = std::make_unique<ExplorationSession>(std::move(scene), options, communicator,
                                                   progress, make_solver, std::move(take_chunk));
  });
  return session;
}

PrecomputeResult precompute(const Scene& scene, const PrecomputeOptions& asked,
                            Communicator& communicator, const Progress& progress) {
  const SteadyClock::time_point start = SteadyClock::now();
  const PrecomputeOptions options = resolved(scene, asked, communicator);
  // The caller's scene outlives this call.
  const std::shared_ptr<const Scene> shared(std::shared_ptr<const void>(), &scene);
  PrecomputeResult result;
  // A rank may run out of memory anywhere.
  agree(communicator, [&] {
    result = explore_on_ranks(shared, without_nodes(options), communicator, progress);
    if (has_both(options) && any(communicator, result.report.complete)) {
      append(result, explore_on_ranks(shared, without_contact(options), communicator, progress),
             options.file.empty());
    }
    combine(result.report, communicator);
  });
  PrecomputeReport& report = result.report;
  report.num_ranks = communicator.size();
  report.num_cells = scene.mesh.num_cells();
  if (report.complete && progress) {
    const std::int64_t found = report.num_solved + report.num_reused;
    (void)progress({found, found, report.num_solved, seconds_since(start), 0});
  }
  return result;
}

}  // namespace palpate
