// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/training.h"

#include "reduction/random_path.h"

namespace palpate {
namespace {

Eigen::MatrixXd as_columns(const std::vector<Eigen::VectorXd>& columns, Eigen::Index rows) {
  Eigen::MatrixXd matrix(rows, static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) matrix.col(c) = columns[c];
  return matrix;
}

}  // namespace

Eigen::MatrixXd side_by_side(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (a.cols() == 0) return b;
  if (b.cols() == 0) return a;
  Eigen::MatrixXd both(a.rows(), a.cols() + b.cols());
  both << a, b;
  return both;
}

void TrainingStates::append(const TrainingStates& others) {
  u = side_by_side(u, others.u);
  tools = side_by_side(tools, others.tools);
  num_left_out += others.num_left_out;
}

Eigen::MatrixXd one_tool_places(int num_tools, double reach) {
  std::vector<Eigen::VectorXd> places;
  for (int tool = 0; tool < num_tools; ++tool) {
    for (const double size : {0.5, 1.0}) {
      for (int at = 0; at < 27; ++at) {
        if (at == 13) continue;  // at rest
        Eigen::VectorXd place = Eigen::VectorXd::Zero(3 * num_tools);
        place.segment<3>(3 * tool) = size * reach * Vec3(at % 3 - 1, at / 3 % 3 - 1, at / 9 - 1);
        places.push_back(place);
      }
    }
  }
  return as_columns(places, 3 * num_tools);
}

Eigen::MatrixXd random_places(int num_tools, double reach, int count, std::uint64_t seed) {
  RandomNumbers random(seed);
  Eigen::MatrixXd places(3 * num_tools, count);
  for (int c = 0; c < count; ++c) {
    for (double& x : places.col(c)) x = reach * random.uniform(-1, 1);
    if (c % 2 == 0) places.col(c) *= reach / places.col(c).cwiseAbs().maxCoeff();
  }
  return places;
}

TrainingStates find_equilibria(EquilibriumSolver& solver, const Eigen::MatrixXd& places) {
  std::vector<Eigen::VectorXd> u;
  std::vector<Eigen::VectorXd> tools;
  TrainingStates states;
  const Equilibrium rest = solver.rest();
  for (Eigen::Index c = 0; c < places.cols(); ++c) {
    const Equilibrium state = solver.solve(places.col(c), rest, Tangent::rough);
    if (state.outcome != Outcome::converged) {
      ++states.num_left_out;
      continue;
    }
    u.push_back(state.u);
    tools.emplace_back(places.col(c));
  }
  states.u = as_columns(u, rest.u.size());
  states.tools = as_columns(tools, places.rows());
  return states;
}

TrainingStates move_body(DynamicSolver& solver, const std::vector<ToolPath>& paths, int every) {
  std::vector<Eigen::VectorXd> u;
  std::vector<Eigen::VectorXd> tools;
  TrainingStates states;
  for (const ToolPath& path : paths) {
    int step = 0;
    const DynamicState end = solver.run(path, path.end(), [&](const DynamicState& state) {
      if (++step % every == 0) {
        u.push_back(state.motion.u);
        tools.push_back(state.tools);
      }
      return true;
    });
    if (end.outcome != Outcome::converged) ++states.num_left_out;
  }
  if (u.empty()) return states;
  states.u = as_columns(u, u.front().size());
  states.tools = as_columns(tools, tools.front().size());
  return states;
}

}  // namespace palpate
