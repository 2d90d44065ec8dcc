// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "accuracy/statistics.h"
#include "base/clock.h"
#include "base/find_program.h"
#include "exploration/state_solver.h"
#include "explorers/explorer_hub.h"
#include "explorers/keys.h"
#include "explorers/local_explorers.h"
#include "following/follow_session.h"
#include "following/known_cells.h"
#include "interpolation/tool_force.h"
#include "palpate_follow/follow.h"
#include "palpate_follow/palpating_hand.h"

namespace palpate {
namespace {

/// The time between two poses that the session hears of, s.
constexpr double kBetweenPoses = 0.01;
/// The time that does not count, s.
constexpr double kBefore = 1;

/// Where a force comes from.
enum class Kind { nothing, around, in_cell };

/// What is felt at some ticks, and what a solve says of them in the end.
class Felt {
 public:
  /// @param reach ToolForce's.
  Felt(TouchSpace begun, double reach) : space_(std::move(begun)) {
    options_.reach_of_states = reach;
  }
  void take(const SpaceChunk& chunk) {
    palpate::take(chunk, space_);
    const std::vector<const TouchToolSpace*> rigid = space_.list_pressing();
    if (force_ == nullptr) {
      force_ = std::make_unique<ToolForce>(rigid, Method::energy_hermite, options_);
      return;
    }
    for (const ToolSpaceChunk& part : chunk.tool_spaces) {
      force_ = std::make_unique<ToolForce>(*force_, rigid, part.setup.key(), part.check_points());
    }
  }
  void feel(const Vec3& place) {
    Tick tick{place, Vec3::Zero(), Kind::nothing};
    if (force_ && force_->has_cell(place)) {
      tick.kind = Kind::in_cell;
    } else if (force_ && force_->expands(place)) {
      tick.kind = Kind::around;
    }
    if (tick.kind != Kind::nothing) tick.force = force_->evaluate(place).force;
    ticks_.push_back(tick);
  }

  /// Solves for all places.
  void compare(const SpaceBody& body, const ToolSpaceSetup& setup) {
    EquilibriumSolver solver(*body.scene, {});
    InteractionFactory tools(body.scene->body, body.at_rest);
    InteractionSolver states(body, solver, tools);
    for (const Tick& tick : ticks_) {
      const Equilibrium exact = states.begin(setup, tick.place, Tangent::iterated);
      if (exact.outcome != Outcome::converged || exact.reaction.isZero(0)) continue;
      if (setup.policy.is_beyond_limit(exact.reaction)) continue;
      sizes_.push_back(exact.reaction.norm());
      errors_[tick.kind].push_back((tick.force - Vec3(exact.reaction)).norm());
    }
  }
  /// Of the ticks in which something is to be felt, %.
  [[nodiscard]] double share(Kind kind) const {
    const auto found = errors_.find(kind);
    if (found == errors_.end()) return 0;
    return 100 * static_cast<double>(found->second.size()) / static_cast<double>(sizes_.size());
  }
  /// The force that nine tenths of the ticks stay below, N.
  [[nodiscard]] double usual_force() const { return quantile(sizes_, 0.9); }
  /// In per cent of the usual force; NaN: there is none.
  [[nodiscard]] double error(Kind kind, double order) const {
    const auto found = errors_.find(kind);
    const std::vector<double> none;
    return 100 * quantile(found == errors_.end() ? none : found->second, order) / usual_force();
  }

 private:
  struct Tick {
    Vec3 place;
    Vec3 force;
    Kind kind;
  };

  TouchSpace space_;
  InterpolationOptions options_;
  std::unique_ptr<ToolForce> force_;
  std::vector<Tick> ticks_;
  std::vector<double> sizes_;
  std::map<Kind, std::vector<double>> errors_;
};

}  // namespace

FollowedRow follow_here(const RecordedSpace& space, const HandOptions& options, double speed,
                        int explorers) {
  const PrecomputeOptions of_space = space.options();
  const SteadyClock::time_point started = SteadyClock::now();
  const KeysFolder keys;
  ExplorerHub hub(keys.path(), "tcp://127.0.0.1:*");
  std::optional<LocalExplorers> processes;
  processes.emplace(find_program("palpate-explore", "PALPATE_EXPLORE",
                                 "To follow a hand by a virtual clock, give --simulated"),
                    explorers, keys.path(), hub.endpoint());
  FollowSession session(space.body().scene, of_space);
  hub.explore_for(&session);

  const ToolSpaceSetup& setup = session.job().setup;
  ShellCells cells(*space.clearance(), setup.grid, space.body().scene->body.touchable,
                   of_space.contact->shell);
  PalpatingHand hand(*space.clearance(), space.middle(), options.extent, speed, options.seed);
  Felt felt(session.empty_space(), NearStates::usual_reach(setup.grid));
  KnownCells known(cells);
  double first_cell = std::numeric_limits<double>::quiet_NaN();
  bool counts = false;
  double next_pose = 0;
  double next_feeling = kBefore;
  const SteadyClock::time_point begin = SteadyClock::now();
  for (double time = 0; time < kBefore + options.seconds; time += PalpatingHand::kTick) {
    const double ahead = time - seconds_since(begin);
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::duration<double>(ahead));
    const HandMotion motion = hand.next();
    if (time >= next_pose) {
      next_pose = time + kBetweenPoses;
      session.follow(HandPrediction(motion));
      (void)processes->watch();
    }
    if (hub.exchange()) {
      while (const auto chunk = session.take_chunk()) {
        felt.take(*chunk);
        for (const ToolSpaceChunk& part : chunk->tool_spaces) {
          for (const ConfigurationSummary& c : part.configurations) known.add(c.check_point);
        }
      }
    }
    if (!counts && time >= kBefore) {
      counts = true;
      known.reset();
    }
    if (time >= next_feeling) {
      next_feeling += options.between;
      felt.feel(motion.place);
    }
    known.tick(motion.place, PalpatingHand::kTick);
    if (std::isnan(first_cell) && known.counts().in_known > 0) first_cell = seconds_since(started);
  }
  hub.explore_for(nullptr);
  processes.reset();
  const FollowSession::Figures figures = session.figures();
  felt.compare(space.body(), setup);
  const KnownCells::Counts& ticks = known.counts();
  return {{"explorers", explorers},
          {"hand (mm/s)", 1e3 * speed},
          {"in computed cells (%)", 100 * ticks.share()},
          {"force in cells (%)", felt.share(Kind::in_cell)},
          {"median error (%)", felt.error(Kind::in_cell, 0.5)},
          {"error of 90 % (%)", felt.error(Kind::in_cell, 0.9)},
          {"force from around (%)", felt.share(Kind::around)},
          {"median error around (%)", felt.error(Kind::around, 0.5)},
          {"error of 90 % around (%)", felt.error(Kind::around, 0.9)},
          {"usual force (N)", felt.usual_force()},
          {"median wait (s)", ticks.wait(0.5)},
          {"longest wait (s)", ticks.wait(1)},
          {"first cell (s)", first_cell},
          {"states", static_cast<double>(figures.num_solved)},
          {"state (ms)",
           1e3 * figures.seconds / std::max<double>(1, static_cast<double>(figures.num_solved))}};
}

}  // namespace palpate
