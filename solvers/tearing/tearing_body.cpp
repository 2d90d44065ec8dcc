// SPDX-License-Identifier: BSD-3-Clause
#include "tearing/tearing_body.h"

#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "cutting/opened_scene.h"
#include "soft_contact/soft_contact.h"
#include "tearing/pressed_sides.h"

namespace palpate {

TearingBody::TearingBody(const Scene& scene, double toughness, const Eigen::VectorXd& start,
                         MakeTool make_tool, MakeSolver make_solver)
    : toughness_(toughness),
      start_(start),
      make_tool_(std::move(make_tool)),
      make_solver_(std::move(make_solver)),
      num_first_points_(scene.body.mesh.num_points()) {
  if (scene.body.cut.faces.empty()) {
    throw InputError("The body has no cut along which it could tear. Apply Place Cut to it.");
  }
  if (!(toughness > 0) || !std::isfinite(toughness)) {
    throw InputError("The toughness is " + quantity(toughness, "J/m²") +
                     ", but must be a number above 0.");
  }
  if (scene.has_load()) {
    throw InputError(
        "The body has a load, under which each stage of the cut rests elsewhere, so that the tool "
        "would begin elsewhere too. Take the load away (BodyForce, or that of Set Boundary), or "
        "set FractureToughness to 0.");
  }
  here_ = make(std::make_shared<const Scene>(scene));
  here_->state = here_->solver.rest(start_);
  make_next();
}

std::unique_ptr<TearingBody::AtStage> TearingBody::make(std::shared_ptr<const Scene> scene) const {
  auto body = std::make_unique<AtStage>(
      AtStage{scene, make_solver_(*scene), make_tool_(*scene), Equilibrium()});
  body->solver.set_interaction(*body->tool);
  return body;
}

void TearingBody::make_next() {
  next_.reset();
  const Cut& cut = here_->scene->body.cut;
  if (cut.stage + 1 >= static_cast<std::int32_t>(cut.areas.size())) return;
  OpenedScene opened = open_scene(*here_->scene, cut.stage + 1);
  next_ = make(std::make_shared<const Scene>(opened.scene));
  copies_ = opened.originals;
  if (here_->state.t == start_) {
    next_->state = next_->solver.rest(start_);
    return;
  }
  Equilibrium near;
  near.t = here_->state.t;
  near.u = opened.carry(here_->state.u);
  if (const auto contact = make_soft_contact(*next_->scene)) {
    near.u = press_sides(*next_->scene, next_->solver.assembly(), *contact, std::move(near.u));
  }
  next_->state = next_->solver.settle(near);
  if (next_->state.outcome == Outcome::converged) return;
  next_->state = next_->solver.rest(start_);
  follow(*next_, near.t);
}

void TearingBody::follow(AtStage& body, const Eigen::VectorXd& t) const {
  if (body.state.t == t) return;
  Summary before = std::move(body.state.summary);
  Equilibrium next = body.solver.solve(t, body.state);
  next.summary.iterations += before.iterations;
  next.summary.steps += before.steps;
  next.summary.seconds += before.seconds;
  next.summary.folds.insert(next.summary.folds.begin(), before.folds.begin(), before.folds.end());
  body.state = std::move(next);
}

bool TearingBody::pays() {
  release_rate_ = std::numeric_limits<double>::quiet_NaN();
  if (!next_) return false;
  if (next_->state.outcome != Outcome::converged) {
    here_->state.outcome = next_->state.outcome;
    here_->state.summary.message = "It is not known whether the cut tears beyond stage " +
                                   std::to_string(here_->scene->body.cut.stage) +
                                   ", for the body at the next stage found no equilibrium. " +
                                   next_->state.summary.message;
    return false;
  }
  const Cut& cut = next_->scene->body.cut;
  release_rate_ = (here_->state.energy - next_->state.energy) /
                  (cut.areas[cut.stage] - cut.areas[cut.stage - 1]);
  return release_rate_ >= toughness_;
}

void TearingBody::move(const Eigen::VectorXd& t) {
  if (here_->state.outcome != Outcome::converged) return;
  follow(*here_, t);
  if (here_->state.outcome != Outcome::converged) return;
  if (next_ && next_->state.outcome == Outcome::converged) follow(*next_, t);
  while (pays()) {
    tears_.push_back({t, next_->scene->body.cut.stage, here_->state.energy, next_->state.energy});
    for (const Index point : copies_) {
      const bool is_first = point < num_first_points_;
      originals_.push_back(is_first ? point : originals_[point - num_first_points_]);
    }
    here_ = std::move(next_);
    make_next();
  }
}

}  // namespace palpate
