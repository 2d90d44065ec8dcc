// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/seal.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/types.h"
#include "materials/material.h"
#include "storage/sqlite.h"
#include "storage/table.h"

namespace palpate::test {
namespace {

using sqlite::Access;
using sqlite::Database;
using sqlite::Statement;
using storage::Table;
using Bits = std::vector<std::int64_t>;

std::int64_t checksum(const void* data, std::size_t bytes, std::int64_t seed = 0) {
  return static_cast<std::int64_t>(
      XXH3_64bits_withSeed(data, bytes, static_cast<XXH64_hash_t>(seed)));
}

std::int64_t bits_of(double number) {
  std::int64_t bits = -1;
  if (!std::isnan(number)) std::memcpy(&bits, &number, sizeof bits);
  return bits;
}

/// The columns of a table with a type: those of integers and of BLOBs.
std::map<std::string, std::string> types_of(const Database& database, const std::string& table) {
  std::map<std::string, std::string> types;
  Statement select(database, "SELECT name, type FROM pragma_table_info('" + table + "')");
  while (select.step()) {
    const std::string name = select.take_text();
    types[name] = select.take_text();
  }
  return types;
}

std::vector<std::string> split(const std::string& columns) {
  std::vector<std::string> names(1);
  for (const char c : columns) {
    if (c == ',') names.emplace_back();
    if (c != ',' && c != ' ') names.back() += c;
  }
  return names;
}

/// The bits that the checksum of a row takes in of these columns, which are next in the statement.
void gather(Statement& select, const std::vector<std::string>& columns,
            const std::map<std::string, std::string>& types, Bits& bits) {
  for (const std::string& column : columns) {
    const std::string& type = types.at(column);
    if (type == "INTEGER") {
      bits.push_back(select.take_integer());
    } else if (type.empty()) {
      bits.push_back(bits_of(select.take_double()));
    } else {
      const Statement::Blob blob = select.take_blob();
      if (column == "tool_points" || column == "tool_triangles") {
        const std::size_t size = column == "tool_points" ? sizeof(Vec3) : 3 * sizeof(Index);
        bits.push_back(static_cast<std::int64_t>(blob.bytes / size));
        bits.push_back(checksum(blob.data, blob.bytes));
        continue;
      }
      std::vector<double> numbers(blob.bytes / sizeof(double));
      if (!numbers.empty()) {
        std::memcpy(numbers.data(), blob.data, numbers.size() * sizeof(double));
      }
      bool finite = true;
      for (const double x : numbers) finite = finite && std::isfinite(x);
      if (column == "third_derivative" && !finite) continue;
      for (const double x : numbers) bits.push_back(bits_of(x));
    }
  }
}

/// Gives each row of a table, by its number, what `of_row` makes of these columns.
void seal_rows(const Database& database, const std::string& table, const std::string& target,
               const std::string& columns, const std::function<std::int64_t(Statement&)>& of_row) {
  std::map<std::int64_t, std::int64_t> sums;
  {
    Statement select(database, "SELECT rowid, " + columns + " FROM " + table);
    while (select.step()) {
      const std::int64_t row = select.take_integer();
      sums[row] = of_row(select);
    }
  }
  Statement update(database, "UPDATE " + table + " SET " + target + " = ? WHERE rowid = ?");
  for (const auto& [row, sum] : sums) {
    update.bind(sum);
    update.bind(row);
    update.run();
  }
}

/// The checksum of the bits of columns, after those of the number of the tool space.
void seal_numbers(const Database& database, const std::string& table, const std::string& target,
                  const std::string& columns) {
  const std::vector<std::string> names = split(columns);
  const auto types = types_of(database, table);
  seal_rows(database, table, target, columns, [&](Statement& select) {
    Bits bits;
    gather(select, names, types, bits);
    return checksum(bits.data(), bits.size() * sizeof bits[0]);
  });
}

/// The checksum of BLOBs, that of each the seed of the next.
void seal_blobs(const Database& database, const std::string& table, const std::string& target,
                const std::string& columns) {
  const std::size_t count = split(columns).size();
  seal_rows(database, table, target, columns, [&](Statement& select) {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Statement::Blob blob = select.take_blob();
      sum = checksum(blob.data, blob.bytes, sum);
    }
    return sum;
  });
}

bool has_table(const Database& database, const std::string& name) {
  return database.integer("SELECT count(*) FROM sqlite_master WHERE name = '" + name + '\'') > 0;
}

/// The hash of the scene, as hash() of assembly/scene.h makes it of one that is sound.
std::string hash_of_scene(const Database& database) {
  XXH3_state_t state;
  XXH3_INITSTATE(&state);
  XXH3_128bits_reset(&state);
  const auto add = [&](const void* data, std::size_t bytes) {
    XXH3_128bits_update(&state, data, bytes);
  };
  const auto add_number = [&](std::int64_t number) { add(&number, sizeof number); };
  struct OfMaterial {
    std::int64_t law = 0;
    std::int64_t formulation = 0;
    std::array<double, max_parameters> parameters{};
  };
  std::vector<OfMaterial> materials;
  Statement select_materials(database, "SELECT * FROM material ORDER BY material");
  while (select_materials.step()) {
    OfMaterial& material = materials.emplace_back();
    (void)select_materials.take_integer();
    (void)select_materials.take_integer();
    material.law = select_materials.take_integer();
    material.formulation = select_materials.take_integer();
    for (double& p : material.parameters) p = select_materials.take_double();
  }
  Statement select(database,
                   "SELECT element_order, num_points, points, num_cells, cells, "
                   "material_of_cell, fixed FROM scene");
  select.step();
  add_number(select.take_integer());
  add_number(select.take_integer());
  const Statement::Blob points = select.take_blob();
  add(points.data, points.bytes);
  const std::int64_t num_cells = select.take_integer();
  add_number(num_cells);
  const Statement::Blob cells = select.take_blob();
  add(cells.data, cells.bytes);
  const Statement::Blob of_cell = select.take_blob();
  std::vector<std::size_t> own;
  for (std::int64_t c = 0; c < num_cells && c < 1000; ++c) {
    Index material = 0;
    const auto at = static_cast<std::size_t>(c) * sizeof material;
    if (at + sizeof material <= of_cell.bytes) {
      std::memcpy(&material, static_cast<const char*>(of_cell.data) + at, sizeof material);
    }
    if (material < 0 || static_cast<std::size_t>(material) >= materials.size()) continue;
    own.push_back(static_cast<std::size_t>(material));
    add_number(materials[own.back()].law);
    add_number(materials[own.back()].formulation);
    add(materials[own.back()].parameters.data(), sizeof materials[0].parameters);
  }
  const Statement::Blob fixed = select.take_blob();
  for (std::size_t i = 0; i < fixed.bytes; ++i) {
    add_number(static_cast<const char*>(fixed.data)[i] != 0 ? 1 : 0);
  }
  if (has_table(database, "body_force")) {
    Statement force(database, "SELECT acceleration, densities FROM body_force");
    if (force.step()) {
      const Statement::Blob acceleration = force.take_blob();
      add(acceleration.data, acceleration.bytes);
      const Statement::Blob densities = force.take_blob();
      for (const std::size_t material : own) {
        const std::size_t at = material * sizeof(double);
        if (at + sizeof(double) > densities.bytes) continue;
        add(static_cast<const char*>(densities.data) + at, sizeof(double));
      }
    }
  }
  const XXH128_hash_t digest = XXH3_128bits_digest(&state);
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(digest.high64),
                static_cast<unsigned long long>(digest.low64));
  return text;
}

}  // namespace

void seal(const std::filesystem::path& file) {
  const Database database(file, Access::read_write);
  sqlite::Transaction transaction(database);
  const std::string id = "tool_space_id, ";
  seal_numbers(database, "tool_space", "checksum",
               Table("tool_space").columns("tool_space_id", "checksum"));
  seal_blobs(database, "configuration", "checksum", "u, v, p, p_v");
  seal_numbers(database, "configuration", "summary_checksum",
               id + Table("configuration").columns("i", "summary_checksum") + ", checksum");
  seal_blobs(database, "basis", "modes_checksum", "steps, modes");
  seal_numbers(database, "basis", "checksum", id + Table("basis").columns("number", "checksum"));
  seal_numbers(database, "transition", "checksum",
               id + Table("transition").columns("i", "checksum"));
  seal_numbers(database, "intermediate", "checksum",
               id + Table("intermediate").columns("i", "checksum"));
  const auto of_test_point = types_of(database, "test_point");
  const std::string test_columns = "tool_space_id, seed, tip_radius, half_width, " +
                                   Table("test_point").columns("kind", "checksum");
  seal_rows(database, "test_point", "checksum", test_columns + ", displacement",
            [&](Statement& select) {
              Bits bits;
              gather(select, split(test_columns), of_test_point, bits);
              const Statement::Blob displacement = select.take_blob();
              return checksum(displacement.data, displacement.bytes,
                              checksum(bits.data(), bits.size() * sizeof bits[0]));
            });
  if (has_table(database, "reduced_array")) {
    seal_rows(database, "reduced_array", "checksum",
              Table("reduced_array").columns("model", "checksum") + ", numbers",
              [](Statement& select) {
                const std::string model = select.take_text();
                const std::string name = select.take_text();
                std::array<std::int64_t, 3> sizes{};
                for (std::int64_t& size : sizes) size = select.take_integer();
                std::int64_t sum = checksum(model.data(), model.size());
                sum = checksum(name.data(), name.size(), sum);
                sum = checksum(sizes.data(), sizeof sizes, sum);
                const Statement::Blob numbers = select.take_blob();
                return checksum(numbers.data, numbers.bytes, sum);
              });
  }
  if (has_table(database, "body_force")) {
    seal_blobs(database, "body_force", "checksum", "pressures, displacement");
  }
  seal_rows(database, "scene", "checksum", "solver_tolerance, touchable", [](Statement& select) {
    const std::int64_t bits = bits_of(select.take_double());
    const Statement::Blob touchable = select.take_blob();
    return checksum(touchable.data, touchable.bytes, checksum(&bits, sizeof bits));
  });
  Statement update(database, "UPDATE scene SET hash = ?");
  update.bind(hash_of_scene(database));
  update.run();
  transaction.commit();
}

}  // namespace palpate::test
