// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/opened_scene.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"
#include "cutting/opened_mesh.h"

namespace palpate {

Scene open_scene(const Scene& closed, std::int32_t stage, double area) {
  Scene scene = closed;
  Body& body = scene.body;
  OpenedMesh opened = open_mesh(body.mesh, body.cut.faces, stage);
  body.mesh = std::move(opened.mesh);
  body.cut.stage = stage;
  body.cut.area = area;
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
  return scene;
}

std::vector<Scene> open_stages(const Scene& closed, const std::vector<double>& areas) {
  const Cut& cut = closed.body.cut;
  std::int32_t last = 0;
  for (const OpenedFaces& of_cell : cut.faces) {
    last = std::max(last, *std::max_element(of_cell.begin(), of_cell.end()));
  }
  if (last == 0) throw InputError("The body has no cut. Apply Place Cut to it.");
  if (cut.stage != 0) {
    throw InputError("The cut of the body is open up to stage " + std::to_string(cut.stage) +
                     ". Set Stage of Place Cut to 0, to compute all stages.");
  }
  const bool grows = std::adjacent_find(areas.begin(), areas.end(),
                                        [](double a, double b) { return !(a < b); }) == areas.end();
  if (areas.size() != static_cast<std::size_t>(last) + 1 || areas.front() != 0 || !grows) {
    throw InputError(
        "The areas of the stages of the cut do not grow from 0 on, or there is not one for each of "
        "the " +
        std::to_string(last) + " stages. Apply Place Cut again.");
  }
  std::vector<Scene> scenes;
  for (std::int32_t stage = last; stage >= 0; --stage) {
    scenes.push_back(open_scene(closed, stage, areas[static_cast<std::size_t>(stage)]));
  }
  return scenes;
}

}  // namespace palpate
