// SPDX-License-Identifier: BSD-3-Clause
// A body with its reduced model, as it goes through the pipeline: the body's grid with the point
// array
//
//   `ReducedBasis`   Φ and L: a tuple a point, its displacement for each coordinate, three
//                    components a coordinate
//   `ReducedRest`    under a load the displacement at rest, m, from which the coordinates count
//
// and the field arrays `ActiveNodes` (the nodes that the tools are bonded to) and `Reduced…`, the
// arrays of reduced/model_arrays.h, a tuple a row.
#pragma once

#include <vector>

#include "PalpateReductionModule.h"
#include "base/types.h"
#include "reduced/reduced_model.h"
#include "vtkType.h"

class vtkDataSet;

struct vtkPalpateReducedModel
{
  palpate::ReducedModel Model;
  /// (Φ, L) [3 number of points × coordinates].
  Eigen::MatrixXd Basis;
  /// The displacement at rest [3 number of points], m; read without gravity it is 0, written it may
  /// be empty.
  palpate::NodalVector Rest;
  /// The active nodes of the tools, in their order.
  std::vector<vtkIdType> ActiveNodes;
};

/// Adds the arrays.
PALPATEREDUCTION_EXPORT void vtkPalpateWriteReducedModel(
  const vtkPalpateReducedModel& model, vtkDataSet* body);

/// @throws palpate::InputError an array is missing or does not fit: the message says where it comes
///   from.
PALPATEREDUCTION_EXPORT vtkPalpateReducedModel vtkPalpateReadReducedModel(vtkDataSet* body);
