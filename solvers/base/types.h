// SPDX-License-Identifier: BSD-3-Clause
// The few types that all parts share.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace palpate {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// Local index of a point or a cell.
using Index = std::int32_t;

/// Nodal displacement or force as one vector [3 × num_points]: x₀ y₀ z₀ x₁ …
using NodalVector = Eigen::VectorXd;

}  // namespace palpate
