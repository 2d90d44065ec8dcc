// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/linear.h"

#include "base/error.h"

namespace palpate {

Linear::Linear(const TouchToolSpace& tool_space) : Interpolator(tool_space) {
  const std::int32_t rest = grid().tree().find({0, 0, 0});
  if (rest < 0 || !grid().usable(rest)) {
    throw InputError("The tool space at " + tool_space.setup.name() +
                     " has no usable configuration at rest, whose stiffness 'Linear' takes. " +
                     "Choose another interpolation.");
  }
  stiffness_ = tool_space.configurations[grid().configuration(rest)].stiffness;
  set_linear_from_rest({Vec3::Zero(), stiffness_, 0, Support::extrapolated, {}});
  set_num_samples(1);
}

void Linear::do_evaluate(const Location& at, TouchResult& result) const noexcept {
  const Vec3 t = grid().spacing() * at.x;
  result.force = stiffness_ * t;
  result.stiffness = stiffness_;
  result.energy = 0.5 * t.dot(result.force);
}

}  // namespace palpate
