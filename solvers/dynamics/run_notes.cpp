// SPDX-License-Identifier: BSD-3-Clause
#include "dynamics/run_notes.h"

#include <sstream>

#include "equilibrium/explanation.h"

namespace palpate {

void RunNotes::add(const DynamicState& state) {
  ++num_states_;
  if ((state.flags & flags::inverted) != 0) {
    if (num_inverted_++ == 0 || state.minimum_det_f < worst_det_f_) {
      worst_time_ = state.motion.time;
      worst_det_f_ = state.minimum_det_f;
      worst_cell_ = state.minimum_det_f_cell;
    }
  }
  if ((state.flags & flags::inaccurate) != 0 && num_inaccurate_++ == 0) {
    first_inaccurate_ = state.motion.time;
  }
}

std::string RunNotes::describe(const TetMesh& mesh, const Assembly& assembly,
                               double shortest) const {
  std::ostringstream text;
  if (num_inverted_ > 0) {
    text << "In " << num_inverted_ << " of " << num_states_
         << " states cells are inverted: the worst is " << describe_cell(mesh, worst_cell_)
         << " at " << worst_time_ << " s with det F = " << worst_det_f_
         << ". Move the tools less far, give those that hold the body a TipRadius, or refine the "
            "mesh there"
         << advise_finer_quadrature(assembly) << ". ";
  }
  if (num_inaccurate_ > 0) {
    text << num_inaccurate_ << " steps, the first up to " << first_inaccurate_
         << " s, are less accurate than StepTolerance asks for: no step may be shorter than "
         << shortest << " s (TimeStep, halved MaximumHalvings times). ";
  }
  std::string message = text.str();
  if (!message.empty()) message.pop_back();
  return message;
}

}  // namespace palpate
