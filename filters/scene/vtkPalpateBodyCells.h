// SPDX-License-Identifier: BSD-3-Clause
// A body has tetrahedra alone, all of 4 points or all of 10. What other programs write has more:
// the triangles, lines and vertices of its border among the tetrahedra, tetrahedra of Lagrange's
// kind, hexahedra, wedges and pyramids. This makes a body of it.
//
//   linear cells     corners become tetrahedra, without new points: vtkDataSetTriangleFilter, which
//                    cuts a face along the diagonal that the order of its point ids says, so that
//                    neighbours agree
//   quadratic ones   the same of their corners, with the midside nodes that they have; in the
//   middle
//                    of a diagonal without a node the shape functions of the cell make a new point
//   higher orders    as quadratic ones: what is between corners and midside nodes is left out
//
// Points keep their ids and come first; cells keep their order and their data.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "PalpateSceneModule.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

class vtkUnstructuredGrid;

struct vtkPalpateBodyCells
{
  vtkSmartPointer<vtkUnstructuredGrid> Body;
  /// The corners that each new point is between.
  std::vector<std::array<vtkIdType, 2>> Added;
  /// A text about what was left out, for a warning; empty if nothing was.
  std::string LeftOut;
};

/// Makes a body of tetrahedra.
/// @returns The grid itself if it has no other cells. New points have point data by the shape
///   functions, or in arrays of whole numbers, the lesser value of both ends.
/// @throws palpate::InputError a cell of three dimensions cannot be cut, or there are linear cells
///   beside others: the message names the first one.
PALPATESCENE_EXPORT vtkPalpateBodyCells vtkPalpateToTetrahedra(vtkUnstructuredGrid* grid);

/// Extends a choice of points of the grid by the new points between two chosen ones.
PALPATESCENE_EXPORT std::vector<char> vtkPalpateExtendChoice(
  const vtkPalpateBodyCells& cells, std::vector<char> chosen);

/// The name of a type of cells, such as vtkHexahedron.
PALPATESCENE_EXPORT std::string vtkPalpateCellTypeName(int type);
