// SPDX-License-Identifier: BSD-3-Clause
#include "dynamics/run_notes.h"

#include <algorithm>
#include <sstream>

#include "equilibrium/explanation.h"

namespace palpate {

namespace {

/// The share of the largest energy that a motion may make without a word.
constexpr double kMadeShare = 0.1;

}  // namespace

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
  const EnergyAccount& energy = state.energy;
  const double of_body = energy.kinetic + energy.elastic + energy.viscous_stored;
  const double balance = of_body + energy.weight + energy.dissipated - energy.work;
  if (num_states_ == 1) least_balance_ = balance;
  least_balance_ = std::min(least_balance_, balance);
  largest_energy_ = std::max(largest_energy_, of_body);
  const double made = balance - least_balance_;
  if (most_made_ <= kMadeShare * largest_energy_ && made > kMadeShare * largest_energy_) {
    first_made_ = state.motion.time;
  }
  most_made_ = std::max(most_made_, made);
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
  if (parts_touch_ && most_made_ > kMadeShare * largest_energy_) {
    text
        << "The motion has made " << most_made_ << " J, where its largest energy is "
        << largest_energy_ << " J, first before " << first_made_
        << " s: this method and step do not keep the balance of energy where parts hit each other. "
           "Choose BDF2 as Integrator, a shorter TimeStep, or a StepTolerance. ";
  }
  std::string message = text.str();
  if (!message.empty()) message.pop_back();
  return message;
}

}  // namespace palpate
