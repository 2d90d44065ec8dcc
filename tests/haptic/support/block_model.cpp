// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/support/block_model.h"

#include "interaction/bonded_patch.h"
#include "solvers/reduced/whole_model.h"
#include "solvers/support/block.h"

namespace palpate::test {

BlockModel make_block_model(double youngs_modulus, double viscous_time, Law law,
                            const Vec3& gravity) {
  BlockOptions options{ElementOrder::linear, {2, 1, 1}};
  options.youngs_modulus = youngs_modulus;
  const Block block = make_block(law, options);
  InteractionList tools;
  tools.add(BondedPatch({block.corner}));
  tools.add(BondedPatch({block.middle}));
  Rheology rheology;
  rheology.density = 1000;
  rheology.viscous_time = viscous_time;
  BlockModel result;
  const WholeModel whole = make_whole_model(block.scene, {rheology}, tools, 0.01, gravity);
  result.model = std::make_shared<const ReducedModel>(whole.model);
  for (const Index point : {block.corner, block.middle}) {
    result.places.push_back(block.scene.body.mesh.points[static_cast<std::size_t>(point)] +
                            whole.rest.segment<3>(3 * Eigen::Index{point}));
  }
  return result;
}

const BlockModel& block_model() {
  static const BlockModel model = make_block_model(30000, 0.01);
  return model;
}

}  // namespace palpate::test
