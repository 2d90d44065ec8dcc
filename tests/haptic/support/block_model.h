// SPDX-License-Identifier: BSD-3-Clause
// A block of soft tissue with two tools, bonded to a point each, as a reduced model of which
// nothing is reduced.
#pragma once

#include <memory>
#include <vector>

#include "base/types.h"
#include "materials/material.h"
#include "reduced/reduced_model.h"

namespace palpate::test {

struct BlockModel {
  std::shared_ptr<const ReducedModel> model;
  /// Of the tools at rest, where the body sags under gravity, m.
  std::vector<Vec3> places;
};

/// @param youngs_modulus Pa. @param viscous_time s. @param gravity m/s².
[[nodiscard]] BlockModel make_block_model(double youngs_modulus, double viscous_time,
                                          Law law = Law::neo_hookean,
                                          const Vec3& gravity = Vec3::Zero());

/// That of 30 kPa and 10 ms. It is made once: that takes longer than a test.
[[nodiscard]] const BlockModel& block_model();

}  // namespace palpate::test
