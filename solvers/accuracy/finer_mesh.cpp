// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy/finer_mesh.h"

#include <algorithm>
#include <vector>

#include "assembly/refined_scene.h"
#include "base/error.h"
#include "equilibrium/tangent_solver.h"
#include "equilibrium/work.h"
#include "exploration/state_solver.h"
#include "exploration/transfer.h"
#include "mesh/refinement.h"

namespace palpate {
namespace {

/// A point that is solved for, of its tool space.
struct Place {
  std::int32_t tool_space = 0;
  std::int32_t point = 0;
  Vec3 t = Vec3::Zero();
  /// What was found there, N.
  Vec3 force = Vec3::Zero();

  template <class Visit>
  friend void for_each_part(Place& place, Visit&& visit) {
    visit(place.tool_space);
    visit(place.point);
    visit(place.t);
    visit(place.force);
  }
};

/// A body all of whose cells are divided, with its solver.
class FinerBody {
 public:
  FinerBody(const Scene& scene, const EquilibriumOptions& options)
      : scene_(std::make_shared<const Scene>(refined(scene, refine_all(scene.body.mesh)))),
        solver_(*scene_, options, choose_tangent_solver(*scene_, options.threads)) {
    body_.scene = scene_;
    if (scene_->has_load()) {
      require_rest(solver_);
      body_.at_rest = {solver_.settled().u, solver_.settled().p};
    }
    tools_.emplace(scene_->body, body_.at_rest);
    states_.emplace(body_, solver_, *tools_, true);
  }
  FinerBody(const FinerBody&) = delete;
  FinerBody& operator=(const FinerBody&) = delete;

  /// The force at t, less what it still errs; nothing: there is no equilibrium.
  /// @param is_aborted Set where the solve was aborted.
  [[nodiscard]] std::optional<Vec3> solve(const ToolSpaceSetup& setup, const Vec3& t,
                                          bool& is_aborted) {
    if (!setup_ || !(setup_->key() == setup.key())) hold(setup);
    const Equilibrium found = setup_->presses()
                                  ? states_->begin(*setup_, t, Tangent::iterated)
                                  : states_->solve(*setup_, t, rest_, Tangent::iterated);
    is_aborted = found.outcome == Outcome::aborted;
    if (found.outcome != Outcome::converged) return std::nullopt;
    const MeshError error = states_->mesh_error(*setup_, found);
    return Vec3(found.reaction) - (error.is_reliable ? error.force : Vec3::Zero());
  }

 private:
  /// Takes the tool of a tool space. A bonded one has the points of this mesh.
  void hold(const ToolSpaceSetup& setup) {
    setup_ = setup;
    if (setup.presses()) return;
    setup_->interaction =
        bonded_patch_spec(scene_->body.mesh, body_.at_rest, setup.interaction.active_node,
                          setup.interaction.tip_radius);
    rest_ = states_->begin(*setup_, Vec3::Zero(), Tangent::factorised);
  }

  std::shared_ptr<const Scene> scene_;
  EquilibriumSolver solver_;
  SpaceBody body_;
  std::optional<InteractionFactory> tools_;
  std::optional<InteractionSolver> states_;
  /// The tool space whose tool is held, and of a bonded tool the body at rest.
  std::optional<ToolSpaceSetup> setup_;
  Equilibrium rest_;
};

/// The regular points of all tool spaces, in the order of their bodies, on every rank.
std::vector<Place> share_places(const std::vector<ToolSpaceSetup>& setups,
                                const std::vector<std::vector<TestPoint>>& points,
                                Communicator& communicator) {
  std::vector<Place> places;
  if (communicator.rank() == 0) {
    for (std::size_t s = 0; s < points.size(); ++s) {
      for (std::size_t i = 0; i < points[s].size(); ++i) {
        if (!points[s][i].regular()) continue;
        Place& place = places.emplace_back();
        place.tool_space = static_cast<std::int32_t>(s);
        place.point = static_cast<std::int32_t>(i);
        place.t = points[s][i].t;
      }
    }
    std::stable_sort(places.begin(), places.end(), [&](const Place& a, const Place& b) {
      return setups[static_cast<std::size_t>(a.tool_space)].body <
             setups[static_cast<std::size_t>(b.tool_space)].body;
    });
  }
  return of_first(places, communicator);
}

}  // namespace

FinerForces solve_on_finer_meshes(const std::vector<std::shared_ptr<const Scene>>& scenes,
                                  const std::vector<ToolSpaceSetup>& setups,
                                  const std::vector<std::vector<TestPoint>>& points,
                                  const EquilibriumOptions& asked, Communicator& communicator,
                                  const Progress& progress) {
  const SteadyClock::time_point start = SteadyClock::now();
  const std::vector<Place> places = share_places(setups, points, communicator);
  const auto size = static_cast<std::size_t>(communicator.size());
  const auto rank = static_cast<std::size_t>(communicator.rank());
  std::size_t next = 0;
  const auto goes_on = [&] {
    if (communicator.rank() != 0 || !progress) return true;
    ProgressState state;
    state.num_done = static_cast<std::int64_t>(next);
    state.num_expected = static_cast<std::int64_t>(places.size());
    state.seconds = seconds_since(start);
    const double each = next > 0 ? state.seconds / static_cast<double>(next) : 0;
    state.seconds_left = each * static_cast<double>(places.size() - next);
    return progress(state);
  };
  EquilibriumOptions options = asked;
  options.follow_folds = false;
  options.threads = num_threads(communicator, asked.threads);
  options.abort_requested = [&] { return !goes_on(); };

  FinerForces result;
  std::vector<Place> found;
  std::unique_ptr<FinerBody> body;
  BodyId of = kFirstBody;
  for (; next < places.size() && result.complete; next += size) {
    bool is_aborted = !goes_on();
    agree(communicator, [&] {
      if (is_aborted || next + rank >= places.size()) return;
      const Place& place = places[next + rank];
      const ToolSpaceSetup& setup = setups[static_cast<std::size_t>(place.tool_space)];
      if (!body || of != setup.body) {
        body.reset();
        of = setup.body;
        body = std::make_unique<FinerBody>(*scenes.at(static_cast<std::size_t>(of - kFirstBody)),
                                           options);
      }
      try {
        if (const auto force = body->solve(setup, place.t, is_aborted)) {
          found.push_back(place);
          found.back().force = *force;
        }
      } catch (const InputError&) {
        // The tool finds no way to the place on this mesh: nothing is known there.
      }
    });
    result.complete = !any(communicator, is_aborted);
  }

  gather(found, communicator);
  if (communicator.rank() != 0) return result;
  for (const auto& of_tool_space : points) result.forces.emplace_back(of_tool_space.size());
  for (const Place& place : found) {
    result
        .forces[static_cast<std::size_t>(place.tool_space)][static_cast<std::size_t>(place.point)] =
        place.force;
  }
  return result;
}

}  // namespace palpate
