// SPDX-License-Identifier: BSD-3-Clause
// The rows of a state-space file: the numbers and the checksum of each kind of record, and what it
// may hold.
//
// A file may be damaged, or made by anyone. A row is sound if its checksum is right and its numbers
// are possible. Rows that are not sound are left out. Each kind of record lists its numbers once,
// in the order of its columns in schema.sql.h: here, or beside the type where ranks send them too.
//
// A checksum takes in the number of the body, so that a row is not taken for one of another body.
// The first body is an exception: it was the only one in files of earlier versions, whose checksums
// have no such number.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "fields/packed_basis.h"
#include "fields/reduced_fields.h"
#include "state_space/state_space.h"
#include "state_space/test_point.h"
#include "storage/blob_sizes.h"
#include "storage/sqlite.h"

namespace palpate::rows {

/// Which numbers a checksum takes in. Files of earlier versions left some out, see schema.sql.h.
enum class Checked { all, as_version_9, as_version_7, as_version_6, as_version_5 };

/// Calls visit for each number of a tool space. For a checksum of an older version, visits only the
/// numbers that files had then.
template <class Space, class Visit>
void for_each_number_of_tool_space(Space& space, Visit&& visit, Checked checked = Checked::all) {
  auto& [id, interaction, grid, policy, body, region] = space.setup;
  (void)body;    // is a part of the key, as in all tables
  (void)region;  // has a table of its own
  if (checked <= Checked::as_version_7) {
    visit(id);
    visit(interaction.kind);
    visit(interaction.material_point);
  }
  visit(interaction.active_node);
  visit(interaction.tip_radius);
  visit(grid.half_width);
  visit(grid.resolution);
  visit(policy.force_limit);
  visit(grid.coarsest);
  visit(policy.tolerance);
  visit(policy.tolerance_is_relative);
  visit(policy.history);
  visit(policy.intermediate_states);
  visit(policy.third_derivatives);
  visit(space.complete);
  if (checked >= Checked::as_version_7) return;
  auto& tool = interaction.tool;
  visit(tool.shape);
  visit(tool.radius);
  visit(tool.axis);
  visit(tool.length);
  visit(tool.points);
  visit(tool.triangles);
  visit(tool.law.thickness);
  visit(tool.law.stiffness);
  visit(grid.origin);
  visit(grid.sparse);
  visit(policy.depth);
}

/// Calls visit for each number of the row of the error of the mesh of a configuration.
template <class Summary, class Visit>
void for_each_number_of_mesh_error_row(Summary& c, Visit&& visit) {
  for (auto& x : c.check_point) visit(x);
  visit(c.level);
  for_each_number_of_mesh_error(c.mesh_error, visit);
}

/// Calls visit for each number of the row of the derivatives by turns of a configuration.
template <class Summary, class Visit>
void for_each_number_of_turn_row(Summary& c, Visit&& visit) {
  for (auto& x : c.check_point) visit(x);
  visit(c.level);
  visit(c.of_turns);
}

/// A basis without its modes.
struct BasisRow {
  std::int64_t number = 0;
  PackedBasis basis;
  std::int64_t modes_checksum = 0;
};
/// Does the same for a basis.
template <class Row, class Visit>
void for_each_number_of_basis(Row& row, Visit&& visit, Checked checked = Checked::all) {
  visit(row.number);
  for (auto& x : row.basis.box.first) visit(x);
  for (auto& x : row.basis.box.last) visit(x);
  visit(row.basis.keep);
  visit(row.basis.num_modes);
  visit(row.basis.num_pressure_modes);
  visit(row.basis.num_pressures);
  visit(row.basis.largest_displacement);
  visit(row.basis.displacement_error);
  visit(row.basis.sensitivity_error);
  if (checked == Checked::all) visit(row.modes_checksum);
}

/// The key of a mode in a file of version 9.
struct ModeKey {
  std::int64_t basis = 0;
  std::int64_t of_pressure = 0;
  std::int64_t number = 0;
};

/// Binds each number to the next parameter.
struct Bind {
  sqlite::Statement& statement;
  void operator()(double x) const { statement.bind(x); }
  void operator()(std::int32_t x) const { statement.bind(std::int64_t{x}); }
  void operator()(std::int64_t x) const { statement.bind(x); }
  template <class Enumeration>
  void operator()(Enumeration x) const {
    statement.bind(static_cast<std::int64_t>(x));
  }
  void operator()(const ThirdDerivative& x) const {
    statement.bind(x.allFinite() ? x.data() : nullptr, sizeof x);
  }
  void operator()(const Vec3& x) const { statement.bind(x.data(), sizeof x); }
  template <class T>
  void operator()(const std::vector<T>& x) const {
    statement.bind(x.empty() ? nullptr : static_cast<const void*>(x.data()), x.size() * sizeof(T));
  }
};

/// Takes each number from the next column, and makes `sound` false where one does not fit.
struct Take {
  sqlite::Statement& statement;
  bool& sound;
  void operator()(double& x) const { x = statement.take_double(); }
  template <class Integer>
  void operator()(Integer& x) const {
    const std::int64_t stored = statement.take_integer();
    x = static_cast<Integer>(stored);
    if (static_cast<std::int64_t>(x) != stored) sound = false;
  }
  void operator()(Vec3& x) const {
    sound = blobs::copy(statement.take_blob(), blobs::vector(), x) && sound;
  }
  void operator()(std::vector<Vec3>& x) const {
    sound = blobs::copy(statement.take_blob(), blobs::tool_points(), x) && sound;
  }
  void operator()(std::vector<std::array<Index, 3>>& x) const {
    sound = blobs::copy(statement.take_blob(), blobs::tool_triangles(), x) && sound;
  }
  void operator()(std::vector<double>& x) const {
    sound = blobs::copy(statement.take_blob(), blobs::turn_derivatives(), x) && sound;
  }
  void operator()(ThirdDerivative& x) const {
    x.setConstant(std::numeric_limits<double>::quiet_NaN());
    const sqlite::Statement::Blob blob = statement.take_blob();
    if (blob.bytes > 0) sound = blobs::copy(blob, blobs::third_derivative(), x) && sound;
  }
};

/// An array of a reduced model without its numbers.
struct ReducedArrayRow {
  std::string model;
  std::string name;
  std::int64_t num_arrays = 0;
  std::int64_t num_rows = 0;
  std::int64_t num_columns = 0;
};

/// The fields of a configuration, u, v, p and p_v, as they lie in memory or in the file.
using Fields = std::array<sqlite::Statement::Blob, 4>;
/// The fields of a configuration in double precision; valid as long as the configuration is.
[[nodiscard]] Fields fields_of(const Configuration& configuration);
/// The fields in single precision.
using SingleFields = std::array<Eigen::MatrixXf, 4>;
[[nodiscard]] SingleFields single_fields_of(const Configuration& configuration);
[[nodiscard]] Fields fields_of(const SingleFields& fields);
/// Sets the fields of a configuration from fields of either precision.
/// @param fields They must fit, see fit().
void set_fields(const Fields& fields, std::int64_t num_points, Configuration& configuration);

/// The fields by modes; valid as long as `reduced` is.
[[nodiscard]] Fields fields_of(const ReducedFields& reduced);
/// The steps and the numbers of the modes; valid as long as the basis is.
[[nodiscard]] std::array<sqlite::Statement::Blob, 2> modes_of(const PackedBasis& basis);
/// Sets the steps and the numbers of a basis.
/// @param num_kept The points that the basis is for. @returns False: they have another length than
///   its head says, and nothing was copied.
[[nodiscard]] bool set_modes(const std::array<sqlite::Statement::Blob, 2>& modes,
                             std::int64_t num_kept, PackedBasis& basis);
[[nodiscard]] std::int64_t checksum(const std::array<sqlite::Statement::Blob, 2>& modes);
/// The fields by modes that a row holds. @param fields They must fit a basis, see fit_basis().
[[nodiscard]] ReducedFields reduced_of(const Fields& fields);

[[nodiscard]] std::int64_t checksum(const Fields& fields);
[[nodiscard]] std::int64_t checksum(const ToolSpaceKey& key, const BasisRow& row,
                                    Checked checked = Checked::all);
[[nodiscard]] std::int64_t checksum(const ToolSpaceKey& key, const ModeKey& mode,
                                    sqlite::Statement::Blob field);
[[nodiscard]] std::int64_t checksum(const ToolSpace& space, Checked checked = Checked::all);
/// @param of_fields The checksum of its fields.
[[nodiscard]] std::int64_t checksum(const ToolSpaceKey& key, ConfigurationSummary summary,
                                    std::int64_t of_fields, Checked checked = Checked::all);
/// The checksum of the error of the mesh of a configuration.
[[nodiscard]] std::int64_t checksum_of_mesh_error(const ToolSpaceKey& key,
                                                  const ConfigurationSummary& summary);
/// The checksum of the derivatives by turns of a configuration.
[[nodiscard]] std::int64_t checksum_of_turns(const ToolSpaceKey& key,
                                             const ConfigurationSummary& summary);
[[nodiscard]] std::int64_t checksum(const ToolSpaceKey& key, const LevelTransition& transition);
[[nodiscard]] std::int64_t checksum(const ToolSpaceKey& key, IntermediateState state,
                                    Checked checked = Checked::all);
[[nodiscard]] std::int64_t checksum(const TestSet& set, const TestPoint& point);
[[nodiscard]] std::int64_t checksum(BodyId body, const ReducedArrayRow& row,
                                    sqlite::Statement::Blob numbers);
/// The checksum of those parts of a scene that its hash does not take in.
[[nodiscard]] std::int64_t checksum(BodyId body, const std::vector<char>& touchable,
                                    double solver_tolerance);
[[nodiscard]] std::int64_t checksum(BodyId body, const SettledBody& settled);
/// The checksum of a cut.
[[nodiscard]] std::int64_t checksum(BodyId body, std::int64_t stage, sqlite::Statement::Blob areas,
                                    sqlite::Statement::Blob faces);
/// The checksum of an array of what holds and loads the surface.
[[nodiscard]] std::int64_t checksum(BodyId body, const std::string& name,
                                    sqlite::Statement::Blob numbers);

[[nodiscard]] inline bool is_length(double x) { return std::isfinite(x) && x >= 0; }

/// Whether the numbers are ones that a program may rely on: indices that exist, and sizes for which
/// there is memory.
[[nodiscard]] bool is_possible(const ToolSpaceSetup& setup, std::int64_t num_points);
[[nodiscard]] bool is_possible(const Grid& grid, const ConfigurationSummary& summary);
[[nodiscard]] bool is_possible(const Grid& grid, const LevelTransition& transition);
[[nodiscard]] bool is_possible(const Grid& grid, const IntermediateState& state);
[[nodiscard]] bool is_possible(const TestPoint& point);
/// Says the same for a basis.
/// @param num_cells The number of cells of the body.
/// @param num_kept The number of points that the basis is for.
[[nodiscard]] bool is_possible(const BasisRow& row, std::int64_t num_kept, std::int64_t num_cells);
/// Whether all numbers of the fields are finite.
template <class OfConfiguration>
[[nodiscard]] bool is_finite(const OfConfiguration& fields) {
  bool finite = true;
  for_each_field(fields, [&](const auto& field) { finite = finite && field.allFinite(); });
  return finite;
}
/// Whether the fields have the sizes that they have for such a body, all in the same precision.
/// @param num_pressures The number of pressures of the body; it only matters if the fields have
///   pressures.
[[nodiscard]] bool fit(const Fields& fields, std::int64_t num_points, std::int64_t num_pressures);

/// Whether the fields have the sizes of coefficients by the modes of a basis, and not those of
/// whole fields.
[[nodiscard]] bool fit_basis(const Fields& fields, const FieldBasis& basis,
                             std::int64_t num_points);

/// Whether an array of such a size has so many bytes.
[[nodiscard]] bool is_possible(const ReducedArrayRow& row, std::int64_t bytes);

[[nodiscard]] std::string describe(const LevelTransition& transition,
                                   const std::string& tool_space);
[[nodiscard]] std::string describe(const IntermediateState& state, const std::string& tool_space);
[[nodiscard]] std::string describe(const TestPoint& point, const std::string& tool_space);
[[nodiscard]] std::string describe(const ReducedArrayRow& row);

}  // namespace palpate::rows
