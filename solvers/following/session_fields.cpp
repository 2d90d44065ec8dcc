// SPDX-License-Identifier: BSD-3-Clause
#include "following/session_fields.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace palpate {

void SessionFields::add_up(const ToolSpaceSetup& /*setup*/, const std::vector<FieldShare>& shares,
                           Keep needed, NodalVector& u, NodalVector& p) {
  ++uses_;
  const SpaceBody& body = session_.body();
  u.setZero(3 * Eigen::Index{body.mesh().num_points()});
  p.resize(0);
  for (const FieldShare& share : shares) {
    const Entry& entry = get(share.configuration);
    if (entry.kept < needed) {
      throw InputError(
          std::string("The file of the state space keeps less of the displacements than is asked "
                      "for (Keep is ") +
          name_of(entry.kept) + "). Compute the state space with Keep " + name_of(needed) + ".");
    }
    if (entry.configuration.u.size() > 0) add_share(share, entry.configuration, u, p);
  }
  forget_old_ones();
}

const SessionFields::Entry& SessionFields::get(const ConfigurationSummary& summary) {
  auto found = entries_.find(summary.check_point);
  if (found == entries_.end()) {
    Entry entry;
    {
      const std::lock_guard lock(mutex_);
      entry.configuration = session_.load(summary);
      entry.kept = session_.kept(summary);
    }
    count_from_rest(session_.body().at_rest, entry.configuration);
    bytes_ += bytes_of_fields(entry.configuration);
    found = entries_.emplace(summary.check_point, std::move(entry)).first;
  }
  found->second.last_use = uses_;
  return found->second;
}

void SessionFields::forget_old_ones() {
  while (bytes_ > most_bytes_) {
    const auto oldest = std::min_element(
        entries_.begin(), entries_.end(),
        [](const auto& a, const auto& b) { return a.second.last_use < b.second.last_use; });
    if (oldest->second.last_use == uses_) return;
    bytes_ -= bytes_of_fields(oldest->second.configuration);
    entries_.erase(oldest);
  }
}

}  // namespace palpate
