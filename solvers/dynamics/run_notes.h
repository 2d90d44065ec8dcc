// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "assembly/assembly.h"
#include "dynamics/dynamic_solver.h"

namespace palpate {

/// Collects what is notable about the states of a run.
class RunNotes {
 public:
  /// @param parts_touch Whether parts of the body touch each other.
  explicit RunNotes(bool parts_touch) : parts_touch_(parts_touch) {}

  void add(const DynamicState& state);
  /// Tells what was notable; empty: nothing was.
  /// @param shortest The shortest step that is permitted, s.
  [[nodiscard]] std::string describe(const TetMesh& mesh, const Assembly& assembly,
                                     double shortest) const;

 private:
  int num_states_ = 0;
  /// The number of states with inverted cells; and time, least det F and cell of the worst of them.
  int num_inverted_ = 0;
  double worst_time_ = 0;
  double worst_det_f_ = 0;
  Index worst_cell_ = -1;
  /// The number of steps that are less accurate than was asked for, and the end of the first of
  /// them, s.
  int num_inaccurate_ = 0;
  double first_inaccurate_ = 0;
  bool parts_touch_;
  /// What the balance of energy is short of at the least so far, by how much it has risen from
  /// there at the most, the end of the step in which it was first too much, and the largest energy
  /// of the body, J.
  double least_balance_ = 0;
  double most_made_ = 0;
  double first_made_ = 0;
  double largest_energy_ = 0;
};

}  // namespace palpate
