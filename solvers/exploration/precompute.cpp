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

ExplorationSession::MakeSolver solver_maker(const PrecomputeOptions& options) {
  return [name = options.linear_solver, threads = options.equilibrium.threads](const Scene& scene) {
    return make_tangent_solver(name, scene, threads);
  };
}

/// Explores, on the ranks that lead a solve.
PrecomputeResult explore(const std::vector<BodyOfRun>& bodies, const PrecomputeOptions& options,
                         Communicator& communicator, const Progress& progress,
                         const ExplorationSession::MakeSolver& make_solver) {
  ExplorationSession session(bodies, options, communicator, progress, make_solver);
  session.run();
  return session.finish();
}

/// Explores, on all ranks.
/// @note Collective
PrecomputeResult explore_on_ranks(const std::vector<BodyOfRun>& bodies,
                                  const PrecomputeOptions& options, Communicator& communicator,
                                  const Progress& progress) {
  PrecomputeResult result;
  if (options.ranks_per_solve == 1) {
    result = explore(bodies, options, communicator, progress, solver_maker(options));
  } else {
    const Groups groups(communicator, options.ranks_per_solve);
    const void* group = groups.own->mpi_comm();
    agree(communicator, prepare_group_solver);
    agree(communicator, [&] {
      if (groups.leads()) {
        // Make the solver first: the other ranks already serve it, and if anything fails its
        // destructor releases them.
        auto solver = make_group_solver(group);
        result = explore(bodies, options, *groups.leaders, progress,
                         [&solver](const Scene& /*scene*/) { return std::move(solver); });
      } else {
        serve_group_solver(group);
      }
    });
  }
  return result;
}

bool has_both(const std::vector<BodyOfRun>& bodies, const PrecomputeOptions& options) {
  return options.contact && std::any_of(bodies.begin(), bodies.end(), [](const BodyOfRun& body) {
           return !body.active_nodes.empty();
         });
}

/// The bodies, without nodes if a rigid tool goes first.
std::vector<BodyOfRun> without_nodes(std::vector<BodyOfRun> bodies,
                                     const PrecomputeOptions& options) {
  if (!options.contact) return bodies;
  for (BodyOfRun& body : bodies) body.active_nodes.clear();
  return bodies;
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
  if (in_memory) {
    std::vector<TouchToolSpace>& spaces = newer.space.tool_spaces;
    put_before(spaces, all.space.tool_spaces);
    std::sort(spaces.begin(), spaces.end(), [](const TouchToolSpace& a, const TouchToolSpace& b) {
      return a.setup.key() < b.setup.key();
    });
  }
  all = std::move(newer);
}

/// Checks the active nodes of all bodies. The meshes stand for the bodies at rest.
void check_nodes(const std::vector<BodyOfRun>& bodies, const PrecomputeOptions& options) {
  for (const BodyOfRun& body : bodies) {
    if (body.active_nodes.empty()) continue;
    PrecomputeOptions of_body = options;
    of_body.active_nodes = body.active_nodes;
    (void)plan_grids({kFirstBody, body.scene, {}, {}}, of_body, body.region);
  }
}

/// Checks the options, and replaces those that depend on the ranks and on the file.
/// @note Collective
PrecomputeOptions resolved(const std::vector<BodyOfRun>& bodies, const PrecomputeOptions& asked,
                           Communicator& communicator) {
  agree(communicator, [&] {
    if (bodies.empty()) throw InputError("There is no body to explore. Give one at least.");
    validate(asked);
    validate_ranks_per_solve(asked, communicator.size());
    if (asked.ranks_per_solve > 1 && bodies.size() > 1) {
      throw InputError("The ranks per solve are " + std::to_string(asked.ranks_per_solve) +
                       "; for a space of several bodies there can be 1 alone.");
    }
    // Check the active nodes now, and not after the first exploration.
    if (has_both(bodies, asked)) check_nodes(bodies, asked);
  });
  PrecomputeOptions options = asked;
  options.equilibrium.threads = num_threads(communicator, asked.equilibrium.threads);
  if (asked.contact) {
    // Between orientations the energy is interpolated by derivatives up to the third.
    if (asked.contact->tool.motion == ToolMotion::turned) {
      options.equilibrium.third_derivatives = true;
    }
    const Scene& scene = *bodies.front().scene;
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

std::unique_ptr<ExplorationSession> begin_exploration(const std::vector<BodyOfRun>& bodies,
                                                      const PrecomputeOptions& asked,
                                                      Communicator& communicator,
                                                      const Progress& progress,
                                                      TakeChunk take_chunk) {
  const PrecomputeOptions options = resolved(bodies, asked, communicator);
  assert(!has_both(bodies, options) && options.ranks_per_solve == 1);
  std::unique_ptr<ExplorationSession> session;
  agree(communicator, [&] {
    session = std::make_unique<ExplorationSession>(bodies, options, communicator, progress,
                                                   solver_maker(options), std::move(take_chunk));
  });
  return session;
}

PrecomputeResult precompute(const std::vector<BodyOfRun>& bodies, const PrecomputeOptions& asked,
                            Communicator& communicator, const Progress& progress) {
  const SteadyClock::time_point start = SteadyClock::now();
  const PrecomputeOptions options = resolved(bodies, asked, communicator);
  PrecomputeResult result;
  // A rank may run out of memory anywhere.
  agree(communicator, [&] {
    result = explore_on_ranks(without_nodes(bodies, options), options, communicator, progress);
    if (has_both(bodies, options) && any(communicator, result.report.complete)) {
      append(result, explore_on_ranks(bodies, without_contact(options), communicator, progress),
             options.file.empty());
    }
    combine(result.report, communicator);
  });
  PrecomputeReport& report = result.report;
  report.num_ranks = communicator.size();
  if (report.complete && progress) {
    const std::int64_t found = report.num_solved + report.num_reused;
    (void)progress({found, found, report.num_solved, seconds_since(start), 0});
  }
  return result;
}

PrecomputeResult precompute(const Scene& scene, const PrecomputeOptions& options,
                            Communicator& communicator, const Progress& progress) {
  return precompute({{std::make_shared<const Scene>(scene), options.active_nodes}}, options,
                    communicator, progress);
}

}  // namespace palpate
