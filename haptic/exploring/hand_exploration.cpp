// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/exploring/hand_exploration.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "base/clock.h"
#include "base/error.h"
#include "base/find_program.h"
#include "explorers/explorer_hub.h"
#include "explorers/keys.h"
#include "explorers/local_explorers.h"
#include "following/session_fields.h"

namespace palpate {
namespace {

/// The time between two questions where the hand is, s.
constexpr double kBetweenPoses = 0.01;
/// The least time between two bodies that are given out, s, and how many times as long it is as
/// making one takes. In a large space with levels that can take long.
constexpr double kBetweenBodies = 0.03;
constexpr double kRestsAfterBody = 4;
/// How long the thread leaves the session to those who show the body.
constexpr std::chrono::milliseconds kPause{1};

std::string find_explorer() {
  return find_program("palpate-explore", "PALPATE_EXPLORE",
                      "To touch what is there without exploring it, set Exploration of Precompute "
                      "State Space to Whole Space");
}

}  // namespace

struct HandExploration::Impl {
  Impl(std::shared_ptr<const Scene> scene, const HandExplorationOptions& options, Where asked,
       TakeBody takes)
      : touch(options.touch),
        where(std::move(asked)),
        take_body(std::move(takes)),
        session(std::move(scene), options.space),
        space(session.empty_space()),
        shown(session, mutex),
        keys(options.keys),
        hub(keys.path(), options.endpoint),
        explorers(find_explorer(), options.num_explorers, keys.path(), hub.endpoint()) {
    touch.interpolation.reach_of_states = NearStates::usual_reach(session.job().setup.grid);
    hub.explore_for(&session);
  }

  void run() noexcept;
  /// Takes in what was found, and gives the body out.
  void grow();
  void stop();

  TouchableOptions touch;
  Where where;
  TakeBody take_body;

  /// Guards what follows; the thread has it but for its pauses.
  mutable std::mutex mutex;
  FollowSession session;
  TouchSpace space;
  std::shared_ptr<const Touchable> body;
  State state;
  std::int64_t last_chunk = 0;
  std::string problem;
  bool is_ended = false;
  SessionFields shown;
  KeysFolder keys;
  ExplorerHub hub;
  LocalExplorers explorers;

  std::atomic<bool> stops{false};
  std::thread thread;
};

void HandExploration::Impl::grow() {
  while (const auto chunk = session.take_chunk()) {
    take(*chunk, space);
    last_chunk = chunk->number;
    body = body == nullptr ? std::make_shared<const Touchable>(space, touch)
                           : std::make_shared<const Touchable>(*body, space, *chunk);
  }
}

void HandExploration::Impl::run() noexcept {
  try {
    SteadyClock::time_point asked;
    SteadyClock::time_point given;
    double rests = kBetweenBodies;
    std::shared_ptr<const Touchable> newest;
    while (!stops) {
      {
        const std::lock_guard lock(mutex);
        if (seconds_since(asked) >= kBetweenPoses) {
          asked = SteadyClock::now();
          if (const std::optional<HandMotion> hand = where()) session.follow(HandPrediction(*hand));
          (void)explorers.watch();
        }
        (void)hub.exchange();
        if (seconds_since(given) >= rests) {
          given = SteadyClock::now();
          grow();
          rests = std::max(kBetweenBodies, kRestsAfterBody * seconds_since(given));
          given = SteadyClock::now();
        }
      }
      if (newest != body) {
        newest = body;
        take_body(newest);
      }
      std::this_thread::sleep_for(kPause);
    }
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex);
    problem = error.what();
  }
}

void HandExploration::Impl::stop() {
  stops = true;
  if (thread.joinable()) thread.join();
  hub.explore_for(nullptr);
}

HandExploration::HandExploration(std::shared_ptr<const Scene> scene,
                                 const HandExplorationOptions& options, Where where,
                                 TakeBody take_body)
    : impl_(std::make_unique<Impl>(std::move(scene), options, std::move(where),
                                   std::move(take_body))) {
  impl_->thread = std::thread([this] { impl_->run(); });
}

HandExploration::~HandExploration() { impl_->stop(); }

void HandExploration::end() {
  impl_->stop();
  const std::lock_guard lock(impl_->mutex);
  if (!std::exchange(impl_->is_ended, true)) (void)impl_->session.finish();
}

HandExploration::Figures HandExploration::figures() const {
  const std::lock_guard lock(impl_->mutex);
  const ExplorerHub::Figures hub = impl_->hub.figures();
  Figures figures;
  figures.session = impl_->session.figures();
  figures.num_explorers = hub.num_explorers;
  figures.num_busy = hub.num_busy;
  figures.num_lost = hub.num_lost;
  figures.problem = impl_->problem.empty() ? hub.last_failure : impl_->problem;
  return figures;
}

LiveSpace::State HandExploration::newest() {
  const std::lock_guard lock(impl_->mutex);
  State& state = impl_->state;
  const TouchToolSpace* rigid = impl_->space.find_pressing();
  if (rigid != nullptr && impl_->body && state.number != impl_->last_chunk) {
    state.number = impl_->last_chunk;
    state.tool_space = std::make_shared<const TouchToolSpace>(*rigid);
    state.force = std::shared_ptr<const ToolForce>(impl_->body, impl_->body->force_on_tool());
  }
  return state;
}

const SpaceBody& HandExploration::body() const { return impl_->session.body(); }

FieldSource& HandExploration::fields() { return impl_->shown; }

}  // namespace palpate
