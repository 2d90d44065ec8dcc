// SPDX-License-Identifier: BSD-3-Clause
// What a replay has to know besides the ticks.
#pragma once

#include <string>

#include "haptic/profile/profile.h"
#include "haptic/servo/options.h"
#include "haptic/touching/touchable.h"

namespace palpate {

struct RecordedSetup {
  /// In words.
  std::string device;
  ProfileKind profile = ProfileKind::palpate_report;
  /// That the profile was made from; empty: none.
  Report feature;
  /// Of the body that is touched; empty: there is none.
  std::string scene_hash;
  TouchableOptions touchable;
  ServoOptions options;
};

}  // namespace palpate
