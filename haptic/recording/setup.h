// SPDX-License-Identifier: BSD-3-Clause
// The facts about a recording that a replay needs besides the ticks.
#pragma once

#include <string>

#include "haptic/profile/profile.h"
#include "haptic/servo/options.h"
#include "haptic/touching/touchable.h"

namespace palpate {

struct RecordedSetup {
  /// The device, in words.
  std::string device;
  ProfileKind profile = ProfileKind::palpate_report;
  /// The feature report that the profile was made from; empty: it needs none.
  Report feature;
  /// The hash of the scene of the body that is touched; empty: no body is touched.
  std::string scene_hash;
  TouchableOptions touchable;
  ServoOptions options;
};

}  // namespace palpate
