// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/space_body.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace palpate {

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
  if (!(first.organ == other.organ)) {
    throw InputError(
        "The bodies are of different organs: their materials, densities or body forces differ. "
        "Give bodies of one organ, or compute a space of each.");
  }
  if (first.body.has_supports_or_surface_loads() == other.body.has_supports_or_surface_loads()) {
    return;
  }
  throw InputError(
      "One of the bodies has supports or loads of its surface, and another one has none. Hold and "
      "load all bodies of an organ in the same way, or compute a space of each.");
}

std::string join_hashes(const std::vector<std::string>& hashes) {
  std::string joined;
  for (const std::string& hash : hashes) joined += (joined.empty() ? "" : "+") + hash;
  return joined;
}

}  // namespace palpate
