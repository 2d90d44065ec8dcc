// SPDX-License-Identifier: BSD-3-Clause
// The exploration of a ball on a block, small enough that all of it takes some seconds.
#pragma once

#include <memory>

#include "exploration/precompute_options.h"
#include "following/hand_prediction.h"
#include "solvers/support/block.h"

namespace palpate::test {

struct BallOnBlock {
  BallOnBlock() {
    block = make_block(Law::neo_hookean, {ElementOrder::linear, {4, 3, 2}});
    scene = std::make_shared<const Scene>(block.scene);
    options.contact.emplace();
    options.contact->tool.radius = 0.015;
    options.contact->spacing = 0.012;
    options.contact->shell.depth = 0.006;
    options.history = History::flat;
    // Of one material and without ridges, but for the edges of the block.
    options.contact->shell.region = [](const Vec3& place) { return place.x() > 0.08; };
  }

  /// The hand rests at the middle of the free end of the block.
  [[nodiscard]] HandPrediction hand() const {
    const Vec3 end = block.scene.body.mesh.points[static_cast<std::size_t>(block.middle)];
    return HandPrediction({end + Vec3(0.012, 0, 0), Vec3::Zero()});
  }

  Block block;
  std::shared_ptr<const Scene> scene;
  PrecomputeOptions options;
};

}  // namespace palpate::test
