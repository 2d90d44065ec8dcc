// SPDX-License-Identifier: BSD-3-Clause
// A reduced model in which nothing is reduced: its modes are a basis of all displacements, and it
// keeps all points with the weights that they have.
#pragma once

#include <numeric>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "reduction/body_points.h"
#include "reduction/build_reduced_model.h"
#include "reduction/reduced_basis.h"

namespace palpate::test {

struct WholeModel {
  ReducedModel model;
  Eigen::MatrixXd basis;
  NodalVector rest;
};

inline WholeModel make_whole_model(const Scene& scene, const std::vector<Rheology>& rheologies,
                                   const InteractionList& tools, double reach = 0.01,
                                   const Vec3& gravity = Vec3::Zero()) {
  EquilibriumSolver solver(with_gravity(scene, rheologies, gravity), {});
  const NodalVector under_weight = solver.settled().u;
  solver.set_interaction(tools);
  const Equilibrium rest = solver.rest();
  const RestStiffness stiffness(solver.assembly(), under_weight);
  std::vector<char> held(scene.body.fixed);
  for (const PrescribedPoint& p : tools.prescribed_points()) held[p.point] = 1;
  std::vector<Eigen::Index> free;
  for (std::size_t p = 0; p < held.size(); ++p) {
    for (Eigen::Index i = 0; i < 3 && held[p] == 0; ++i) {
      free.push_back(3 * static_cast<Eigen::Index>(p) + i);
    }
  }
  Eigen::MatrixXd fields = Eigen::MatrixXd::Zero(rest.u.size(), free.size());
  for (std::size_t c = 0; c < free.size(); ++c) fields(free[c], c) = 1;
  ModeBuilder modes(stiffness, fields.rows());
  modes.add(fields, fields.cols());
  WholeModel whole;
  whole.rest = rest.u;
  whole.basis.resize(fields.rows(), fields.cols() + rest.v.cols());
  whole.basis << modes.modes(), rest.v;
  const BodyPoints points(scene);
  std::vector<Index> all(points.count());
  std::iota(all.begin(), all.end(), 0);
  // Modes are as far as a tool that has moved by the reach would have their energy.
  Eigen::VectorXd range(whole.basis.cols());
  range.head(fields.cols()).setConstant(reach * std::sqrt(rest.stiffness.diagonal().maxCoeff()));
  range.tail(rest.v.cols()).setConstant(reach);
  whole.model = make_reduced_model(scene, rheologies, whole.basis, rest.stiffness, all,
                                   points.weights(), range, under_weight);
  return whole;
}

}  // namespace palpate::test
