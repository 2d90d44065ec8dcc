// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateToolRoute.h"

#include <utility>

#include "equilibrium/tangent_solver.h"
#include "interaction/bonded_patch.h"
#include "interaction/tool_clearance.h"
#include "vtkPalpateActiveNodes.h"

namespace
{
/// A factor of more takes too long to be made without being asked for.
constexpr long MostUnknownsTriedAgain = 150000;

/// Solves for the equal parts of the way from where a tool starts to t, one after the other, as far
/// as they converge.
palpate::Equilibrium SolveParts(palpate::EquilibriumSolver& solver, const Eigen::VectorXd& start,
  const Eigen::VectorXd& t, int increments)
{
  palpate::Equilibrium state = solver.rest(start);
  for (int increment = 0; increment < increments && state.outcome == palpate::Outcome::converged;
       ++increment)
  {
    palpate::Equilibrium next = solver.solve(increment + 1 == increments
        ? t
        : Eigen::VectorXd(start + (t - start) * (increment + 1) / increments),
      state);
    next.summary.iterations += state.summary.iterations;
    next.summary.steps += state.summary.steps;
    next.summary.seconds += state.summary.seconds;
    for (palpate::Fold& fold : next.summary.folds)
    {
      fold.way = (increment + fold.way) / increments;
    }
    next.summary.folds.insert(
      next.summary.folds.begin(), state.summary.folds.begin(), state.summary.folds.end());
    state = std::move(next);
  }
  return state;
}

palpate::Equilibrium Solve(const palpate::Scene& scene, const vtkPalpateToolRoute& route,
  int increments, palpate::EquilibriumSolver& solver)
{
  Eigen::VectorXd start = route.Start;
  if (scene.has_load())
  {
    palpate::Equilibrium rest = solver.settled();
    if (rest.outcome != palpate::Outcome::converged)
    {
      const Eigen::Index coordinates = start.size();
      rest.t = start;
      rest.reaction.setZero(coordinates);
      rest.stiffness.setZero(coordinates, coordinates);
      return rest;
    }
    if (route.Contact)
    {
      // The tool starts where it is clear of the body as it lies.
      start = route.Contact->coordinates(palpate::ToolClearance(
        scene.body, { rest.u, rest.p }, palpate::make_contact(scene.body, route.Rigid))
                                           .start_for(route.End.head<3>()));
    }
  }
  solver.set_interaction(*route.Tool);
  palpate::Equilibrium state;
  if (route.Near.size() > 0)
  {
    state.t = route.End;
    state.u = route.Near;
    state = solver.settle(state);
  }
  if (state.outcome != palpate::Outcome::converged)
  {
    state = SolveParts(solver, start, route.End, increments);
  }
  const double ofRest = solver.settled().energy;
  state.energy += ofRest;
  for (palpate::Fold& fold : state.summary.folds)
  {
    fold.energy += ofRest;
    fold.landing_energy += ofRest;
  }
  return state;
}
}

vtkPalpateToolRoute vtkPalpateBondedRoute(const palpate::Scene& scene,
  const std::vector<vtkIdType>& nodes, double tipRadius, const Eigen::VectorXd& displacements)
{
  vtkPalpateToolRoute route;
  route.Tool =
    palpate::BondedPatches(scene.body, tipRadius).around_each(vtkPalpateActiveNodes(nodes)).clone();
  route.End = displacements;
  route.Start = Eigen::VectorXd::Zero(route.Tool->num_coordinates());
  return route;
}

vtkPalpateToolRoute vtkPalpateContactRoute(
  const palpate::Scene& scene, const palpate::RigidTool& tool, const palpate::Vec3& place)
{
  vtkPalpateToolRoute route;
  route.Rigid = palpate::with_defaults(tool, scene);
  const palpate::RigidContact contact = palpate::make_contact(scene.body, route.Rigid);
  route.End = contact.coordinates(place);
  route.Start =
    contact.coordinates(palpate::ToolClearance(scene.body, {}, contact).start_for(place));
  route.Tool = contact.clone();
  route.Contact = static_cast<const palpate::RigidContact*>(route.Tool.get());
  return route;
}

palpate::Equilibrium vtkPalpateFollow(const palpate::Scene& scene, const vtkPalpateToolRoute& route,
  const vtkPalpateFollowOptions& follow, const palpate::EquilibriumOptions& options,
  palpate::EquilibriumSolver& solver)
{
  palpate::Equilibrium state = Solve(scene, route, follow.Increments, solver);
  // What is beyond a fold, and tangents that are hard to solve for, need a factor.
  const bool needsFactor = state.outcome == palpate::Outcome::not_converged ||
    state.outcome == palpate::Outcome::tangent_not_solved;
  if (follow.MayFactorise && needsFactor &&
    palpate::count_unknowns(scene) <= MostUnknownsTriedAgain)
  {
    solver = palpate::EquilibriumSolver(scene, options, palpate::make_linear_solver());
    state = Solve(scene, route, follow.Increments, solver);
  }
  return state;
}
