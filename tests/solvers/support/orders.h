// SPDX-License-Identifier: BSD-3-Clause
// The orders of elements as parameters of a test suite.
#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "mesh/tet_mesh.h"

namespace palpate {

/// How GoogleTest shows an order.
inline void PrintTo(ElementOrder order, std::ostream* out) {
  *out << (order == ElementOrder::linear ? "Tet4" : "Tet10");
}

}  // namespace palpate

namespace palpate::test {

inline constexpr ElementOrder kOrders[] = {ElementOrder::linear, ElementOrder::quadratic};

inline std::string name_of_order(const testing::TestParamInfo<ElementOrder>& info) {
  return info.param == ElementOrder::linear ? "Tet4" : "Tet10";
}

}  // namespace palpate::test
