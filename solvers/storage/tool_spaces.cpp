// SPDX-License-Identifier: BSD-3-Clause
#include "storage/tool_spaces.h"

#include <algorithm>
#include <cstdint>

#include "base/error.h"
#include "base/printable.h"
#include "storage/blob_sizes.h"
#include "storage/rows.h"
#include "storage/schema.h"
#include "storage/stored_kind.h"

namespace palpate::storage {
namespace {

using sqlite::Statement;

constexpr char kContactOffset[] = "contact_offset";
constexpr char kMeshRegion[] = "mesh_region";
constexpr char kToolMotion[] = "tool_motion";

/// The oldest version in which a tool has a surface of its own.
constexpr std::int64_t kFirstWithSurfaces = 8;

/// The number of corners of its coarsest cells, each of which takes memory.
std::int64_t coarsest_corners(const ToolSpaceSetup& setup) {
  const std::int64_t n = setup.grid.coarsest_resolution();
  return n * n * n;
}

std::int64_t coarsest_corners(const std::vector<ToolSpace>& tool_spaces) {
  std::int64_t sum = 0;
  for (const ToolSpace& space : tool_spaces) sum += coarsest_corners(space.setup);
  return sum;
}

/// The size of the surface of a rigid tool in its row, bytes.
std::int64_t bytes_of_surface(const ToolSpaceSetup& setup) {
  const RigidTool& tool = setup.interaction.tool;
  return static_cast<std::int64_t>(tool.points.size() * sizeof(tool.points[0]) +
                                   tool.triangles.size() * sizeof(tool.triangles[0]));
}

}  // namespace

ToolSpaces::ToolSpaces(Connection& connection, const Bodies& bodies)
    : connection_(connection), bodies_(bodies) {
  // A body may be touched by a tool with a surface that is finer than its own.
  if (connection_.version() < kFirstWithSurfaces) return;
  connection_.make_room(connection_.database().integer(
      "SELECT max(coalesce(length(tool_points), 0) + coalesce(length(tool_triangles), 0)) FROM "
      "tool_space"));
}

void ToolSpaces::check(const ToolSpaceSetup& setup) const {
  if (!rows::is_possible(setup, bodies_.num_points(setup.body))) {
    throw InputError("Of " + setup.name() + " with " + figures_of(setup) +
                     " a number is out of its range, so that it cannot be stored.");
  }
  if (bytes_of_surface(setup) > blobs::kLargestRow - blobs::kOfNumbers) {
    throw InputError("The surface of the rigid tool has " +
                     std::to_string(setup.interaction.tool.points.size()) + " points and " +
                     std::to_string(setup.interaction.tool.triangles.size()) +
                     " triangles: more than a state-space file can hold. Take a coarser one.");
  }
}

void ToolSpaces::add(const ToolSpaceSetup& setup) {
  const std::int64_t num_corners = coarsest_corners(setup) + coarsest_corners(read_all());
  if (num_corners > kMostCoarsestCorners) {
    throw InputError("The grids around all active nodes have " + std::to_string(num_corners) +
                     " check-points; a state space has " + std::to_string(kMostCoarsestCorners) +
                     " at most. Take fewer active nodes or a lower resolution.");
  }
  connection_.before_change();
  write(ToolSpace{setup, false, {}, {}});
}

void ToolSpaces::write(const ToolSpace& space) {
  forget();
  const ToolSpaceKey key = space.setup.key();
  connection_.make_room(bytes_of_surface(space.setup));
  Statement insert(connection_.database(), table_.insert());
  insert.bind(key.body);
  rows::for_each_number_of_tool_space(space, rows::Bind{insert});
  insert.bind(rows::checksum(space));
  insert.run();
  const RigidTool& tool = space.setup.interaction.tool;
  if (tool.law.offset != 0) {
    write_optional(kContactOffset, key, [&](Statement& row) { row.bind(tool.law.offset); });
  }
  if (tool.motion != ToolMotion::translated) {
    write_optional(kToolMotion, key, [&](Statement& row) {
      const rows::Bind bind{row};
      bind(tool.motion);
      bind(tool.motion_numbers);
    });
  }
  if (space.setup.region) {
    write_optional(kMeshRegion, key, [&](Statement& row) {
      for_each_number_of_mesh_region(*space.setup.region, rows::Bind{row});
    });
  }
}

void ToolSpaces::write_optional(const char* table, const ToolSpaceKey& key,
                                const std::function<void(Statement&)>& bind_numbers) {
  make_table(connection_.database(), table);
  Statement insert(connection_.database(), Table(table).insert());
  insert.bind(key.body);
  insert.bind(key.id);
  bind_numbers(insert);
  insert.run();
}

void ToolSpaces::set_complete(const ToolSpaceKey& key, bool complete) {
  std::optional<ToolSpace> space = find(key);
  if (!space) return;
  space->complete = complete;
  connection_.before_change();
  write(*space);
}

double ToolSpaces::contact_offset(const ToolSpaceKey& key) const {
  if (!has_table(connection_.database(), kContactOffset)) return 0;
  Statement select(connection_.database(),
                   "SELECT distance FROM contact_offset WHERE scene_id = ? AND tool_space_id = ?");
  select.bind(key.body);
  select.bind(key.id);
  return select.step() ? select.take_double() : 0;
}

bool ToolSpaces::take_motion(const ToolSpaceKey& key, RigidTool& tool) const {
  if (!has_table(connection_.database(), kToolMotion)) return true;
  Statement select(
      connection_.database(),
      "SELECT motion, numbers FROM tool_motion WHERE scene_id = ? AND tool_space_id = ?");
  select.bind(key.body);
  select.bind(key.id);
  if (!select.step()) return true;
  tool.motion = static_cast<ToolMotion>(select.take_integer());
  return blobs::copy(select.take_blob(), blobs::motion_numbers(), tool.motion_numbers);
}

std::optional<MeshRegion> ToolSpaces::mesh_region(const ToolSpaceKey& key) const {
  if (!has_table(connection_.database(), kMeshRegion)) return std::nullopt;
  Statement select(connection_.database(),
                   "SELECT " + Table(kMeshRegion).columns("centre", "") +
                       " FROM mesh_region WHERE scene_id = ? AND tool_space_id = ?");
  select.bind(key.body);
  select.bind(key.id);
  if (!select.step()) return std::nullopt;
  MeshRegion region;
  bool sound = true;
  for_each_number_of_mesh_region(region, rows::Take{select, sound});
  if (!sound) region.band = -1;
  return region;
}

void ToolSpaces::read_into(BodyId body, std::vector<ToolSpace>& tool_spaces) const {
  std::int64_t num_corners = coarsest_corners(tool_spaces);
  Statement select(connection_.database(),
                   "SELECT rowid, " + table_.columns("tool_space_id", "checksum") +
                       ", checksum FROM tool_space WHERE scene_id = ? ORDER BY tool_space_id");
  select.bind(body);
  while (select.step()) {
    const std::int64_t row = select.take_integer();
    ToolSpace space;
    space.setup.body = body;
    bool sound = true;
    rows::for_each_number_of_tool_space(space, rows::Take{select, sound});
    space.setup.interaction.tool.law.offset = contact_offset(space.setup.key());
    sound = take_motion(space.setup.key(), space.setup.interaction.tool) && sound;
    space.setup.region = mesh_region(space.setup.key());
    const std::int64_t stored = select.take_integer();
    if (connection_.has_checksums()) {
      sound = stored == rows::checksum(space, connection_.checked()) && sound;
    }
    if (!sound || !rows::is_possible(space.setup, bodies_.num_points(body))) {
      connection_.damage().leave_out(space.setup.name(), table_.name(), row);
      continue;
    }
    num_corners += coarsest_corners(space.setup);
    if (num_corners > kMostCoarsestCorners) {
      throw_damaged(connection_.path(), "its grids have more than " +
                                            std::to_string(kMostCoarsestCorners) + " check-points");
    }
    tool_spaces.push_back(std::move(space));
  }
}

const std::vector<ToolSpace>& ToolSpaces::read_all() const {
  // Do not keep what is read within a transaction, since the transaction may be undone.
  if (known_ && !is_tentative_) return *known_;
  std::vector<ToolSpace> all;
  for (const BodyId body : bodies_.list()) read_into(body, all);
  is_tentative_ = connection_.database().is_in_transaction();
  return *(known_ = std::move(all));
}

std::optional<ToolSpace> ToolSpaces::find(const ToolSpaceKey& key) const {
  for (const ToolSpace& space : read_all()) {
    if (space.setup.key() == key) return space;
  }
  return std::nullopt;
}

std::string ToolSpaces::name_of(const ToolSpaceKey& key) const {
  const std::optional<ToolSpace> there = find(key);
  return there ? there->setup.name() : number_of(key);
}

std::function<void()> ToolSpaces::read_for_conversion() {
  return [this, all = read_all()] {
    for (const ToolSpace& space : all) write(space);
  };
}

void require_extension(const std::filesystem::path& path, const ToolSpaceSetup& there,
                       const ToolSpaceSetup& asked) {
  if (may_become(there, asked)) return;
  throw InputError(
      quoted(path) + " holds " + asked.name() + " with " + figures_of(there) + "; asked for was " +
      figures_of(asked) +
      ". Give another file name, or those values: " + kind_of(there).what_may_change() + '.');
}

}  // namespace palpate::storage
