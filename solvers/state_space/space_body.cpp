// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/space_body.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

/// Whether an organ has all tissues of another one.
bool has_tissues_of(const Organ& all, const Organ& some) {
  for (std::size_t s = 0; s < some.materials.size(); ++s) {
    bool is_there = false;
    for (std::size_t a = 0; a < all.materials.size() && !is_there; ++a) {
      is_there = all.materials[a] == some.materials[s] &&
                 (all.densities.empty() || all.densities[a] == some.densities[s]);
    }
    if (!is_there) return false;
  }
  return true;
}

bool is_one_organ(const Organ& a, const Organ& b) {
  return a.body_force == b.body_force && a.densities.empty() == b.densities.empty() &&
         a.touching == b.touching && a.contact == b.contact &&
         (has_tissues_of(a, b) || has_tissues_of(b, a));
}

}  // namespace

SpaceBody make_space_body(Scene scene, SettledBody at_rest) {
  SpaceBody body;
  body.hash = hash(scene);
  body.scene = std::make_shared<const Scene>(std::move(scene));
  body.at_rest = std::move(at_rest);
  return body;
}

const SpaceBody& find_body(const std::vector<SpaceBody>& bodies, BodyId number) {
  const auto found = std::find_if(bodies.begin(), bodies.end(),
                                  [&](const SpaceBody& body) { return body.number == number; });
  if (found != bodies.end()) return *found;
  throw InputError("The state space has no body " + std::to_string(number) + '.');
}

void require_one_organ(const Scene& first, const Scene& other) {
  if (!is_one_organ(first.organ, other.organ)) {
    throw InputError(
        "The bodies are of different organs: their materials, densities, body forces or contact "
        "differ. "
        "Give bodies of one organ, or compute a space of each.");
  }
  if (first.body.has_supports_or_surface_loads() == other.body.has_supports_or_surface_loads()) {
    return;
  }
  throw InputError(
      "One of the bodies has supports or loads of its surface, and another one has none. Hold and "
      "load all bodies of an organ in the same way, or compute a space of each.");
}

}  // namespace palpate
