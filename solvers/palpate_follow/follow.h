// SPDX-License-Identifier: BSD-3-Clause
// A hand that palpates at random is followed: by explorers on this machine, in real time, or by
// simulated ones, by a virtual clock.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "palpate_follow/recorded_space.h"

namespace palpate {

struct HandOptions {
  /// How far the hand goes from the middle of what is pressed, m.
  double extent = 0.08;
  /// How long it palpates after the first second, which does not count, s.
  double seconds = 20;
  /// Of its way.
  unsigned seed = 1;
  /// The time between two ticks at which the force is compared, s.
  double between = 0.1;
};

/// Names of columns with what is in them.
using FollowedRow = std::vector<std::pair<const char*, double>>;

/// Follows a hand with explorers in processes of their own, and compares the force with that of
/// solves from where the tool touches nothing.
/// @param speed Of the hand, m/s.
/// @throws BackendError palpate-explore is missing or cannot be started.
[[nodiscard]] FollowedRow follow_here(const RecordedSpace& space, const HandOptions& options,
                                      double speed, int explorers);

/// Follows a hand by the same strategy, with configurations that take the time that they have
/// taken in the space; those that it does not have take as long as one does in the mean, and twice
/// that where no neighbour is known.
[[nodiscard]] FollowedRow simulate_following(const RecordedSpace& space, const HandOptions& options,
                                             double speed, int cores);

}  // namespace palpate
