// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/servo/reduced_touch.h"

#include <string>
#include <utility>

#include "base/error.h"
#include "haptic/simulating/coupled_tool.h"

namespace palpate {

ReducedTouch::ReducedTouch(std::unique_ptr<ReducedBodyThread> body,
                           std::vector<std::unique_ptr<Servo>> servos)
    : body_(std::move(body)), servos_(std::move(servos)) {
  const Index num_tools = body_->num_tools();
  if (servos_.size() > static_cast<std::size_t>(num_tools)) {
    throw InputError("There are " + std::to_string(servos_.size()) +
                     " servo loops, but the reduced model has " + std::to_string(num_tools) +
                     " tool(s). Give one for each at the most.");
  }
  servos_.resize(static_cast<std::size_t>(num_tools));
  for (Index tool = 0; tool < num_tools; ++tool) {
    if (Servo* moves = servo(tool))
      moves->set_touch(std::make_unique<CoupledTool>(body_->tool(tool)));
  }
}

ReducedTouch::~ReducedTouch() { stop(); }

void ReducedTouch::start() {
  try {
    body_->start();
    for (const auto& servo : servos_) {
      if (servo) servo->start();
    }
  } catch (...) {
    stop();
    throw;
  }
}

void ReducedTouch::host_lives() noexcept {
  for (const auto& servo : servos_) {
    if (servo) servo->host_lives();
  }
}

std::vector<Index> ReducedTouch::lost() {
  std::vector<Index> lost;
  for (std::size_t tool = 0; tool < servos_.size(); ++tool) {
    if (!servos_[tool]) continue;
    const ServoState state = servos_[tool]->latest().state;
    if (state == ServoState::gone || state == ServoState::closed) {
      lost.push_back(static_cast<Index>(tool));
    }
  }
  return lost;
}

std::vector<Index> ReducedTouch::stop() noexcept {
  for (const auto& servo : servos_) {
    if (servo) servo->let_go();
  }
  std::vector<Index> hanging;
  for (std::size_t tool = 0; tool < servos_.size(); ++tool) {
    if (servos_[tool] && !servos_[tool]->stop()) hanging.push_back(static_cast<Index>(tool));
  }
  body_->stop();
  return hanging;
}

Servo* ReducedTouch::servo(Index tool) { return servos_.at(static_cast<std::size_t>(tool)).get(); }

}  // namespace palpate
