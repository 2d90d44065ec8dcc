// SPDX-License-Identifier: BSD-3-Clause
// How much of a hand's way lies in computed cells, tick by tick.
#pragma once

#include <set>
#include <vector>

#include "exploration/shell_cells.h"

namespace palpate {

class KnownCells {
 public:
  struct Counts {
    /// The ticks in which the hand was in a root cell of the shell, and in which that cell was
    /// known.
    long in_shell = 0;
    long in_known = 0;
    /// Of each time without a known cell, how long it has been, s.
    std::vector<double> waits;

    /// The share of the ticks in known cells.
    [[nodiscard]] double share() const {
      return in_shell > 0 ? static_cast<double>(in_known) / static_cast<double>(in_shell) : 0;
    }
    /// The wait that a share of all is no longer than, s; 0: there was none.
    [[nodiscard]] double wait(double share) const;
  };

  /// @param cells Those of the space. They must outlive this object.
  explicit KnownCells(ShellCells& cells) : cells_(cells) {}

  /// A configuration was found, or it is known that there is none.
  void add(const CheckPoint& p) { known_.insert(p); }
  /// The hand is at a place until the next tick, s.
  void tick(const Vec3& place, double until_next);
  [[nodiscard]] const Counts& counts() const { return counts_; }
  /// Begins to count anew.
  void reset() { counts_ = {}; }

 private:
  ShellCells& cells_;
  std::set<CheckPoint> known_;
  Counts counts_;
  bool waits_ = false;
};

}  // namespace palpate
