// SPDX-License-Identifier: BSD-3-Clause
// The table test_point: equilibria beside the configurations. A set of them needs no tool space.
#pragma once

#include <vector>

#include "state_space/test_point.h"
#include "storage/connection.h"
#include "storage/table.h"
#include "storage/tool_spaces.h"

namespace palpate::storage {

class TestPoints {
 public:
  TestPoints(Connection& connection, const ToolSpaces& tool_spaces)
      : connection_(connection), tool_spaces_(tool_spaces) {}

  /// Adds a test point, unless it is there.
  void add(const TestSet& set, const TestPoint& point);
  /// The test points of a set, in the order of operator<.
  [[nodiscard]] std::vector<TestPoint> read(const TestSet& set) const;
  /// The sets of a body that have points.
  [[nodiscard]] std::vector<TestSet> list_sets(BodyId body) const;
  /// Takes over the test points that another file has of a body.
  /// @param there The number of the body in that file.
  void merge(BodyId body, const TestPoints& other, BodyId there);

 private:
  Connection& connection_;
  const ToolSpaces& tool_spaces_;
  Table table_{"test_point"};
};

}  // namespace palpate::storage
