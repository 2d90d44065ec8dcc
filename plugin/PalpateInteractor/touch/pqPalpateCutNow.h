// SPDX-License-Identifier: BSD-3-Clause
/// Cuts the body of a state space along a sheet that nobody has foreseen, while it is touched.
#pragma once

#include <array>

class pqOutputPort;

/// Where the tool is.
struct pqPalpateHeldTool
{
  /// Whether it holds a node of the body or presses it; else the body is at rest.
  bool Touches = false;
  /// The node that it holds; −1: it is a rigid tool.
  int Node = -1;
  /// How far the node is moved, or where the centre of the rigid tool is, m.
  std::array<double, 3> Place{};
};

/// Puts filters before the Precompute State Space that makes a space: Solve Equilibrium, for the
/// body as the tool holds it now, and Cut Now along the sheet. Then it has the space computed anew,
/// with its active nodes at the same places, and with a file of its own.
/// @throws std::runtime_error the space was not made by Precompute State Space, has the stages of a
///   cut, or the cut cannot be made. The pipeline is as before then.
void pqPalpateCutNow(pqOutputPort* space, pqOutputPort* sheet, const pqPalpateHeldTool& tool);
