// SPDX-License-Identifier: BSD-3-Clause
// A reduced model as named arrays of numbers, as a file or the data of a pipeline can hold it.
#pragma once

#include <map>
#include <string>

#include "reduced/reduced_model.h"

namespace palpate {

using NamedArrays = std::map<std::string, Eigen::MatrixXd>;

/// The arrays are
///
///   Materials       [materials × 1 + parameters]   law, parameters
///   Rheologies      [materials × values]           see RheologyValues
///   PointGroups     [groups × 3]                   law, first packet, last packet
///   PointMaterials  [8 packets × 1]
///   PointWeights    [8 packets × 1]                m³
///   PointGradients  [72 packets × coordinates]
///   RestGradients   [72 packets × 1]               only under gravity
///   Mass            [coordinates × coordinates]
///   ToolStiffness   [tool coordinates × tool coordinates]   N/m
///   TrainedModes    [modes × 1]                    √J
///   TrainedTools    [tool coordinates × 1]         m
[[nodiscard]] NamedArrays arrays_of(const ReducedModel& model);

/// @throws InputError an array is missing, or as validate().
[[nodiscard]] ReducedModel model_of(const NamedArrays& arrays);

}  // namespace palpate
