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

  /// For each triangle the compartments behind it and in front of it, where its normal points to.
  std::vector<std::array<int, 2>> Sides;
  /// The volume of each compartment, m³: that of the space within its outer boundary, without the
  /// compartments inside. That of the outside is 0.
  std::vector<double> Volume;
  /// The tissue of each compartment, or without tissues a number of its own, in the order of the
  /// surfaces; Empty for a cavity and the outside.
  std::vector<int> Region;
  /// The connected part of the walls that encloses each compartment; −1 for the outside.
  std::vector<int> Part;
  /// The walls that enclose each compartment, without those of the compartments inside it, with
  /// normals outwards. That of the outside is empty.
  std::vector<vtkPalpateSurface> Boundary;

  /// Two tissues that claim the same compartment.
  struct Overlap
  {
    int Compartment;
    std::array<int, 2> Tissues;
  };
  std::vector<Overlap> Overlaps;
  /// Compartments whose walls name several tissues, where no tissue has all of the walls. The
  /// tissue with the largest share has the compartment.
  std::vector<int> Doubtful;
  /// Edges at which tissues are connected by the edge alone: more than two walls around the edge
  /// have tissue on one side only.
  std::vector<std::array<vtkIdType, 2>> Hinges;

  int Count() const { return static_cast<int>(Volume.size()); }
};

/// Finds the compartments. A compartment is a cavity if the normals of all walls around it point
/// into it, with respect to a surface with normals outwards, and none of its walls borders the
/// outside or another cavity. It does not matter whether the normals of a surface as a whole point
/// outwards. Where walls cross each other or have open edges, compartments are joined.
/// @pre No triangle is without an area.
PALPATESURFACE_EXPORT vtkPalpateCompartments vtkPalpateFindCompartments(
  const vtkPalpateWalls& walls);

/// The compartment that a point is in. @pre The point is not near a wall.
PALPATESURFACE_EXPORT int vtkPalpateCompartmentOf(
  const vtkPalpateCompartments& compartments, const vtkPalpatePoint& x);

/// The middle of a compartment's boundary, m, by which a message says where it is.
PALPATESURFACE_EXPORT vtkPalpatePoint vtkPalpateMiddleOf(
  const vtkPalpateCompartments& compartments, int compartment);
