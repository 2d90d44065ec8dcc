// SPDX-License-Identifier: BSD-3-Clause
// A body of a state space. A space has one organ and one body of it at least; each tool space
// stands on one of the bodies.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "state_space/tool_space.h"

namespace palpate {

struct SpaceBody {
  BodyId number = kFirstBody;
  /// The organ as this body.
  std::shared_ptr<const Scene> scene;

  // What follows from the scene.

  /// The result of hash(scene).
  std::string hash;
  SettledBody at_rest;

  [[nodiscard]] const TetMesh& mesh() const { return scene->body.mesh; }
};

/// The first body of a space.
[[nodiscard]] SpaceBody make_space_body(Scene scene, SettledBody at_rest = {});

/// The body with a number. @param bodies Ordered by their numbers, which begin with kFirstBody.
[[nodiscard]] const SpaceBody& find_body(const std::vector<SpaceBody>& bodies, BodyId number);

/// Checks that two scenes may be bodies of one space: they are of one organ, and both or none of
/// them have supports or loads of the surface.
/// @throws InputError they are not.
void require_one_organ(const Scene& first, const Scene& other);

}  // namespace palpate
