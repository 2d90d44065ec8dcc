// SPDX-License-Identifier: BSD-3-Clause
// What the points of contact see of each other in a state, for the energy and its derivatives.
#pragma once

#include <vector>

#include "soft_contact/contact_pairs.h"
#include "soft_contact/soft_contact.h"

namespace palpate {

/// Two numbered points that see each other.
struct SoftContact::FeltPair {
  std::uint32_t i, j;
  /// 1 − |r|²/ρ², and −n_i · n_j; both are positive.
  double t, facing;
};

struct SoftContact::Sight {
  NodalVector state;
  /// ρ, or more.
  double reach = 0;
  std::vector<PointFeatures> at;
  std::vector<SeenPoint> seen;
  std::vector<Sums> sums;
  /// In the order of i, then of j [num_pairs]; what follows is left from earlier states.
  std::vector<FeltPair> pairs;
  std::size_t num_pairs = 0;
};

}  // namespace palpate
