// SPDX-License-Identifier: BSD-3-Clause
#include "dynamics/tool_path.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {

ToolPath::ToolPath(const Eigen::VectorXd& coordinates) : ToolPath({0.0}, coordinates) {}

ToolPath::ToolPath(std::vector<double> times, Eigen::MatrixXd coordinates)
    : times_(std::move(times)), coordinates_(std::move(coordinates)) {
  const auto n = static_cast<Eigen::Index>(times_.size());
  if (n == 0 || coordinates_.cols() != n) {
    throw InputError("The way of the tools has " + std::to_string(n) + " times and " +
                     std::to_string(coordinates_.cols()) +
                     " places. Give a place for each time, and at least one.");
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool ascends = i == 0 || times_[i] > times_[i - 1];
    if (!std::isfinite(times_[i]) || !ascends || !coordinates_.col(i).allFinite()) {
      std::ostringstream time;
      time << std::setprecision(std::numeric_limits<double>::max_digits10) << times_[i];
      throw InputError("Row " + std::to_string(i) + " of the way of the tools, at " + time.str() +
                       " s, is not after the row before, or has a place that is no number. Sort "
                       "the rows by time, and give each time once.");
    }
  }
  slopes_.setZero(coordinates_.rows(), n);
  releases_.assign(static_cast<std::size_t>(num_coordinates() / 3),
                   std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const double before = times_[i] - times_[i - 1];
    const double after = times_[i + 1] - times_[i];
    for (Eigen::Index d = 0; d < coordinates_.rows(); ++d) {
      const double a = (coordinates_(d, i) - coordinates_(d, i - 1)) / before;
      const double b = (coordinates_(d, i + 1) - coordinates_(d, i)) / after;
      // If two rows have nearly the same time, a slope may be infinite.
      if (!(a * b > 0)) continue;
      const double w = (before + 2 * after) / (3 * (before + after));
      slopes_(d, i) = 1 / (w / a + (1 - w) / b);
    }
  }
}

void ToolPath::let_go(Index tool, double time) {
  if (tool < 0 || tool >= static_cast<Index>(releases_.size()) || std::isnan(time)) {
    throw InputError("Tool " + std::to_string(tool) + " cannot be let go at " +
                     quantity(time, "s") + ": there are " + std::to_string(releases_.size()) +
                     " tools, counted from 0, and the time must be a number.");
  }
  releases_[tool] = time;
}

double ToolPath::next_release(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const double release : releases_) {
    if (release > time) next = std::min(next, release);
  }
  return next;
}

Eigen::VectorXd ToolPath::at(double time) const {
  Eigen::VectorXd place = held_at(time);
  for (std::size_t tool = 0; tool < releases_.size(); ++tool) {
    if (releases_[tool] >= time) continue;
    const auto first = static_cast<Eigen::Index>(3 * tool);
    place.segment<3>(first) = held_at(releases_[tool]).segment<3>(first);
  }
  return place;
}

Eigen::VectorXd ToolPath::held_at(double time) const {
  if (time <= times_.front()) return coordinates_.col(0);
  if (time >= times_.back()) return coordinates_.rightCols<1>();
  const auto next = std::upper_bound(times_.begin(), times_.end(), time) - times_.begin();
  const double length = times_[next] - times_[next - 1];
  const double s = (time - times_[next - 1]) / length;
  const double r = 1 - s;
  return r * r * (1 + 2 * s) * coordinates_.col(next - 1) +
         s * s * (1 + 2 * r) * coordinates_.col(next) +
         length * s * r * (r * slopes_.col(next - 1) - s * slopes_.col(next));
}

}  // namespace palpate
