// SPDX-License-Identifier: BSD-3-Clause
// The stiffness of the corners, PᵀKP (node_levels.h), exactly: sums of the values of K.
#pragma once

#include <memory>

#include "assembly/node_levels.h"
#include "iterative/block_pattern.h"

namespace palpate {

/// @throws InputError the levels are not of this pattern: a parent that does not exist, or two that
///   are no neighbours although children of theirs are.
void check(const NodeLevels& levels, const BlockPattern& pattern);

/// The pattern of PᵀKP: corners are neighbours where they are it among all nodes.
[[nodiscard]] BlockPattern coarse_pattern(const BlockPattern& pattern, const NodeLevels& levels);

/// The values of unit PᵀKP on that pattern.
void galerkin_product(const BlockPattern& pattern, const NodeLevels& levels,
                      const std::vector<double>& values, double unit, const BlockPattern& coarse,
                      const Neighbourhoods& coarse_neighbours, std::vector<double>& coarse_values);

}  // namespace palpate
