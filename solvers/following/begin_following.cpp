// SPDX-License-Identifier: BSD-3-Clause
#include "following/begin_following.h"

#include <utility>

#include "base/error.h"
#include "following/follow_session.h"

namespace palpate {
namespace {

/// So many places are tried until one has an equilibrium.
constexpr int kMostTrials = 30;

/// Finds one configuration.
void begin(FollowSession& session, const std::function<bool()>& abort) {
  session.follow(HandPrediction(session.first_hand()));
  Explorer explorer(session.job(), abort);
  for (int trial = 0; trial < kMostTrials; ++trial) {
    const std::optional<ExplorerTask> task = session.next();
    if (!task) break;
    const ExplorerResult result = explorer.make(*task);
    if (!result.failure.empty()) throw BackendError(result.failure);
    if (abort && abort()) throw BackendError("Aborted before a configuration was found.");
    (void)session.accept(result);
    if (result.found.usable()) return;
  }
  throw InputError(
      "No equilibrium was found near the place where the exploration begins. Begin elsewhere "
      "(BeginAt), press less deep, or check the boundary and the materials with Solve "
      "Equilibrium.");
}

}  // namespace

BegunSpace begin_following(std::shared_ptr<const Scene> scene, const PrecomputeOptions& options,
                           const std::function<bool()>& abort_requested) {
  FollowSession session(std::move(scene), options);
  if (!session.has_found()) begin(session, abort_requested);
  BegunSpace begun;
  begun.body = session.body();
  begun.space = session.finish();
  return begun;
}

}  // namespace palpate
