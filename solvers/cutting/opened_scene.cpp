// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/opened_scene.h"

#include <string>
#include <utility>

#include "base/error.h"
#include "cutting/opened_mesh.h"

namespace palpate {

NodalVector OpenedScene::carry(const NodalVector& u) const {
  NodalVector all(u.size() + 3 * static_cast<Eigen::Index>(originals.size()));
  all.head(u.size()) = u;
  Eigen::Index next = u.size();
  for (const Index original : originals) {
    all.segment<3>(next) = u.segment<3>(3 * Eigen::Index{original});
    next += 3;
  }
  return all;
}

OpenedScene open_scene(const Scene& before, std::int32_t stage) {
  OpenedScene result{before, {}};
  Body& body = result.scene.body;
  OpenedMesh opened = open_mesh(body.mesh, body.cut.faces, stage);
  body.mesh = std::move(opened.mesh);
  body.cut.stage = stage;
  const auto extend = [&](auto& values) {
    if (values.empty()) return;
    values.reserve(body.mesh.points.size());
    for (const Index original : opened.originals) values.push_back(values[original]);
  };
  extend(body.fixed);
  extend(body.touchable);
  extend(body.held_directions);
  extend(body.support_stiffness);
  extend(body.applied_pressure);
  extend(body.applied_traction);
  result.originals = std::move(opened.originals);
  return result;
}

std::vector<Scene> open_stages(const Scene& closed) {
  const Cut& cut = closed.body.cut;
  if (cut.faces.empty()) throw InputError("The body has no cut. Apply Place Cut to it.");
  if (cut.stage != 0) {
    throw InputError("The cut of the body is open up to stage " + std::to_string(cut.stage) +
                     ". Set Stage of Place Cut to 0, to compute all stages.");
  }
  std::vector<Scene> scenes;
  for (auto stage = static_cast<std::int32_t>(cut.areas.size()) - 1; stage >= 0; --stage) {
    scenes.push_back(open_scene(closed, stage).scene);
  }
  return scenes;
}

}  // namespace palpate
