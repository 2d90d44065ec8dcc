// SPDX-License-Identifier: BSD-3-Clause
// The compartments into which walls divide space.
//
// Around an edge any number of walls may meet: the sides of them that face each other bound one
// compartment, so that sides hang together to the boundaries of compartments (the cells of an
// arrangement; Q. Zhou et al., Mesh arrangements for solid geometry, 2016, section 3). The order of
// walls around an edge is exact.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "PalpateSurfaceModule.h"
#include "vtkPalpateWalls.h"

struct vtkPalpateCompartments
{
  static constexpr int Outside = 0; ///< the compartment around all
  static constexpr int Empty = -1;  ///< the region of one that holds no tissue

  /// Of each triangle the compartments behind it and in front of it, where its normal points to.
  std::vector<std::array<int, 2>> Sides;
  /// Of each compartment, m³: of what its outer boundary encloses, less what lies within. That of
  /// the outside is 0.
  std::vector<double> Volume;
  /// Of each compartment: its tissue, or where nobody says a number of its own, in the order of the
  /// surfaces; Empty for a cavity and the outside.
  std::vector<int> Region;
  /// Of each compartment: which of the parts of the walls that hang together encloses it; of the
  /// outside −1.
  std::vector<int> Part;
  /// The walls of each compartment that enclose it, its own without those of what lies within, with
  /// normals outwards. That of the outside is empty.
  std::vector<vtkPalpateSurface> Boundary;

  /// Two tissues that claim the same compartment.
  struct Overlap
  {
    int Compartment;
    std::array<int, 2> Tissues;
  };
  std::vector<Overlap> Overlaps;
  /// Compartments of which the walls name several tissues, none of them all of it: the one with the
  /// largest share has it.
  std::vector<int> Doubtful;
  /// Edges at which tissues hang together by the edge alone: more than two walls around it have
  /// tissue on one side only.
  std::vector<std::array<vtkIdType, 2>> Hinges;

  int Count() const { return static_cast<int>(Volume.size()); }
};

/// A compartment is a cavity where all walls around it have their normals into it, seen from a
/// surface with normals outwards, and no wall of it borders the outside or another cavity. Whether
/// the normals of a surface point outwards as a whole is of no account.
/// @pre No triangle is without an area. Where walls cross each other or have open edges,
/// compartments run together.
PALPATESURFACE_EXPORT vtkPalpateCompartments vtkPalpateFindCompartments(
  const vtkPalpateWalls& walls);

/// The compartment that a point is in.
/// @pre It is none of the points near a wall.
PALPATESURFACE_EXPORT int vtkPalpateCompartmentOf(
  const vtkPalpateCompartments& compartments, const vtkPalpatePoint& x);

/// The middle of a compartment's boundary, m: where to look for it.
PALPATESURFACE_EXPORT vtkPalpatePoint vtkPalpateMiddleOf(
  const vtkPalpateCompartments& compartments, int compartment);
