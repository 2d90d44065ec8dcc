// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/training_run.h"

#include <algorithm>
#include <limits>
#include <map>

#include "schedule/packing.h"

namespace palpate {
namespace {

/// The states as columns of u and of the tools' coordinates; a state that was left out is a column
/// of NaN.
Eigen::MatrixXd matrix_of(const TrainingStates& states) {
  const Eigen::Index count = states.u.cols();
  // A matrix without any state has one row.
  const Eigen::Index rows = std::max<Eigen::Index>(1, states.u.rows() + states.tools.rows());
  Eigen::MatrixXd matrix(rows, count + states.num_left_out);
  matrix.topLeftCorner(states.u.rows(), count) = states.u;
  matrix.bottomLeftCorner(states.tools.rows(), count) = states.tools;
  matrix.rightCols(states.num_left_out).setConstant(std::numeric_limits<double>::quiet_NaN());
  return matrix;
}

/// The number of columns that are states; the columns behind them were left out.
Eigen::Index count_states(const Eigen::MatrixXd& matrix) {
  Eigen::Index count = matrix.cols();
  while (count > 0 && matrix.col(count - 1).array().isNaN().all()) --count;
  return count;
}

/// Whether a stored matrix can be the result of a part: it has u and d of each state, within the
/// bound of the displacements.
bool fits(const Eigen::MatrixXd& matrix, const TrainingPart& part) {
  if (matrix.rows() == 0) return false;
  const Eigen::Index count = count_states(matrix);
  return (count == 0 || matrix.rows() == part.num_body_coordinates + part.num_tool_coordinates) &&
         (matrix.leftCols(count).array().abs() <= part.farthest).all();
}

/// @param matrix It fits the part.
TrainingStates states_of(const Eigen::MatrixXd& matrix, const TrainingPart& part) {
  TrainingStates states;
  const Eigen::Index count = count_states(matrix);
  states.num_left_out = static_cast<int>(matrix.cols() - count);
  if (count == 0) return states;
  states.u = matrix.leftCols(count).topRows(part.num_body_coordinates);
  states.tools = matrix.leftCols(count).bottomRows(part.num_tool_coordinates);
  return states;
}

}  // namespace

bool train(const std::vector<TrainingPart>& parts, const TrainingRun& run,
           const std::function<bool()>& abort_requested, std::vector<TrainingStates>& states) {
  Communicator& communicator = run.communicator;
  bool aborted = false;
  agree(communicator, [&] {
    std::map<std::string, Eigen::MatrixXd> found;
    if (run.file != nullptr) found = run.file->reduced_models().read_training(run.key);
    // A stored part that does not fit this training is computed again, and replaced.
    std::vector<char> is_found;
    for (const TrainingPart& part : parts) {
      const auto stored = found.find(part.name);
      is_found.push_back(stored != found.end() && fits(stored->second, part) ? 1 : 0);
    }
    is_found = of_first(is_found, communicator);
    std::vector<std::size_t> missing;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (is_found[p] == 0) missing.push_back(p);
    }
    // In each round each rank computes a part, and rank 0 stores them all.
    const auto num_ranks = static_cast<std::size_t>(communicator.size());
    const auto rank = static_cast<std::size_t>(communicator.rank());
    for (std::size_t first = 0; first < missing.size() && !aborted; first += num_ranks) {
      Packer mine;
      bool is_aborted = false;
      if (first + rank < missing.size()) {
        const Eigen::MatrixXd matrix = matrix_of(parts[missing[first + rank]].compute());
        is_aborted = abort_requested && abort_requested();
        if (!is_aborted) mine.put(matrix);
      }
      const std::vector<Bytes> all = communicator.gather(mine.take());
      for (std::size_t r = 0; r < all.size(); ++r) {
        if (all[r].empty()) continue;
        const std::string& name = parts[missing[first + r]].name;
        found[name] = Unpacker(all[r]).take<Eigen::MatrixXd>();
        if (run.file != nullptr)
          run.file->reduced_models().add_training(run.key, name, found[name]);
      }
      aborted = any(communicator, is_aborted);
    }
    if (aborted || rank != 0) return;
    for (const TrainingPart& part : parts) {
      states.push_back(states_of(found.at(part.name), part));
    }
  });
  return !aborted;
}

}  // namespace palpate
