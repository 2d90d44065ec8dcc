// SPDX-License-Identifier: BSD-3-Clause
#include "following/known_cells.h"

#include <algorithm>
#include <cstddef>

namespace palpate {

double KnownCells::Counts::wait(double share) const {
  if (waits.empty()) return 0;
  std::vector<double> sorted = waits;
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

void KnownCells::tick(const Vec3& place, double until_next) {
  const CheckPoint numbers = cells_.numbers_of(place);
  const bool is_in_shell = cells_.holds(numbers);
  const Cell cell = cells_.root(numbers);
  bool is_known = is_in_shell;
  for (int corner = 0; corner < 8 && is_known; ++corner) {
    is_known = known_.count(corner_of(cell, corner)) > 0;
  }
  counts_.in_shell += is_in_shell ? 1 : 0;
  counts_.in_known += is_known ? 1 : 0;
  const bool waited = waits_;
  waits_ = is_in_shell && !is_known;
  if (!waits_) return;
  if (!waited || counts_.waits.empty()) counts_.waits.push_back(0);
  counts_.waits.back() += until_next;
}

}  // namespace palpate
