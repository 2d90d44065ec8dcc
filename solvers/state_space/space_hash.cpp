// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/space_hash.h"

namespace palpate {

std::string join_hashes(const std::vector<std::string>& hashes) {
  std::string joined;
  for (const std::string& hash : hashes) joined += (joined.empty() ? "" : "+") + hash;
  return joined;
}

bool is_same_space(const std::string& a, const std::string& b) noexcept {
  const std::string& shorter = a.size() < b.size() ? a : b;
  const std::string& longer = a.size() < b.size() ? b : a;
  if (shorter.empty() || longer.compare(0, shorter.size(), shorter) != 0) return false;
  return longer.size() == shorter.size() || longer[shorter.size()] == '+';
}

}  // namespace palpate
