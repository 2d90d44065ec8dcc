// SPDX-License-Identifier: BSD-3-Clause
#include "storage/test_points.h"

#include <cstdint>

#include "storage/blob_sizes.h"
#include "storage/rows.h"

namespace palpate::storage {
namespace {

using sqlite::Statement;

void bind_set(const TestSet& set, Statement& statement) {
  statement.bind(set.body);
  statement.bind(set.tool_space);
  statement.bind(set.tip_radius);
  statement.bind(set.half_width);
  statement.bind(set.seed);
}

}  // namespace

void TestPoints::add(const TestSet& set, const TestPoint& point) {
  connection_.before_change();
  Statement insert(connection_.database(), table_.insert("IGNORE"));
  bind_set(set, insert);
  for_each_number_of_test_point(point, rows::Bind{insert});
  insert.bind(rows::checksum(set, point));
  const auto size = static_cast<std::size_t>(point.displacement.size()) * sizeof(float);
  insert.bind(size == 0 ? nullptr : point.displacement.data(), size);
  insert.run();
}

std::vector<TestPoint> TestPoints::read(const TestSet& set) const {
  Statement select(connection_.database(),
                   "SELECT rowid, " + table_.columns("kind", "checksum") +
                       ", checksum, displacement FROM test_point WHERE scene_id = ? AND "
                       "tool_space_id = ? AND tip_radius = ? AND half_width = ? AND seed = ? ORDER "
                       "BY kind, number");
  bind_set(set, select);
  std::vector<TestPoint> points;
  while (select.step()) {
    const std::int64_t row = select.take_integer();
    TestPoint& point = points.emplace_back();
    bool sound = true;
    for_each_number_of_test_point(point, rows::Take{select, sound});
    const std::int64_t stored_checksum = select.take_integer();
    if (blobs::copy(select.take_blob(), blobs::sampled_displacement(), point.displacement) &&
        sound && rows::checksum(set, point) == stored_checksum && rows::is_possible(point)) {
      continue;
    }
    connection_.damage().leave_out(
        rows::describe(point, tool_spaces_.name_of({set.tool_space, set.body})), table_.name(),
        row);
    points.pop_back();
  }
  return points;
}

std::vector<TestSet> TestPoints::list_sets(BodyId body) const {
  Statement select(connection_.database(),
                   "SELECT DISTINCT tool_space_id, tip_radius, half_width, seed FROM test_point "
                   "WHERE scene_id = ?");
  select.bind(body);
  std::vector<TestSet> sets;
  while (select.step()) {
    TestSet& set = sets.emplace_back();
    set.tool_space = select.take_integer();
    set.tip_radius = select.take_double();
    set.half_width = select.take_double();
    set.seed = select.take_integer();
    set.body = body;
  }
  return sets;
}

void TestPoints::merge(BodyId body, const TestPoints& other, BodyId there) {
  for (const TestSet& set : other.list_sets(there)) {
    TestSet here = set;
    here.body = body;
    for (const TestPoint& point : other.read(set)) add(here, point);
  }
}

}  // namespace palpate::storage
