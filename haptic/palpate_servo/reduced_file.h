// SPDX-License-Identifier: BSD-3-Clause
// Reads the reduced models of a file, as a program that touches them needs them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "haptic/touching/pressing_range.h"
#include "reduced/reduced_model.h"
#include "storage/state_space_file.h"

namespace palpate {

struct TouchedModel {
  std::shared_ptr<const ReducedModel> model;
  /// The number of the model among those of the file, from 1.
  std::int64_t number = 0;
  /// The active node of each tool, and its place at rest. The depth is the largest value of a
  /// coordinate of the tool that the model was trained for, m.
  std::vector<Index> nodes;
  std::vector<StartPlace> tools;
};

/// Whether the file holds reduced models and no state space.
[[nodiscard]] bool has_only_reduced_models(const StateSpaceFile& file);

/// @param number From 1; empty: the only one.
/// @throws InputError there is no such model, or several where none is chosen (the message says
///   which there are), or it is damaged.
[[nodiscard]] TouchedModel read_touched_model(const StateSpaceFile& file,
                                              std::optional<std::int64_t> number);

}  // namespace palpate
