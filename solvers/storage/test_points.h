// SPDX-License-Identifier: BSD-3-Clause
// The equilibria beside the configurations: the table test_point. A set needs no tool space.
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
  /// The sets of which there are points, of a body.
  [[nodiscard]] std::vector<TestSet> list_sets(BodyId body) const;
  /// Takes over those of another file of a body. @param there Which body it is there.
  void merge(BodyId body, const TestPoints& other, BodyId there);

 private:
  Connection& connection_;
  const ToolSpaces& tool_spaces_;
  Table table_{"test_point"};
};

}  // namespace palpate::storage
