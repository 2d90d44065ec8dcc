// SPDX-License-Identifier: BSD-3-Clause
#include "palpate_follow/recorded_space.h"

#include <algorithm>

#include "base/error.h"
#include "storage/state_space_file.h"

namespace palpate {

RecordedSpace::RecordedSpace(const std::string& path) {
  const StateSpaceFile file = StateSpaceFile::open_read_only(path);
  bool is_there = false;
  for (const ToolSpace& space : file.read_tool_spaces()) {
    if (is_there || !space.setup.presses() || space.setup.region) continue;
    is_there = true;
    setup_ = space.setup;
  }
  if (!is_there) throw InputError(path + " has no space of a rigid tool on one mesh.");
  body_ = make_space_body(file.read_scene(setup_.body), file.read_rest(setup_.body));
  tools_ = std::make_unique<InteractionFactory>(body_.scene->body, body_.at_rest);
  clearance_ = tools_->clearance(setup_.interaction);
  std::vector<Vec3> pressed;
  for (const Configuration& c : file.read_summaries(setup_.key())) {
    if (c.level != 0) continue;
    configurations_[c.check_point] = c;
    if (!c.usable() || (c.flags & flags::touches_nothing) != 0) continue;
    mean_seconds_ += c.seconds;
    pressed.push_back(clearance_->approach(setup_.grid.place(c.check_point)).touched);
  }
  if (pressed.empty()) throw InputError(path + " has no configuration in which the tool presses.");
  mean_seconds_ /= static_cast<double>(pressed.size());
  find_middle(pressed);
}

void RecordedSpace::find_middle(const std::vector<Vec3>& pressed) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& place : pressed) mean += place;
  mean /= static_cast<double>(pressed.size());
  middle_ = *std::min_element(pressed.begin(), pressed.end(), [&](const Vec3& a, const Vec3& b) {
    return (a - mean).norm() < (b - mean).norm();
  });
}

PrecomputeOptions RecordedSpace::options() const {
  PrecomputeOptions options;
  options.contact.emplace();
  options.contact->tool = setup_.interaction.tool;
  options.contact->spacing = setup_.grid.coarsest * setup_.grid.spacing();
  options.contact->shell.depth = setup_.policy.depth;
  options.contact->shell.begin_at = middle_;
  options.force_limit = setup_.policy.force_limit;
  options.equilibrium.third_derivatives = setup_.policy.third_derivatives;
  options.equilibrium.single_precision = true;
  return options;
}

}  // namespace palpate
