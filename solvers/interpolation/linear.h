// SPDX-License-Identifier: BSD-3-Clause
// The force of a linear body: the stiffness at rest times t, and Π = ½ t·k t. It is what elementary
// displacements [Cotin] give for one node, and serves as a baseline.
//
// [Cotin] Cotin, Delingette & Ayache, Real-time Elastic Deformations of Soft Tissues for Surgery
// Simulation, IEEE TVCG 5 (1999).
#pragma once

#include "interpolation/interpolator.h"

namespace palpate {

class Linear final : public Interpolator {
 public:
  /// @throws InputError there is no usable configuration at rest; and as Interpolator.
  explicit Linear(const TouchToolSpace& tool_space);

 private:
  void do_evaluate(const Location& at, TouchResult& result) const noexcept override;
  void do_add_memory(MemoryRanges& ranges) const override {
    ranges.push_back({this, sizeof *this});
  }

  Mat3 stiffness_;
};

}  // namespace palpate
