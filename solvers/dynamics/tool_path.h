// SPDX-License-Identifier: BSD-3-Clause
// The way of the tools in time.
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate {

/// Coordinates of the tools between those that are given: a cubic with a continuous velocity, which
/// goes beyond none of two neighbouring values (Fritsch & Carlson, SIAM J. Numer. Anal. 17, 1980,
/// with the slopes of Fritsch & Butland). Before the first time and after the last the tools stand
/// still. Three coordinates are those of one tool, which may be let go at some time.
class ToolPath {
 public:
  /// The tools stand still at these coordinates [d].
  explicit ToolPath(const Eigen::VectorXd& coordinates);
  /// @param times Ascending, s [n]. @param coordinates [d × n], m.
  /// @throws InputError no time, sizes that differ, times that do not ascend, a number that is
  /// none.
  ToolPath(std::vector<double> times, Eigen::MatrixXd coordinates);

  [[nodiscard]] Index num_coordinates() const { return static_cast<Index>(coordinates_.rows()); }
  [[nodiscard]] double end() const { return times_.back(); }
  /// From a time on, s, nothing holds a tool, and it stays so.
  /// @throws InputError a tool that there is not, a time that is no number.
  void let_go(Index tool, double time);
  /// When a tool is let go, s; infinite: it is not.
  [[nodiscard]] double release(Index tool) const { return releases_[tool]; }
  /// The first time after `time` at which a tool is let go, s; infinite: there is none.
  [[nodiscard]] double next_release(double time) const;
  /// [d], m. A tool that was let go stays where it was then.
  [[nodiscard]] Eigen::VectorXd at(double time) const;

 private:
  [[nodiscard]] Eigen::VectorXd held_at(double time) const;

  std::vector<double> times_;
  Eigen::MatrixXd coordinates_;
  /// Velocity at each time, m/s [d × n].
  Eigen::MatrixXd slopes_;
  /// Of each tool, s.
  std::vector<double> releases_;
};

}  // namespace palpate
