// SPDX-License-Identifier: BSD-3-Clause
// The path of the tools in time.
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate {

/// Interpolates the coordinates of the tools by a cubic with a continuous velocity that stays
/// between each two neighbouring values (Fritsch & Carlson, SIAM J. Numer. Anal. 17, 1980, with the
/// slopes of Fritsch & Butland). Before the first time and after the last, the tools stand still.
/// Each tool has three coordinates, and may be let go at some time.
class ToolPath {
 public:
  /// A path on which the tools stand still at these coordinates [d], m.
  explicit ToolPath(const Eigen::VectorXd& coordinates);
  /// @param times Ascending, s [n].
  /// @param coordinates [d × n], m.
  /// @throws InputError no time, sizes that differ, times that do not ascend, or a number that is
  ///   not finite.
  ToolPath(std::vector<double> times, Eigen::MatrixXd coordinates);

  [[nodiscard]] Index num_coordinates() const { return static_cast<Index>(coordinates_.rows()); }
  [[nodiscard]] double end() const { return times_.back(); }
  /// Lets go of a tool at a time, s, for good.
  /// @throws InputError there is no such tool, or the time is not a number.
  void let_go(Index tool, double time);
  /// The time at which a tool is let go, s; infinite: it is not let go.
  [[nodiscard]] double release(Index tool) const { return releases_[tool]; }
  /// The first time after `time` at which a tool is let go, s; infinite: there is none.
  [[nodiscard]] double next_release(double time) const;
  /// The coordinates at a time [d], m. A tool that was let go stays where it was then.
  [[nodiscard]] Eigen::VectorXd at(double time) const;

 private:
  [[nodiscard]] Eigen::VectorXd held_at(double time) const;

  std::vector<double> times_;
  Eigen::MatrixXd coordinates_;
  /// Velocity at each time, m/s [d × n].
  Eigen::MatrixXd slopes_;
  /// The time at which each tool is let go, s.
  std::vector<double> releases_;
};

}  // namespace palpate
