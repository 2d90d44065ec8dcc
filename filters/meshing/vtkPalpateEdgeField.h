// SPDX-License-Identifier: BSD-3-Clause
// How long the edges of tetrahedra may be, place by place: short in a region and at given places,
// and longer in proportion to the distance from there.
#pragma once

#include <array>
#include <vector>

#include "vtkPalpateSurface.h"
#include "vtkSmartPointer.h"

class vtkImplicitFunction;
class vtkKdTreePointLocator;

/// What is asked for.
struct vtkPalpateEdges
{
  vtkImplicitFunction* Region =
    nullptr;             ///< negative where edges shall be no longer than RegionEdge
  double RegionEdge = 0; ///< m; 0: the region has none of its own

  struct Source
  {
    double Edge; ///< m
    vtkPalpatePoint Place;
  };
  std::vector<Source> Sources; ///< places where edges shall be no longer than that

  double Growth = 0.4; ///< by how much longer an edge may be a metre away from there

  [[nodiscard]] bool AnyAsked() const
  {
    return (this->Region && this->RegionEdge > 0) || !this->Sources.empty();
  }
};

class vtkPalpateEdgeField
{
public:
  /// @param bounds Of the body, m.
  /// @throws palpate::InputError the region has no point in these bounds.
  vtkPalpateEdgeField(vtkPalpateEdges edges, const std::array<double, 6>& bounds);
  ~vtkPalpateEdgeField();

  /// The longest edge that is allowed at a place, m.
  [[nodiscard]] double At(const vtkPalpatePoint& place) const;

private:
  vtkPalpateEdges Edges;
  /// The points of a grid that lie in the region, and half of their distance, m.
  vtkSmartPointer<vtkKdTreePointLocator> Within;
  double HalfSpacing = 0;
};
