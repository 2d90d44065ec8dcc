// SPDX-License-Identifier: BSD-3-Clause
// The way that a tool goes on a body from where it touches nothing, and the equilibrium at its end.
#pragma once

#include <memory>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "interaction/rigid_tool.h"
#include "vtkType.h"

struct vtkPalpateToolRoute
{
  std::unique_ptr<palpate::Interaction> Tool;
  Eigen::VectorXd Start;
  Eigen::VectorXd End;
  /// Displacements near the equilibrium at the end [3 × points], m; empty: none are known. If it is
  /// not found from there, the tool comes from its start.
  palpate::NodalVector Near;
  /// The same tool where it is a rigid one, else null, and what it is made of.
  const palpate::RigidContact* Contact = nullptr;
  palpate::RigidTool Rigid;

  /// Of what there is by coordinate the part that is a force, three numbers for each tool: a rigid
  /// tool that is turned has coordinates besides those of its place.
  Eigen::VectorXd ForceOf(const Eigen::VectorXd& byCoordinate) const
  {
    return this->Contact ? Eigen::VectorXd(byCoordinate.head(3)) : byCoordinate;
  }
};

/// Nodes that are moved, each with the patch of its tip.
/// @param displacements Of the nodes, in their order [3 × nodes], m.
/// @throws palpate::InputError a node cannot be moved, or a patch reaches another or a fixed point.
vtkPalpateToolRoute vtkPalpateBondedRoute(const palpate::Scene& scene,
  const std::vector<vtkIdType>& nodes, double tipRadius, const Eigen::VectorXd& displacements);

/// A rigid tool that is brought to a place, m. It is turned there before it comes.
/// @param tool See palpate::with_defaults().
/// @throws palpate::InputError the tool is not valid, or there is no way to the place.
vtkPalpateToolRoute vtkPalpateContactRoute(
  const palpate::Scene& scene, const palpate::RigidTool& tool, const palpate::Vec3& place);

struct vtkPalpateFollowOptions
{
  /// The way is gone in so many equal parts, at least 1.
  int Increments = 1;
  /// Whether a solver with a factor takes over from one without that does not come to the end, if
  /// the body is not too large for it.
  bool MayFactorise = false;
};

/// @param options With which a solver that takes over is made.
/// @param solver Of the scene. It is replaced where one with a factor takes over.
/// @returns The equilibrium at the end, or the last one on the way. Its energy counts from the body
///   of the mesh.
palpate::Equilibrium vtkPalpateFollow(const palpate::Scene& scene, const vtkPalpateToolRoute& route,
  const vtkPalpateFollowOptions& follow, const palpate::EquilibriumOptions& options,
  palpate::EquilibriumSolver& solver);
