// SPDX-License-Identifier: BSD-3-Clause
#include "storage/state_space_file.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <system_error>
#include <type_traits>
#include <utility>

#include "assembly/pressures.h"
#include "base/error.h"
#include "base/folder.h"
#include "base/join.h"
#include "base/new_file.h"
#include "base/printable.h"
#include "storage/blob_sizes.h"
#include "storage/rows.h"
#include "storage/schema.h"
#include "storage/sqlite.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "The blobs of a state space are little-endian and are written as they lie in memory."
#endif

namespace palpate {
namespace fs = std::filesystem;
using sqlite::Access;
using sqlite::Database;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

/// Large pages suit large blobs: a configuration of 160 kB is 10 pages.
constexpr int kPageSize = 16384;

/// The shortest text that reads back as the same number.
std::string number(double value) {
  for (int digits = 6;; ++digits) {
    std::ostringstream text;
    text.precision(digits);
    text << value;
    if (digits == 17 || std::strtod(text.str().c_str(), nullptr) == value) return text.str();
  }
}

/// The first bytes of the file, as SQLite's file format defines them. They are read by SQLite: when
/// a program closes a file that it has opened otherwise, all locks that it has on it are gone.
struct FileHeader {
  explicit FileHeader(const Database& database) { database.read_first(bytes.data(), bytes.size()); }
  [[nodiscard]] std::uint64_t number(std::size_t at, std::size_t size) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes[at + i];
    return value;
  }
  [[nodiscard]] bool is_sqlite() const {
    return std::memcmp(bytes.data(), "SQLite format 3", 16) == 0;
  }
  [[nodiscard]] bool has_write_ahead_log() const { return bytes[18] == 2; }
  [[nodiscard]] std::uint64_t file_size() const {
    const std::uint64_t page_size = number(16, 2) == 1 ? 65536 : number(16, 2);
    return page_size * number(28, 4);
  }

  std::array<unsigned char, 100> bytes{};
};

/// A log beside the file: a writer is at work, or was killed.
bool has_log(const fs::path& path) {
  return fs::exists(path.string() + "-wal") || fs::exists(path.string() + "-journal");
}

[[noreturn]] void throw_damaged(const fs::path& path, const std::string& what) {
  throw InputError(quoted(path) + " is damaged (" + what + "). Take a copy that is " +
                   "whole, or give another file name and compute it again.");
}

void check_is_there(const fs::path& path) {
  require_short_name(path);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    throw InputError("There is no file " + quoted(path) + ". Check its name.");
  }
  if (status.type() == fs::file_type::none) {
    throw BackendError(quoted(path) + " cannot be opened: " + error.message() +
                       ". Change the permissions of its folder.");
  }
  if (status.type() != fs::file_type::regular) {
    throw InputError(quoted(path) + " is no ordinary file. Give another file name.");
  }
  if (fs::file_size(path) == 0) {
    throw InputError(quoted(path) + " is empty, not a state space. Take a copy that is whole, or " +
                     "give another file name.");
  }
}

/// SQLite would take the missing end of the last page as zeros.
void check_end(const Database& database) {
  const fs::path& path = database.path();
  const FileHeader header(database);
  if (header.is_sqlite() && !has_log(path) && header.file_size() > fs::file_size(path)) {
    throw_damaged(path, "its end is missing");
  }
}

/// Opens with the file locked for this program alone: then the log needs no shared memory, and
/// works on network disks.
Database open_exclusively(const fs::path& given) {
  const fs::path path = without_links(given);
  check_is_there(path);
  Database database(path, Access::read_write);
  check_end(database);
  database.execute("PRAGMA locking_mode = EXCLUSIVE");
  (void)check_schema(database);
  return database;
}

[[noreturn]] void throw_log_stays(const fs::path& path) {
  throw BackendError("The log of " + quoted(path) +
                     " cannot be put into the file. Nothing is lost: " +
                     "open it again when no other program uses it.");
}

/// Closes a file that was opened exclusively: afterwards it has no log beside it, and is durable.
void close_as_single_file(Database database) {
  const fs::path path = database.path();
  {
    const Database closed = std::move(database);
    if (closed.has_moved()) {
      throw BackendError(quoted(path) +
                         " was moved, removed or replaced while it was written. What was stored "
                         "last is in its log " +
                         quoted(fs::path(path.string() + "-wal")) +
                         ": bring the file back to where it was, beside that, and open it.");
    }
    if (closed.text("PRAGMA journal_mode = DELETE") != "delete") throw_log_stays(path);
  }
  sync_folder_of(path);
}

/// Puts the log into the file and waits for the disk: what was stored so far is durable.
void checkpoint(const Database& database) {
  if (database.integer("PRAGMA wal_checkpoint(TRUNCATE)") != 0) throw_log_stays(database.path());
}

Database open_to_read(const fs::path& given) {
  const fs::path path = without_links(given);
  check_is_there(path);
  {
    Database database(path, Access::read_only);
    check_end(database);
    if (!has_log(path) && !FileHeader(database).has_write_ahead_log()) {
      (void)check_schema(database);
      return database;
    }
  }
  try {
    close_as_single_file(open_exclusively(path));
  } catch (const BackendError& error) {
    // A writer, alive or killed, has a log; without one the file is whole, wherever it lies.
    if (has_log(path)) {
      throw BackendError(error.what() + std::string(" If a run that was killed left it behind, ") +
                         "copy it, with the files beside it whose names begin with its own, to " +
                         "where it can be written.");
    }
    Database database(path, Access::immutable);
    (void)check_schema(database);
    return database;
  }
  return {path, Access::read_only};
}

using blobs::kLargestRow;

/// @tparam Values std::vector or Eigen::VectorXd.
template <class Values>
void bind_array(Statement& statement, const Values& values) {
  statement.bind(values.size() == 0 ? nullptr : static_cast<const void*>(values.data()),
                 static_cast<std::size_t>(values.size()) * sizeof(typename Values::value_type));
}

/// @throws InputError it has another size than the body tells.
template <class Number, class Values>
void take_array(Statement& statement, const blobs::Size<Number>& size, const Database& database,
                const char* what, Values& values) {
  if (!blobs::copy(statement.take_blob(), size, values)) {
    throw_damaged(database.path(), std::string(what) + " has another size than the body");
  }
}

constexpr char kAtKey[] =
    " WHERE scene_id = 1 AND tool_space_id = ? AND i = ? AND j = ? AND k = ? AND level = ?";

/// Corners of its coarsest cells, each of which takes memory.
std::int64_t coarsest_corners(const ToolSpaceSetup& setup) {
  const std::int64_t n = setup.grid.coarsest_resolution();
  return n * n * n;
}

/// What the surface of a rigid tool takes in its row.
std::int64_t bytes_of_surface(const ToolSpaceSetup& setup) {
  const RigidTool& tool = setup.interaction.tool;
  return static_cast<std::int64_t>(tool.points.size() * sizeof(tool.points[0]) +
                                   tool.triangles.size() * sizeof(tool.triangles[0]));
}

std::string describe(const ToolSpaceSetup& setup) {
  const auto& [id, interaction, grid, policy] = setup;
  const std::string what =
      interaction.is_contact()
          ? "contact thickness " + number(interaction.tool.law.thickness) +
                " m, contact stiffness " + number(interaction.tool.law.stiffness) +
                " Pa, drawn back by " + number(interaction.tool.law.offset) + " m, spacing " +
                number(grid.coarsest * grid.spacing()) + " m, depth " + number(policy.depth) + " m"
          : "tip radius " + number(interaction.tip_radius) + " m, half-width " +
                number(grid.half_width) + " m";
  return what + ", resolution " + std::to_string(grid.resolution) + ", coarsest cells of side " +
         std::to_string(grid.coarsest) + ", force limit " + number(policy.force_limit) +
         " N, tolerance " + number(policy.tolerance) +
         (policy.tolerance_is_relative ? " of the largest force" : " N") + ", " +
         std::to_string(policy.intermediate_states) + " intermediate states, " +
         (policy.third_derivatives ? "third derivatives" : "no third derivatives");
}

/// What a tool space is called of which no more than its number is known.
std::string number_of(ToolSpaceId tool_space) { return "tool space " + std::to_string(tool_space); }

/// Spacings that differ by less than this share are equal but for rounding.
constexpr double kSpacingRounding = 1e-12;

/// @throws InputError the tool space that is there is of no use for what is asked for.
void require_extension(const fs::path& path, const ToolSpaceSetup& there,
                       const ToolSpaceSetup& asked) {
  const double spacing = there.grid.spacing();
  const bool is_contact = there.interaction.is_contact();
  const bool is_same =
      there.interaction == asked.interaction && there.grid.coarsest == asked.grid.coarsest &&
      there.grid.origin == asked.grid.origin &&
      std::abs(spacing - asked.grid.spacing()) <= kSpacingRounding * spacing &&
      (is_contact || (there.policy.tolerance > 0) == (asked.policy.tolerance > 0)) &&
      there.policy.intermediate_states == asked.policy.intermediate_states &&
      there.policy.third_derivatives == asked.policy.third_derivatives;
  if (is_same && asked.grid.resolution >= there.grid.resolution) return;
  throw InputError(
      quoted(path) + " holds " + asked.name() + " with " + describe(there) + "; asked for was " +
      describe(asked) +
      (is_contact
           ? ". Give another file name, or those values: only depth, region, force limit and "
             "tolerance may change."
           : ". Give another file name, or those values: only the box may grow, by the same "
             "spacing, "
             "and force limit, tolerance and history may change."));
}

void write_scene(const Database& database, const Scene& scene, double solver_tolerance) {
  Statement insert(database, "INSERT INTO scene VALUES (1, NULL, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  const TetMesh& mesh = scene.mesh;
  insert.bind(hash(scene));
  insert.bind(solver_tolerance);
  insert.bind(static_cast<std::int64_t>(mesh.order));
  insert.bind(std::int64_t{mesh.num_points()});
  insert.bind(std::int64_t{mesh.num_cells()});
  bind_array(insert, mesh.points);
  bind_array(insert, mesh.cells);
  bind_array(insert, scene.material_of_cell);
  bind_array(insert, scene.fixed);
  bind_array(insert, scene.touchable);
  insert.bind(rows::checksum(scene.touchable, solver_tolerance));
  insert.run();
  static_assert(max_parameters == 10, "as the columns of the table");
  Statement insert_material(
      database, "INSERT INTO material VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    insert_material.bind(static_cast<std::int64_t>(m));
    insert_material.bind(static_cast<std::int64_t>(scene.materials[m].law));
    insert_material.bind(static_cast<std::int64_t>(scene.materials[m].formulation));
    for (double p : scene.materials[m].parameters) insert_material.bind(p);
    insert_material.run();
  }
}

/// @param scene It has a load.
void require_rest_of(const Scene& scene) {
  if (scene.settled.u.size() == 3 * Eigen::Index{scene.mesh.num_points()}) return;
  throw InputError(
      "The rest of the body under its load is needed to store its state space, and is not there. "
      "Find it first.");
}

/// Calls visit(name, array) for the arrays of what holds and loads the surface.
template <class AnyScene, class Visit>
void for_each_boundary_array(AnyScene& scene, const Visit& visit) {
  visit("HeldDirection", scene.held_directions);
  visit("SupportStiffness", scene.support_stiffness);
  visit("AppliedPressure", scene.applied_pressure);
  visit("AppliedTraction", scene.applied_traction);
}
constexpr char kRestDisplacement[] = "RestDisplacement";
constexpr char kRestPressure[] = "RestPressure";

/// The rest of a body is stored with the arrays of its surface.
bool rests_in_boundary(const Scene& scene) { return scene.has_load() && !scene.has_body_force(); }

/// @param scene It has supports or loads of its surface.
void write_boundary(const Database& database, const Scene& scene) {
  make_boundary_schema(database);
  Statement insert(database, "INSERT INTO boundary_array VALUES (1, ?, ?, ?)");
  const auto write = [&](const std::string& name, const auto& array) {
    using Value = std::decay_t<decltype(array[0])>;
    const Statement::Blob numbers{array.size() == 0 ? nullptr : array.data(),
                                  static_cast<std::size_t>(array.size()) * sizeof(Value)};
    insert.bind(name);
    insert.bind(rows::checksum(name, numbers));
    insert.bind(numbers.data, numbers.bytes);
    insert.run();
  };
  for_each_boundary_array(scene, [&](const char* name, const auto& array) {
    if (!array.empty()) write(name, array);
  });
  if (!rests_in_boundary(scene)) return;
  require_rest_of(scene);
  write(kRestDisplacement, scene.settled.u);
  write(kRestPressure, scene.settled.p);
}

/// @param scene It has a body force.
void write_body_force(const Database& database, const Scene& scene) {
  require_rest_of(scene);
  make_body_force_schema(database);
  Statement insert(database, "INSERT INTO body_force VALUES (1, ?, ?, ?, ?, ?)");
  insert.bind(scene.body_force.data(), 3 * sizeof(double));
  bind_array(insert, scene.densities);
  bind_array(insert, scene.settled.u);
  bind_array(insert, scene.settled.p);
  insert.bind(rows::checksum(scene.settled));
  insert.run();
}

/// The bytes of the numbers of a row, at the most.
constexpr std::int64_t kOfNumbers = 1 << 16;

/// A value of a row without a basis is no larger, and neither is the memory that is taken to read
/// it.
std::int64_t largest_row(std::int64_t num_points, std::int64_t num_cells) {
  // The scene: points, fixed, touchable, or directions; at most ten nodes a cell, and its material.
  const std::int64_t of_scene = num_points * (6 * 8 + 2) + num_cells * (10 + 1) * 4;
  // u and v; p and p_v at most at four corners a cell.
  const std::int64_t of_fields = num_points * 12 * 8 + num_cells * 16 * 8;
  return std::max(of_scene, of_fields) + kOfNumbers;
}

/// Makes a statement ready for the next time at the end.
struct Reset {
  Statement& statement;
  ~Reset() { statement.reset(); }
};

/// The oldest version in which a tool has a surface of its own.
constexpr std::int64_t kFirstWithSurfaces = 8;

/// A basis whose modes take no more memory than this is read, however few bytes it has in the file.
constexpr std::int64_t kAnyBasis = std::int64_t{64} << 20;

/// Of a basis with r modes, the configurations that were reduced have no fewer than r²/4
/// coefficients: r is at most the number of their fields and derivatives. Three quarters of them
/// may have been lost.
constexpr std::int64_t kMostModesSquared = 16;

/// The part of a file that is free when it is worth the time to make it smaller.
constexpr double kFreeShare = 0.1;

/// A commit waits for the disk when the last one that did is so long ago: a loss of power takes no
/// more than what was computed meanwhile, and the disk is waited for once in that time.
constexpr std::chrono::seconds kSyncEvery{1};

}  // namespace

struct StateSpaceFile::Impl {
  explicit Impl(Database opened)
      : database(std::move(opened)), version(database.integer("PRAGMA user_version")) {
    Statement select(database,
                     "SELECT hash, solver_tolerance, num_points, num_cells FROM scene WHERE "
                     "scene_id = 1");
    if (!select.step()) throw_damaged(path(), "it holds no scene");
    scene_hash = select.take_text();
    solver_tolerance = select.take_double();
    num_points = select.take_integer();
    num_cells = select.take_integer();
    if (num_points < 0 || num_points > kLargestRow || num_cells < 0 || num_cells > kLargestRow ||
        largest_row(num_points, num_cells) > kLargestRow) {
      throw_damaged(path(), "a body of " + std::to_string(num_points) + " points and " +
                                std::to_string(num_cells) + " cells");
    }
    limit_row(largest_row(num_points, num_cells));
    // A body may be touched by a tool with a surface that is finer than its own.
    if (version >= kFirstWithSurfaces) {
      make_room_for_bytes(
          database.integer("SELECT max(coalesce(length(tool_points), 0) + "
                           "coalesce(length(tool_triangles), 0)) FROM tool_space"));
    }
  }

  [[nodiscard]] const fs::path& path() const { return database.path(); }
  [[nodiscard]] rows::Checked checked() const {
    if (version < 6) return rows::Checked::as_version_5;
    if (version < 7) return rows::Checked::as_version_6;
    if (version < 8) return rows::Checked::as_version_7;
    return version < 10 ? rows::Checked::as_version_9 : rows::Checked::all;
  }
  /// A displacement that is whole has no fewer bytes; coefficients of modes have.
  [[nodiscard]] std::int64_t bytes_of_whole() const {
    return num_points * 3 * static_cast<std::int64_t>(sizeof(float));
  }
  /// Whether a scene and a tool space have a checksum.
  [[nodiscard]] bool has_checksums() const { return version >= 6; }

  /// Calls take(select, rowid) for each row of a table of a tool space, in the order of the key;
  /// what it cannot take it leaves out itself. Where a part of the table cannot be read, the other
  /// rows are read one by one.
  /// @param key The columns of the key, the first three of them i, j and k.
  /// @param condition On the row.
  /// @param forget Is called when rows come again, from the first.
  template <class Take, class Forget>
  void for_each_row(const std::string& table, const std::string& columns,
                    const std::vector<std::string>& key, ToolSpaceId tool_space,
                    const std::string& condition, Take&& take, Forget&& forget) const;
  /// The numbers and check-points of the rows, as far as they can be listed, in the order of the
  /// key.
  [[nodiscard]] std::vector<std::pair<std::int64_t, CheckPoint>> list_rows(
      const std::string& table, const std::vector<std::string>& key, ToolSpaceId tool_space,
      const std::string& condition) const;

  /// Is called before each change: decides whether its commit waits for the disk.
  void before_change();
  /// Writes a tool space in place of what is there.
  void write(const ToolSpace& space) const;
  /// Gives a row of the table of configurations other numbers; its fields stay.
  /// @param level That it is found by.
  void rewrite(ToolSpaceId tool_space, std::int32_t level,
               const ConfigurationSummary& summary) const;
  void write(ToolSpaceId tool_space, const IntermediateState& state) const;
  void set_touchable(const std::vector<char>& touchable) const;
  /// Whether fields that are whole have the sizes of the body.
  [[nodiscard]] bool fit(const rows::Fields& fields) const {
    return rows::fit(fields, num_points, fields[2].bytes > 0 ? num_pressures() : 0);
  }
  /// Inserts a row of the table of configurations, in place of one with the same key.
  void insert_configuration(ToolSpaceId tool_space, const ConfigurationSummary& summary,
                            const rows::Fields& fields);
  /// Of a row; one that is larger counts as damaged.
  mutable std::int64_t most_bytes_of_row = 0;
  void limit_row(std::int64_t bytes) const {
    most_bytes_of_row = bytes;
    database.limit_row(bytes);
  }
  /// Lets a row hold such a basis.
  void make_room_for(const PackedBasis& basis) const {
    make_room_for_bytes(most_bytes(basis, num_points));
  }
  /// Lets a row hold so many bytes beside its numbers.
  void make_room_for_bytes(std::int64_t bytes) const {
    const std::int64_t of_row = std::min(bytes + kOfNumbers, kLargestRow);
    if (of_row > most_bytes_of_row) limit_row(of_row);
  }
  /// A row of the table of bases. The modes are read when they are first asked for.
  struct StoredBasis {
    std::int64_t row_id = 0;
    std::int64_t checksum = 0;
    rows::BasisRow row;
    bool is_read = false;
    std::shared_ptr<const FieldBasis> basis;
  };
  /// Of all reduced models, also of those that are not complete.
  [[nodiscard]] std::vector<std::string> keys_of_arrays() const;
  /// Those of a tool space, in the order of their numbers.
  [[nodiscard]] std::vector<StoredBasis>& bases_of(ToolSpaceId tool_space) const;
  /// Null where it is damaged, which is left out.
  [[nodiscard]] std::shared_ptr<const FieldBasis> basis_of(ToolSpaceId tool_space,
                                                           StoredBasis& stored) const;
  [[nodiscard]] std::shared_ptr<const FieldBasis> read_basis(ToolSpaceId tool_space,
                                                             const StoredBasis& stored) const;
  /// Nothing where the modes are damaged.
  [[nodiscard]] std::optional<FieldBasis> read_modes(const StoredBasis& stored,
                                                     std::int64_t num_kept) const;
  /// The same of version 9, where each mode has a row.
  [[nodiscard]] std::optional<FieldBasis> read_modes_of_9(ToolSpaceId tool_space,
                                                          const rows::BasisRow& row,
                                                          std::int64_t num_kept) const;
  /// @throws InputError its arrays have not the size of the body, or a cell is none.
  [[nodiscard]] TetMesh read_mesh() const;
  /// Reads materials, and which cell is of which. @throws InputError one is none.
  void read_materials(Scene& scene) const;
  /// Of the body; counted when it is first asked for.
  [[nodiscard]] Index num_pressures() const;
  /// Whether what is there explains so many modes.
  [[nodiscard]] bool are_explained(ToolSpaceId tool_space, const PackedBasis& head,
                                   std::int64_t num_kept) const;
  /// Reads body force, densities and rest. @param scene It has its materials.
  /// @throws InputError they are damaged.
  void read_body_force(Scene& scene) const;
  /// Reads what holds and loads the surface, and the rest where it is with that.
  /// @throws InputError it is damaged.
  void read_boundary(Scene& scene) const;
  /// Of the layer of a rigid tool, m.
  [[nodiscard]] double contact_offset(ToolSpaceId tool_space) const;
  /// Where the body is at rest; read when it is first asked for.
  [[nodiscard]] const SettledBody& settled() const;
  mutable std::optional<SettledBody> settled_body;
  /// As kept_points(), made when it is first asked for.
  [[nodiscard]] const std::vector<Index>& points_of(Keep keep) const;
  mutable std::map<ToolSpaceId, std::vector<StoredBasis>> bases;
  Known own_known;
  Known* known = &own_known;
  mutable std::map<Keep, std::vector<Index>> points;
  mutable std::optional<TetMesh> mesh;

  Database database;
  std::int64_t version;
  bool writes = false;
  std::string scene_hash;
  double solver_tolerance = 0;
  std::int64_t num_points = 0;
  std::int64_t num_cells = 0;
  /// Prepared at the first use.
  std::optional<Statement> insert;
  mutable std::optional<Statement> select_fields;
  mutable std::optional<Statement> select_outcome;
  std::optional<bool> commits_wait;
  std::chrono::steady_clock::time_point last_wait;
  /// Where a row is that was found damaged; 0: its number is not known.
  struct Place {
    std::string table;
    std::int64_t row = 0;
  };
  void leave_out(const std::string& what, const std::string& table, std::int64_t row) const {
    left_out[{what, row}] = Place{table, row};
  }
  /// What was found damaged, by its name and row; reading adds to it.
  mutable std::map<std::pair<std::string, std::int64_t>, Place> left_out;
};

template <class Take, class Forget>
void StateSpaceFile::Impl::for_each_row(const std::string& table, const std::string& columns,
                                        const std::vector<std::string>& key, ToolSpaceId tool_space,
                                        const std::string& condition, Take&& take,
                                        Forget&& forget) const {
  try {
    Statement select(database, "SELECT rowid, " + columns + " FROM " + table +
                                   " WHERE scene_id = 1 AND tool_space_id = ? AND " + condition +
                                   " ORDER BY " + join(key));
    select.bind(tool_space);
    while (select.step()) {
      const std::int64_t row = select.take_integer();
      take(select, row);
    }
    return;
  } catch (const InputError&) {
    forget();
  }
  for (const auto& [row, check_point] : list_rows(table, key, tool_space, condition)) {
    try {
      Statement select(database,
                       "SELECT rowid, " + columns + " FROM " + table + " WHERE rowid = ?");
      select.bind(row);
      if (select.step()) {
        take(select, select.take_integer());
        continue;
      }
    } catch (const InputError&) {
    }
    leave_out("a row of the table " + table + " at " + describe(check_point) + " of " +
                  number_of(tool_space),
              table, row);
  }
}

std::vector<std::pair<std::int64_t, CheckPoint>> StateSpaceFile::Impl::list_rows(
    const std::string& table, const std::vector<std::string>& key, ToolSpaceId tool_space,
    const std::string& condition) const {
  // From both ends to where they cannot be read on. The index of the key holds all that is asked
  // for.
  std::vector<std::pair<std::int64_t, CheckPoint>> listed;
  std::set<std::int64_t> numbers;
  for (const char* direction : {" ASC", " DESC"}) {
    std::string order;
    for (const std::string& column : key) order += (order.empty() ? "" : ", ") + column + direction;
    const auto first = static_cast<std::ptrdiff_t>(listed.size());
    try {
      Statement select(database, "SELECT rowid, i, j, k FROM " + table +
                                     " WHERE scene_id = 1 AND tool_space_id = ? AND " + condition +
                                     " ORDER BY " + order);
      select.bind(tool_space);
      while (select.step()) {
        const std::int64_t row = select.take_integer();
        CheckPoint check_point;
        for (auto& x : check_point) x = static_cast<std::int32_t>(select.take_integer());
        if (numbers.insert(row).second) listed.emplace_back(row, check_point);
      }
      break;
    } catch (const InputError&) {
      leave_out("rows of the table " + table + " of " + number_of(tool_space) +
                    " that cannot be told apart",
                table, 0);
    }
    if (first > 0) std::reverse(listed.begin() + first, listed.end());
  }
  return listed;
}

void StateSpaceFile::Impl::before_change() {
  if (database.is_in_transaction()) return;
  const auto now = std::chrono::steady_clock::now();
  const bool waits = !commits_wait || now - last_wait >= kSyncEvery;
  if (waits) last_wait = now;
  if (commits_wait == waits) return;
  database.execute(waits ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL");
  commits_wait = waits;
}

void StateSpaceFile::Impl::write(const ToolSpace& space) const {
  make_room_for_bytes(bytes_of_surface(space.setup));
  std::string parameters;
  for (int c = 0; c < rows::num_tool_space_columns + 1; ++c) parameters += ", ?";
  Statement insert_space(database, std::string("INSERT OR REPLACE INTO tool_space (scene_id, ") +
                                       rows::tool_space_columns + ", checksum) VALUES (1" +
                                       parameters + ")");
  rows::for_each_number_of_tool_space(space, rows::Bind{insert_space});
  insert_space.bind(rows::checksum(space));
  insert_space.run();
  const double offset = space.setup.interaction.tool.law.offset;
  if (offset == 0) return;
  make_contact_offset_schema(database);
  Statement insert_offset(database, "INSERT OR REPLACE INTO contact_offset VALUES (1, ?, ?)");
  insert_offset.bind(space.setup.id);
  insert_offset.bind(offset);
  insert_offset.run();
}

double StateSpaceFile::Impl::contact_offset(ToolSpaceId tool_space) const {
  if (!has_contact_offset_schema(database)) return 0;
  Statement select(database,
                   "SELECT distance FROM contact_offset WHERE scene_id = 1 AND tool_space_id = ?");
  select.bind(tool_space);
  return select.step() ? select.take_double() : 0;
}

void StateSpaceFile::Impl::rewrite(ToolSpaceId tool_space, std::int32_t level,
                                   const ConfigurationSummary& summary) const {
  const auto bind_key = [&](Statement& statement) {
    statement.bind(tool_space);
    for (std::int32_t x : summary.check_point) statement.bind(std::int64_t{x});
    statement.bind(std::int64_t{level});
  };
  std::int64_t of_fields = 0;
  {
    Statement select(database, std::string("SELECT checksum FROM configuration") + kAtKey);
    bind_key(select);
    if (!select.step()) return;
    of_fields = select.take_integer();
  }
  Statement update(database, std::string("UPDATE configuration SET level = ?, flags = ?, "
                                         "summary_checksum = ?") +
                                 kAtKey);
  update.bind(std::int64_t{summary.level});
  update.bind(std::int64_t{summary.flags});
  update.bind(rows::checksum(tool_space, summary, of_fields));
  bind_key(update);
  update.run();
}

void StateSpaceFile::Impl::write(ToolSpaceId tool_space, const IntermediateState& state) const {
  Statement insert_state(
      database, std::string("INSERT OR REPLACE INTO intermediate (scene_id, tool_space_id, ") +
                    rows::intermediate_columns +
                    ", checksum) VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, "
                    "?)");
  insert_state.bind(tool_space);
  rows::for_each_number_of_intermediate(state, rows::Bind{insert_state});
  insert_state.bind(rows::checksum(tool_space, state));
  insert_state.run();
}

void StateSpaceFile::Impl::set_touchable(const std::vector<char>& touchable) const {
  Statement update(
      database,
      "UPDATE scene SET touchable = ?1, checksum = ?2 WHERE touchable <> ?1 OR checksum "
      "IS NOT ?2");
  bind_array(update, touchable);
  update.bind(rows::checksum(touchable, solver_tolerance));
  update.run();
}

void StateSpaceFile::Impl::insert_configuration(ToolSpaceId tool_space,
                                                const ConfigurationSummary& summary,
                                                const rows::Fields& fields) {
  if (!insert) {
    std::string parameters = "?1";
    for (int c = 1; c < rows::num_summary_columns + 7; ++c) {
      parameters += ", ?" + std::to_string(c + 1);
    }
    // Through the table of tool spaces, so that nothing is stored for a tool space that is not
    // there.
    insert.emplace(database, "INSERT OR REPLACE INTO configuration (scene_id, tool_space_id, " +
                                 std::string(rows::summary_columns) +
                                 ", summary_checksum, checksum, " + rows::field_columns +
                                 ") SELECT 1, " + parameters +
                                 " FROM tool_space WHERE scene_id = 1 AND tool_space_id = ?1");
  }
  insert->bind(tool_space);
  rows::for_each_number_of_summary(summary, rows::Bind{*insert});
  const std::int64_t of_fields = rows::checksum(fields);
  insert->bind(rows::checksum(tool_space, summary, of_fields));
  insert->bind(of_fields);
  for (const auto& [data, bytes] : fields) insert->bind(data, bytes);
  insert->run();
}

TetMesh StateSpaceFile::Impl::read_mesh() const {
  Statement select(database, "SELECT element_order, points, cells FROM scene WHERE scene_id = 1");
  select.step();
  TetMesh read;
  const std::int64_t order = select.take_integer();
  if (order != 1 && order != 2) throw_damaged(path(), "an unknown order of elements");
  read.order = static_cast<ElementOrder>(order);
  take_array(select, blobs::points(num_points), database, "points", read.points);
  take_array(select, blobs::cells(num_cells, nodes_per_cell(read.order)), database, "cells",
             read.cells);
  if (std::any_of(read.cells.begin(), read.cells.end(),
                  [&](Index p) { return p < 0 || p >= num_points; })) {
    throw_damaged(path(), "a cell of the body is none");
  }
  return read;
}

void StateSpaceFile::Impl::read_materials(Scene& scene) const {
  {
    Statement select(database, "SELECT material_of_cell FROM scene WHERE scene_id = 1");
    select.step();
    take_array(select, blobs::material_of_cell(num_cells), database, "material_of_cell",
               scene.material_of_cell);
  }
  Statement select(database,
                   "SELECT law, formulation, parameter_0, parameter_1, parameter_2, "
                   "parameter_3, parameter_4, parameter_5, parameter_6, parameter_7, "
                   "parameter_8, parameter_9 FROM material WHERE scene_id = 1 ORDER BY material");
  while (select.step()) {
    const std::int64_t law = select.take_integer();
    if (law < 0 || law >= num_laws) throw_damaged(path(), "an unknown law");
    const std::int64_t formulation = select.take_integer();
    if (formulation < 0 || formulation >= num_formulations) {
      throw_damaged(path(), "an unknown formulation");
    }
    std::array<double, max_parameters> parameters{};
    for (double& p : parameters) p = select.take_double();
    try {
      Material& material = scene.materials.emplace_back(with_formulation(
          make_material(static_cast<Law>(law), parameters), static_cast<Formulation>(formulation)));
      // The hash takes in those that the law has not, as they were given.
      material.parameters = parameters;
    } catch (const InputError& error) {
      throw_damaged(path(), std::string("a material is none: ") + error.what());
    }
  }
  const auto known_materials = static_cast<Index>(scene.materials.size());
  if (known_materials == 0 ||
      std::any_of(scene.material_of_cell.begin(), scene.material_of_cell.end(),
                  [&](Index m) { return m < 0 || m >= known_materials; })) {
    throw_damaged(path(), "a material is missing");
  }
}

Index StateSpaceFile::Impl::num_pressures() const {
  if (!known->num_pressures) {
    Scene scene;
    scene.mesh = read_mesh();
    read_materials(scene);
    known->num_pressures = count_pressures(scene);
  }
  return *known->num_pressures;
}

void StateSpaceFile::Impl::read_body_force(Scene& scene) const {
  Statement select(database,
                   "SELECT acceleration, densities, displacement, pressures, checksum FROM "
                   "body_force WHERE scene_id = 1");
  if (!select.step()) throw_damaged(path(), "the body force is missing");
  take_array(select, blobs::vector(), database, "acceleration", scene.body_force);
  const auto num_materials = static_cast<std::int64_t>(scene.materials.size());
  take_array(select, blobs::densities(num_materials), database, "densities", scene.densities);
  take_array(select, blobs::settled_displacement(num_points), database, "the displacement at rest",
             scene.settled.u);
  take_array(select, blobs::pressures<double>(num_pressures()), database, "the pressures at rest",
             scene.settled.p);
  if (select.take_integer() != rows::checksum(scene.settled) || !scene.settled.u.allFinite() ||
      !scene.settled.p.allFinite()) {
    throw_damaged(path(), "the rest under the body force is none");
  }
  if (!scene.body_force.allFinite() || scene.body_force.isZero(0) ||
      !std::all_of(scene.densities.begin(), scene.densities.end(),
                   [](double density) { return std::isfinite(density) && density >= 0; })) {
    throw_damaged(path(), "the body force is none");
  }
}

void StateSpaceFile::Impl::read_boundary(Scene& scene) const {
  Statement select(database,
                   "SELECT name, checksum, numbers FROM boundary_array WHERE scene_id = 1");
  while (select.step()) {
    const std::string name = select.take_text();
    const std::int64_t sum = select.take_integer();
    const Statement::Blob numbers = select.take_blob();
    bool is_good = rows::checksum(name, numbers) == sum;
    const auto take = [&](const auto& size, auto& array) {
      is_good = is_good && blobs::copy(numbers, size, array);
    };
    if (name == kRestDisplacement) {
      take(blobs::settled_displacement(num_points), scene.settled.u);
    } else if (name == kRestPressure) {
      take(blobs::pressures<double>(num_pressures()), scene.settled.p);
    } else {
      bool is_known = false;
      for_each_boundary_array(scene, [&](const char* known_name, auto& array) {
        if (name != known_name) return;
        is_known = true;
        take(blobs::boundary_array(num_points, sizeof array[0] / sizeof(double)), array);
      });
      is_good = is_good && is_known;
    }
    if (!is_good) throw_damaged(path(), "the array " + name + " of the boundary is none");
  }
  if (!scene.settled.u.allFinite() || !scene.settled.p.allFinite()) {
    throw_damaged(path(), "the rest under the loads is none");
  }
  const bool lacks_rest = rests_in_boundary(scene) && scene.settled.u.size() == 0;
  if (!scene.has_supports_or_surface_loads() || lacks_rest) {
    throw_damaged(path(), "the supports and loads of the body are not complete");
  }
}

const SettledBody& StateSpaceFile::Impl::settled() const {
  if (settled_body) return *settled_body;
  settled_body.emplace();
  Scene scene;
  if (!has_body_force_schema(database)) {
    if (has_boundary_schema(database)) read_boundary(scene);
    return *(settled_body = std::move(scene.settled));
  }
  read_materials(scene);
  read_body_force(scene);
  return *(settled_body = std::move(scene.settled));
}

const std::vector<Index>& StateSpaceFile::Impl::points_of(Keep keep) const {
  const auto [found, is_new] = points.try_emplace(keep);
  if (!is_new) return found->second;
  if (!mesh) mesh = read_mesh();
  found->second = kept_points(*mesh, make_surface(*mesh), keep);
  return found->second;
}

std::vector<std::string> StateSpaceFile::Impl::keys_of_arrays() const {
  std::vector<std::string> keys;
  if (!has_reduced_schema(database)) return keys;
  Statement select(database, "SELECT DISTINCT model FROM reduced_array WHERE scene_id = 1");
  while (select.step()) keys.push_back(select.take_text());
  return keys;
}

std::vector<StateSpaceFile::Impl::StoredBasis>& StateSpaceFile::Impl::bases_of(
    ToolSpaceId tool_space) const {
  const auto [found, is_new] = bases.try_emplace(tool_space);
  std::vector<StoredBasis>& all = found->second;
  if (!is_new || version < 9) return all;
  Statement select(database, std::string("SELECT rowid, ") + rows::basis_columns +
                                 ", checksum FROM basis WHERE scene_id = 1 AND tool_space_id = ? "
                                 "ORDER BY number");
  select.bind(tool_space);
  while (select.step()) {
    StoredBasis& stored = all.emplace_back();
    stored.row_id = select.take_integer();
    bool sound = true;
    rows::for_each_number_of_basis(stored.row, rows::Take{select, sound});
    stored.checksum = select.take_integer();
    if (sound && stored.checksum == rows::checksum(tool_space, stored.row, checked()) &&
        rows::is_possible(stored.row, num_points, num_cells)) {
      make_room_for(stored.row.basis);
      continue;
    }
    leave_out("a basis of " + number_of(tool_space), "basis", stored.row_id);
    all.pop_back();
  }
  return all;
}

std::shared_ptr<const FieldBasis> StateSpaceFile::Impl::basis_of(ToolSpaceId tool_space,
                                                                 StoredBasis& stored) const {
  if (stored.is_read) return stored.basis;
  stored.is_read = true;
  const auto found = known->bases.find({tool_space, stored.checksum});
  if (found != known->bases.end()) return stored.basis = found->second;
  stored.basis = read_basis(tool_space, stored);
  if (stored.basis != nullptr) known->bases[{tool_space, stored.checksum}] = stored.basis;
  return stored.basis;
}

std::shared_ptr<const FieldBasis> StateSpaceFile::Impl::read_basis(
    ToolSpaceId tool_space, const StoredBasis& stored_basis) const {
  const rows::BasisRow& row = stored_basis.row;
  const auto num_kept = static_cast<std::int64_t>(points_of(row.basis.keep).size());
  std::optional<FieldBasis> basis;
  if (rows::is_possible(row, num_kept, num_cells) &&
      (row.basis.num_pressures == 0 || row.basis.num_pressures == num_pressures()) &&
      are_explained(tool_space, row.basis, num_kept)) {
    basis = version == 9 ? read_modes_of_9(tool_space, row, num_kept)
                         : read_modes(stored_basis, num_kept);
  }
  if (!basis) {
    leave_out("basis " + std::to_string(row.number) + " of " + number_of(tool_space), "basis",
              stored_basis.row_id);
    return nullptr;
  }
  return std::make_shared<const FieldBasis>(std::move(*basis));
}

std::optional<FieldBasis> StateSpaceFile::Impl::read_modes(const StoredBasis& stored,
                                                           std::int64_t num_kept) const {
  Statement select(database,
                   std::string("SELECT ") + rows::mode_columns + " FROM basis WHERE rowid = ?");
  select.bind(stored.row_id);
  if (!select.step()) return std::nullopt;
  std::array<Statement::Blob, 2> modes;
  for (Statement::Blob& blob : modes) blob = select.take_blob();
  if (rows::checksum(modes) != stored.row.modes_checksum) return std::nullopt;
  PackedBasis packed = stored.row.basis;
  if (!rows::set_modes(modes, num_kept, packed)) return std::nullopt;
  return unpack(packed, num_kept);
}

bool StateSpaceFile::Impl::are_explained(ToolSpaceId tool_space, const PackedBasis& head,
                                         std::int64_t num_kept) const {
  const std::int64_t most = std::max(head.num_modes, head.num_pressure_modes);
  if (most_bytes(head, num_kept) <= kAnyBasis) return true;
  Statement select(database,
                   "SELECT coalesce(sum(length(u)), 0) FROM configuration WHERE scene_id = 1 AND "
                   "tool_space_id = ?");
  select.bind(tool_space);
  select.step();
  const std::int64_t num_coefficients = select.take_integer() / std::int64_t{sizeof(float)};
  return most * most <= kMostModesSquared * num_coefficients;
}

std::optional<FieldBasis> StateSpaceFile::Impl::read_modes_of_9(ToolSpaceId tool_space,
                                                                const rows::BasisRow& row,
                                                                std::int64_t num_kept) const {
  const std::int64_t num_modes = row.basis.num_modes + row.basis.num_pressure_modes;
  constexpr char kOfBasis[] = " FROM mode WHERE scene_id = 1 AND tool_space_id = ? AND basis = ?";
  // No memory is taken for modes that are not there.
  {
    Statement count(database,
                    std::string("SELECT count(*), coalesce(sum(length(field)), 0)") + kOfBasis);
    count.bind(tool_space);
    count.bind(row.number);
    count.step();
    if (count.take_integer() != num_modes) return std::nullopt;
    const std::int64_t num_numbers =
        3 * num_kept * row.basis.num_modes + row.basis.num_pressures * row.basis.num_pressure_modes;
    if (count.take_integer() < num_numbers * std::int64_t{sizeof(Eigen::half)}) return std::nullopt;
  }
  FieldBasis basis;
  static_cast<BasisHead&>(basis) = row.basis;
  basis.modes.resize(3 * num_kept, row.basis.num_modes);
  basis.pressure_modes.resize(row.basis.num_pressures, row.basis.num_pressure_modes);
  basis.steps.setZero(num_modes);
  Statement select(database, std::string("SELECT of_pressure, number, checksum, field") + kOfBasis +
                                 " ORDER BY of_pressure, number");
  select.bind(tool_space);
  select.bind(row.number);
  for (std::int64_t m = 0; m < num_modes; ++m) {
    if (!select.step()) return std::nullopt;
    rows::ModeKey key{row.number, 0, 0};
    key.of_pressure = select.take_integer();
    key.number = select.take_integer();
    const std::int64_t stored = select.take_integer();
    const Statement::Blob field = select.take_blob();
    const bool of_pressure = m >= row.basis.num_modes;
    Eigen::MatrixXf& modes = of_pressure ? basis.pressure_modes : basis.modes;
    const std::int64_t number = of_pressure ? m - row.basis.num_modes : m;
    const auto size = static_cast<std::size_t>(modes.rows());
    const bool is_half = field.bytes == size * sizeof(Eigen::half);
    if (key.of_pressure != (of_pressure ? 1 : 0) || key.number != number ||
        !(is_half || field.bytes == size * sizeof(float)) ||
        rows::checksum(tool_space, key, field) != stored) {
      return std::nullopt;
    }
    auto column = modes.col(number);
    if (is_half) {
      Eigen::Matrix<Eigen::half, Eigen::Dynamic, 1> halves(modes.rows());
      if (size > 0) std::memcpy(halves.data(), field.data, field.bytes);
      column = halves.cast<float>();
    } else if (size > 0) {
      std::memcpy(column.data(), field.data, field.bytes);
    }
  }
  if (!basis.modes.allFinite() || !basis.pressure_modes.allFinite()) return std::nullopt;
  return basis;
}

StateSpaceFile::StateSpaceFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
StateSpaceFile::StateSpaceFile(StateSpaceFile&&) noexcept = default;
StateSpaceFile& StateSpaceFile::operator=(StateSpaceFile&&) noexcept = default;

StateSpaceFile::~StateSpaceFile() {
  try {
    if (impl_) close();
  } catch (const std::exception&) {
    // The log is left beside the file, and is taken up when it is opened again.
  }
}

namespace {

/// Makes the file of a scene under a name that no file has. @returns False: one has it by now.
bool make_file(const fs::path& path, const Scene& scene, double solver_tolerance) {
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder)) {
    throw InputError("There is no folder " + quoted(folder) + ". Make it, or give another file " +
                     "name.");
  }
  require_short_name(path);
  if (largest_row(scene.mesh.num_points(), scene.mesh.num_cells()) > kLargestRow) {
    throw InputError("The body has " + std::to_string(scene.mesh.num_points()) + " points and " +
                     std::to_string(scene.mesh.num_cells()) +
                     " cells: more than a state-space file can hold. Take a coarser mesh.");
  }
  // It would be taken for a log of the new file, and may hold what was computed last.
  for (const char* suffix : {"-wal", "-journal"}) {
    const fs::path log = path.string() + suffix;
    if (!fs::exists(path) && fs::exists(log)) {
      throw InputError(quoted(log) + " is the log of a file " + quoted(path) +
                       " that is not there any more, and holds what was computed last. Bring that "
                       "file back, or move the log away, or give another file name.");
    }
  }
  NewFile part(path);
  {
    const Database database(part.path(), Access::read_write);
    database.execute("PRAGMA page_size = " + std::to_string(kPageSize));
    database.execute("PRAGMA journal_mode = MEMORY");
    Transaction transaction(database);
    make_schema(database);
    write_scene(database, scene, solver_tolerance);
    if (scene.has_body_force()) write_body_force(database, scene);
    if (scene.has_supports_or_surface_loads()) write_boundary(database, scene);
    transaction.commit();
  }
  return part.put_where_none_is();
}

}  // namespace

StateSpaceFile StateSpaceFile::create(const fs::path& path, const Scene& scene,
                                      double solver_tolerance) {
  const fs::path target = without_links(path);
  if (fs::exists(target) || !make_file(target, scene, solver_tolerance)) {
    throw InputError(quoted(path) + " is there already. Open it to append, or give another file " +
                     "name.");
  }
  return open_to_append(target, scene, solver_tolerance);
}

StateSpaceFile StateSpaceFile::open_to_append(const fs::path& path, const Scene& scene,
                                              double solver_tolerance) {
  StateSpaceFile file(std::make_unique<Impl>(open_exclusively(path)));
  Impl& impl = *file.impl_;
  const Database& database = impl.database;
  file.require(scene, solver_tolerance);
  if (database.text("PRAGMA journal_mode = WAL") != "wal") {
    throw BackendError("A write-ahead log cannot be kept beside " + quoted(path) +
                       ". Give a file name on another disk.");
  }
  impl.writes = true;
  // The file is there, and no other writer has it.
  remove_unfinished(database.path());
  impl.before_change();
  if (impl.version < kSchemaVersion) file.upgrade();
  // What may be touched is no part of the hash, and may have changed since.
  impl.set_touchable(scene.touchable);
  return file;
}

void StateSpaceFile::require(const Scene& scene, double solver_tolerance) const {
  const std::string wanted = hash(scene);
  if (impl_->scene_hash != wanted) {
    throw InputError(
        quoted(path()) + " holds the state space of another scene: its hash is " +
        impl_->scene_hash +
        ", that of this scene (mesh, materials, fixed points, supports and loads, and " +
        "with a BodyForce that and the densities) is " + wanted +
        ". Give another file name, or restore the scene it was made for.");
  }
  if (impl_->solver_tolerance != solver_tolerance) {
    throw InputError(quoted(path()) + " was computed with the solver tolerance " +
                     number(impl_->solver_tolerance) + ", not " + number(solver_tolerance) +
                     " (scene " + wanted + " in both). Give another file name, or that tolerance.");
  }
}

StateSpaceFile StateSpaceFile::open_or_create(const fs::path& path, const Scene& scene,
                                              double solver_tolerance) {
  const fs::path target = without_links(path);
  // Where another run is the first to make it, it is opened as one that was there.
  if (!fs::exists(target)) (void)make_file(target, scene, solver_tolerance);
  return open_to_append(target, scene, solver_tolerance);
}

bool StateSpaceFile::is_being_written(const fs::path& path) { return has_log(without_links(path)); }

StateSpaceFile StateSpaceFile::open_read_only(const fs::path& path) {
  auto impl = std::make_unique<Impl>(open_to_read(path));
  show_as_this_version(impl->database, impl->version);
  return StateSpaceFile(std::move(impl));
}

/// What is damaged stays so: its checksum is not made anew.
void StateSpaceFile::upgrade() {
  show_as_this_version(impl_->database, impl_->version);
  const std::vector<ToolSpace> tool_spaces = read_tool_spaces();
  // Before version 6 the checksums of these were others.
  std::map<ToolSpaceId, std::vector<Configuration>> configurations;
  std::map<ToolSpaceId, std::vector<IntermediateState>> states;
  if (impl_->checked() == rows::Checked::as_version_5) {
    for (const ToolSpace& space : tool_spaces) {
      const ToolSpaceId id = space.setup.id;
      configurations[id] = read_where(id, "true");
      states[id] = read_intermediate_states(id);
    }
  }
  std::map<ToolSpaceId, std::map<std::int64_t, PackedBasis>> bases;
  for (const ToolSpace& space : tool_spaces) {
    for (const BasisBox& box : list_bases(space.setup.id)) {
      const auto basis = read_basis(space.setup.id, box.number);
      if (basis != nullptr) bases[space.setup.id][box.number] = pack(*basis);
    }
  }
  show_as_it_is(impl_->database);
  Transaction transaction(impl_->database);
  convert_schema(impl_->database, impl_->version);
  for (const ToolSpace& space : tool_spaces) impl_->write(space);
  for (const auto& [id, of_space] : configurations) {
    for (const Configuration& c : of_space) impl_->rewrite(id, c.level, c);
  }
  for (const auto& [id, of_space] : states) {
    for (const IntermediateState& state : of_space) impl_->write(id, state);
  }
  for (const auto& [id, of_space] : bases) {
    for (const auto& [number, basis] : of_space) add_basis(id, number, basis);
  }
  transaction.commit();
  impl_->version = kSchemaVersion;
}

void StateSpaceFile::close() {
  const std::unique_ptr<Impl> impl = std::move(impl_);
  for (auto* statement : {&impl->insert, &impl->select_fields, &impl->select_outcome}) {
    statement->reset();
  }
  if (impl->writes) close_as_single_file(std::move(impl->database));
}

const fs::path& StateSpaceFile::path() const { return impl_->path(); }
const std::string& StateSpaceFile::scene_hash() const { return impl_->scene_hash; }
double StateSpaceFile::solver_tolerance() const { return impl_->solver_tolerance; }

std::vector<std::string> StateSpaceFile::left_out() const {
  std::vector<std::string> names;
  for (const auto& [key, place] : impl_->left_out) {
    if (names.empty() || names.back() != key.first) names.push_back(key.first);
  }
  // A row whose key was damaged may belong to nothing that is read, and where the index is damaged
  // a row is not found by its key.
  for (const auto& [table, key] :
       {std::pair{"tool_space", ""}, std::pair{"test_point", "tip_radius, half_width, seed"},
        std::pair{"configuration", ""}, std::pair{"transition", ""}, std::pair{"intermediate", ""},
        std::pair{"basis", ""}, std::pair{"reduced_array", "model, name"}}) {
    const std::string name = table;
    if (impl_->version < 9 && name == "basis") continue;
    const bool is_reduced = name == "reduced_array";
    if (is_reduced && !has_reduced_schema(impl_->database)) continue;
    const std::string of_table = "rows of the table " + name;
    const auto count = [&](const std::string& from) {
      return impl_->database.integer("SELECT count(*) FROM " + from);
    };
    const std::string no_tool_space =
        name == "tool_space" || name == "test_point" || is_reduced
            ? ""
            : " OR tool_space_id NOT IN (SELECT tool_space_id FROM tool_space WHERE scene_id = 1)";
    const std::string columns = std::string("scene_id") + (is_reduced ? "" : ", tool_space_id") +
                                (*key != '\0' ? ", " : "") + key;
    try {
      const std::int64_t of_nothing = count(name + " WHERE scene_id <> 1" + no_tool_space);
      if (of_nothing > 0) {
        names.push_back(
            std::to_string(of_nothing) + ' ' + of_table +
            (is_reduced ? " that belong to no model" : " that belong to no tool space"));
      }
      const std::string found = "(SELECT DISTINCT " + columns + " FROM " + name +
                                " NOT INDEXED) CROSS JOIN " + name + " USING (" + columns + ")";
      if (count(found) != count(name + " NOT INDEXED") || count(name) != count(found)) {
        names.push_back(of_table + " that are not in its index");
      }
    } catch (const InputError&) {
      names.push_back(of_table + " that cannot be listed");
    }
  }
  return names;
}

std::vector<std::string> StateSpaceFile::remove_damaged() {
  for (const ToolSpace& space : read_tool_spaces()) {
    const ToolSpaceId id = space.setup.id;
    for (const BasisBox& box : list_bases(id)) (void)read_basis(id, box.number);
    for (const Configuration& c : read_where(id, "true")) {
      StoredFields stored;
      (void)read_stored(id, c, stored);
    }
    (void)read_transitions(id);
    (void)read_intermediate_states(id);
  }
  for (const TestSet& set : read_test_sets()) (void)read_test_points(set);
  for (const std::string& key : impl_->keys_of_arrays()) {
    for (const bool of_training : {false, true}) (void)read_arrays(key, of_training);
  }
  if (impl_->left_out.empty()) return {};
  std::vector<std::string> names;
  bool is_way_damaged = false;
  impl_->before_change();
  Transaction transaction(impl_->database);
  for (const auto& [key, place] : impl_->left_out) {
    const std::string& name = key.first;
    if (place.row == 0) throw_damaged(path(), name);
    Statement remove(impl_->database, "DELETE FROM " + place.table + " WHERE rowid = ?");
    remove.bind(place.row);
    remove.run();
    if (names.empty() || names.back() != name) names.push_back(name);
    is_way_damaged = is_way_damaged || place.table == "intermediate";
  }
  if (is_way_damaged) {
    // It is computed again with all states on the way to it.
    impl_->database.execute(
        "DELETE FROM configuration AS c WHERE scene_id = 1 AND level = 0 AND outcome = 0 AND (i <> "
        "0 "
        "OR j <> 0 OR k <> 0) AND (SELECT count(*) FROM intermediate AS w WHERE w.scene_id = 1 AND "
        "w.tool_space_id = c.tool_space_id AND w.i = c.i AND w.j = c.j AND w.k = c.k) <> (SELECT "
        "intermediate_states FROM tool_space AS s WHERE s.scene_id = 1 AND s.tool_space_id = "
        "c.tool_space_id)");
  }
  transaction.commit();
  impl_->left_out.clear();
  impl_->bases.clear();
  impl_->known->bases.clear();
  return names;
}

Scene StateSpaceFile::read_scene() const {
  const Database& database = impl_->database;
  const bool has_checksum = impl_->has_checksums();
  const std::int64_t num_points = impl_->num_points;
  Scene scene;
  scene.mesh = impl_->read_mesh();
  const TetMesh& mesh = scene.mesh;
  Statement select(database, std::string("SELECT fixed, touchable, ") +
                                 (has_checksum ? "checksum" : "NULL") +
                                 " FROM scene WHERE scene_id = 1");
  select.step();
  take_array(select, blobs::marks(num_points), database, "fixed", scene.fixed);
  take_array(select, blobs::marks(num_points), database, "touchable", scene.touchable);
  if (has_checksum &&
      select.take_integer() != rows::checksum(scene.touchable, impl_->solver_tolerance)) {
    impl_->leave_out("where the body may be touched", "scene", 0);
    std::fill(scene.touchable.begin(), scene.touchable.end(), char{0});
  }
  impl_->read_materials(scene);
  if (has_body_force_schema(database)) impl_->read_body_force(scene);
  if (has_boundary_schema(database)) impl_->read_boundary(scene);
  if (hash(scene) != impl_->scene_hash) {
    throw_damaged(database.path(), "the scene has not the hash it was stored with");
  }
  // Who made the file may have made the hash fit a body that is none.
  if (!std::all_of(mesh.points.begin(), mesh.points.end(),
                   [](const Vec3& p) { return p.allFinite(); })) {
    throw_damaged(database.path(), "a point of the body is none");
  }
  return scene;
}

void StateSpaceFile::add_tool_space(const ToolSpaceSetup& setup) {
  if (!rows::is_possible(setup, impl_->num_points)) {
    throw InputError("Of " + setup.name() + " with " + describe(setup) +
                     " a number is out of its range, so that it cannot be stored.");
  }
  if (bytes_of_surface(setup) > kLargestRow - kOfNumbers) {
    throw InputError("The surface of the rigid tool has " +
                     std::to_string(setup.interaction.tool.points.size()) + " points and " +
                     std::to_string(setup.interaction.tool.triangles.size()) +
                     " triangles: more than a state-space file can hold. Take a coarser one.");
  }
  if (const std::optional<ToolSpace> there = find_tool_space(setup.id)) {
    require_extension(path(), there->setup, setup);
    if (!(there->setup == setup)) extend(setup);
    return;
  }
  std::int64_t num_corners = coarsest_corners(setup);
  for (const ToolSpace& space : read_tool_spaces()) num_corners += coarsest_corners(space.setup);
  if (num_corners > kMostCoarsestCorners) {
    throw InputError("The grids around all active nodes have " + std::to_string(num_corners) +
                     " check-points; a state space has " + std::to_string(kMostCoarsestCorners) +
                     " at most. Take fewer active nodes or a lower resolution.");
  }
  impl_->before_change();
  impl_->write(ToolSpace{setup, false, {}, {}});
}

void StateSpaceFile::extend(const ToolSpaceSetup& setup) {
  impl_->before_change();
  Transaction transaction(impl_->database);
  const ToolSpaceId id = setup.id;
  impl_->write(ToolSpace{setup, false, {}, {}});
  const auto marked = [&](Flags flags, const Vec3& force) {
    return setup.policy.is_beyond_limit(force) ? flags | flags::beyond_force_limit
                                               : flags & ~flags::beyond_force_limit;
  };
  for (Configuration& c : read_where(id, "true")) {
    const Flags flags = marked(c.flags, c.force);
    if (flags == c.flags) continue;
    c.flags = flags;
    impl_->rewrite(id, c.level, c);
  }
  for (IntermediateState& state : read_intermediate_states(id)) {
    const Flags flags = marked(state.flags, state.force);
    if (flags == state.flags) continue;
    state.flags = flags;
    impl_->write(id, state);
  }
  transaction.commit();
}

void StateSpaceFile::set_complete(ToolSpaceId tool_space, bool complete) {
  std::optional<ToolSpace> space = find_tool_space(tool_space);
  if (!space) return;
  space->complete = complete;
  impl_->before_change();
  impl_->write(*space);
}

std::vector<ToolSpace> StateSpaceFile::read_tool_spaces() const {
  Statement select(impl_->database, std::string("SELECT rowid, ") + rows::tool_space_columns +
                                        ", checksum FROM tool_space WHERE scene_id = 1 ORDER BY "
                                        "tool_space_id");
  std::vector<ToolSpace> tool_spaces;
  std::int64_t num_corners = 0;
  while (select.step()) {
    const std::int64_t row = select.take_integer();
    ToolSpace space;
    bool sound = true;
    rows::for_each_number_of_tool_space(space, rows::Take{select, sound});
    space.setup.interaction.tool.law.offset = impl_->contact_offset(space.setup.id);
    const std::int64_t stored = select.take_integer();
    if (impl_->has_checksums()) sound = stored == rows::checksum(space, impl_->checked()) && sound;
    if (!sound || !rows::is_possible(space.setup, impl_->num_points)) {
      impl_->leave_out(space.setup.name(), "tool_space", row);
      continue;
    }
    num_corners += coarsest_corners(space.setup);
    if (num_corners > kMostCoarsestCorners) {
      throw_damaged(path(), "its grids have more than " + std::to_string(kMostCoarsestCorners) +
                                " check-points");
    }
    tool_spaces.push_back(space);
  }
  return tool_spaces;
}

std::string StateSpaceFile::name_of(ToolSpaceId tool_space) const {
  const std::optional<ToolSpace> there = find_tool_space(tool_space);
  return there ? there->setup.name() : number_of(tool_space);
}

std::optional<ToolSpace> StateSpaceFile::find_tool_space(ToolSpaceId tool_space) const {
  for (const ToolSpace& space : read_tool_spaces()) {
    if (space.setup.id == tool_space) return space;
  }
  return std::nullopt;
}

void StateSpaceFile::add(ToolSpaceId tool_space, const Configuration& configuration,
                         const std::vector<IntermediateState>& way) {
  impl_->before_change();
  if (way.empty()) return add_alone(tool_space, configuration);
  Transaction transaction(impl_->database);
  for (const IntermediateState& state : way) impl_->write(tool_space, state);
  add_alone(tool_space, configuration);
  transaction.commit();
}

void StateSpaceFile::add_alone(ToolSpaceId tool_space, const Configuration& configuration) {
  // Of a rigid tool there are many; they are displayed and solved on from.
  rows::SingleFields single;
  const bool is_single = tool_space == kContactToolSpace;
  if (is_single) single = rows::single_fields_of(configuration);
  const rows::Fields fields = is_single ? rows::fields_of(single) : rows::fields_of(configuration);
  if (!impl_->fit(fields)) {
    throw InputError("Configuration " + describe(configuration.check_point) + " of " +
                     name_of(tool_space) + " has fields of another size than the body of " +
                     std::to_string(impl_->num_points) + " points.");
  }
  impl_->insert_configuration(tool_space, configuration, fields);
  if (impl_->database.changes() == 0) {
    throw InputError(quoted(path()) + " has no " + name_of(tool_space) + ". Add it first.");
  }
}

void StateSpaceFile::add(ToolSpaceId tool_space, const ConfigurationSummary& summary,
                         const ReducedFields& reduced) {
  impl_->before_change();
  impl_->insert_configuration(tool_space, summary, rows::fields_of(reduced));
}

std::vector<Configuration> StateSpaceFile::read_where(ToolSpaceId tool_space,
                                                      const std::string& condition) const {
  const std::optional<ToolSpace> space = find_tool_space(tool_space);
  std::vector<Configuration> configurations;
  if (!space) return configurations;
  impl_->for_each_row(
      "configuration", std::string(rows::summary_columns) + ", checksum, summary_checksum",
      {"i", "j", "k", "level"}, tool_space, condition,
      [&](Statement& select, std::int64_t row) {
        Configuration& c = configurations.emplace_back();
        bool sound = true;
        rows::for_each_number_of_summary(c, rows::Take{select, sound});
        const std::int64_t of_fields = select.take_integer();
        const std::int64_t stored = select.take_integer();
        if (sound && stored == rows::checksum(tool_space, c, of_fields, impl_->checked()) &&
            rows::is_possible(space->setup.grid, c)) {
          return;
        }
        impl_->leave_out(describe(c, space->setup.name()), "configuration", row);
        configurations.pop_back();
      },
      [&] { configurations.clear(); });
  return configurations;
}

std::vector<Configuration> StateSpaceFile::read_summaries(ToolSpaceId tool_space) const {
  std::vector<Configuration> configurations = read_where(tool_space, "level >= 0");
  for (const LevelTransition& transition : read_linked_transitions(tool_space, configurations)) {
    Configuration key;
    key.check_point = transition.start;
    key.level = transition.start_level;
    std::lower_bound(configurations.begin(), configurations.end(), key)
        ->reached[neighbour_number(transition.start, transition.target)] = transition.reached;
  }
  return configurations;
}

std::vector<Configuration> StateSpaceFile::read_candidates(ToolSpaceId tool_space) const {
  return read_where(tool_space, "level < 0");
}

void StateSpaceFile::settle(ToolSpaceId tool_space, const ConfigurationSummary& candidate,
                            std::int32_t level) {
  impl_->before_change();
  if (level < 0) {
    Statement remove(impl_->database, std::string("DELETE FROM configuration") + kAtKey);
    remove.bind(tool_space);
    for (std::int32_t x : candidate.check_point) remove.bind(std::int64_t{x});
    remove.bind(std::int64_t{candidate.level});
    return remove.run();
  }
  ConfigurationSummary settled = candidate;
  settled.level = level;
  impl_->rewrite(tool_space, candidate.level, settled);
}

void StateSpaceFile::add(ToolSpaceId tool_space, const LevelTransition& transition) {
  impl_->before_change();
  add_alone(tool_space, transition, "REPLACE");
}

void StateSpaceFile::add(ToolSpaceId tool_space, const IntermediateState& state) {
  impl_->before_change();
  impl_->write(tool_space, state);
}

void StateSpaceFile::add_alone(ToolSpaceId tool_space, const LevelTransition& transition,
                               const std::string& where_there_is_one) {
  Statement insert(impl_->database, "INSERT OR " + where_there_is_one +
                                        " INTO transition (scene_id, tool_space_id, " +
                                        rows::transition_columns +
                                        ", checksum) VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(tool_space);
  rows::for_each_number_of_transition(transition, rows::Bind{insert});
  insert.bind(rows::checksum(tool_space, transition));
  insert.run();
}

std::vector<LevelTransition> StateSpaceFile::read_transitions(ToolSpaceId tool_space) const {
  const std::optional<ToolSpace> space = find_tool_space(tool_space);
  std::vector<LevelTransition> transitions;
  if (!space) return transitions;
  impl_->for_each_row(
      "transition", std::string(rows::transition_columns) + ", checksum",
      {"i", "j", "k", "level", "to_i", "to_j", "to_k"}, tool_space, "true",
      [&](Statement& select, std::int64_t row) {
        LevelTransition& transition = transitions.emplace_back();
        bool sound = true;
        rows::for_each_number_of_transition(transition, rows::Take{select, sound});
        if (sound && select.take_integer() == rows::checksum(tool_space, transition) &&
            rows::is_possible(space->setup.grid, transition)) {
          return;
        }
        impl_->leave_out(rows::describe(transition, space->setup.name()), "transition", row);
        transitions.pop_back();
      },
      [&] { transitions.clear(); });
  return transitions;
}

std::vector<LevelTransition> StateSpaceFile::read_linked_transitions(
    ToolSpaceId tool_space, const std::vector<Configuration>& configurations) const {
  const auto is_there = [&](const CheckPoint& check_point, std::int32_t level) {
    Configuration key;
    key.check_point = check_point;
    key.level = level;
    return std::binary_search(configurations.begin(), configurations.end(), key);
  };
  std::vector<LevelTransition> transitions = read_transitions(tool_space);
  const auto loose = [&](const LevelTransition& t) {
    return !is_there(t.start, t.start_level) || (t.reached >= 0 && !is_there(t.target, t.reached));
  };
  transitions.erase(std::remove_if(transitions.begin(), transitions.end(), loose),
                    transitions.end());
  return transitions;
}

std::vector<IntermediateState> StateSpaceFile::read_intermediate_states(
    ToolSpaceId tool_space) const {
  const std::optional<ToolSpace> space = find_tool_space(tool_space);
  std::vector<IntermediateState> states;
  if (!space) return states;
  impl_->for_each_row(
      "intermediate", std::string(rows::intermediate_columns) + ", checksum",
      {"i", "j", "k", "number"}, tool_space, "true",
      [&](Statement& select, std::int64_t row) {
        IntermediateState& state = states.emplace_back();
        bool sound = true;
        rows::for_each_number_of_intermediate(state, rows::Take{select, sound});
        if (sound && select.take_integer() == rows::checksum(tool_space, state, impl_->checked()) &&
            rows::is_possible(space->setup.grid, state)) {
          return;
        }
        impl_->leave_out(rows::describe(state, space->setup.name()), "intermediate", row);
        states.pop_back();
      },
      [&] { states.clear(); });
  return states;
}

std::vector<StateSpaceFile::BasisBox> StateSpaceFile::list_bases(ToolSpaceId tool_space) const {
  std::vector<BasisBox> boxes;
  for (const Impl::StoredBasis& stored : impl_->bases_of(tool_space)) {
    const BasisHead& basis = stored.row.basis;
    const double error =
        basis.largest_displacement > 0 ? basis.displacement_error / basis.largest_displacement : 0;
    boxes.push_back({stored.row.number, basis.box, basis.keep, error});
  }
  return boxes;
}

std::shared_ptr<const FieldBasis> StateSpaceFile::read_basis(ToolSpaceId tool_space,
                                                             std::int64_t number) const {
  for (Impl::StoredBasis& stored : impl_->bases_of(tool_space)) {
    if (stored.row.number == number) return impl_->basis_of(tool_space, stored);
  }
  return nullptr;
}

void StateSpaceFile::forget_bases() const {
  impl_->bases.clear();
  impl_->own_known.bases.clear();
}

void StateSpaceFile::share(Known& known) { impl_->known = &known; }

Keep StateSpaceFile::keep_of(ToolSpaceId tool_space, const ConfigurationSummary& summary) const {
  const std::vector<Impl::StoredBasis>& bases = impl_->bases_of(tool_space);
  const auto serving =
      std::find_if(bases.begin(), bases.end(), [&](const Impl::StoredBasis& stored) {
        return stored.row.basis.box.contains(summary.check_point);
      });
  if (serving == bases.end()) return Keep::all;
  Statement select(impl_->database, std::string("SELECT length(u) FROM configuration") + kAtKey);
  select.bind(tool_space);
  for (std::int32_t x : summary.check_point) select.bind(std::int64_t{x});
  select.bind(std::int64_t{summary.level});
  const bool is_whole = !select.step() || select.take_integer() >= impl_->bytes_of_whole();
  return is_whole ? Keep::all : serving->row.basis.keep;
}

std::vector<StateKey> StateSpaceFile::list_whole(ToolSpaceId tool_space) const {
  Statement select(
      impl_->database,
      "SELECT i, j, k, level FROM configuration WHERE scene_id = 1 AND tool_space_id = "
      "? AND level >= 0 AND outcome = 0 AND length(u) >= ? ORDER BY i, j, k, level");
  select.bind(tool_space);
  select.bind(impl_->bytes_of_whole());
  std::vector<StateKey> keys;
  while (select.step()) {
    StateKey& key = keys.emplace_back();
    key.tool_space = tool_space;
    for (auto& x : key.check_point) x = static_cast<std::int32_t>(select.take_integer());
    key.level = static_cast<std::int32_t>(select.take_integer());
  }
  return keys;
}

Keep StateSpaceFile::keep() const {
  if (impl_->version < 9) return Keep::all;
  const std::int64_t number = impl_->database.integer("SELECT count(*) FROM basis");
  if (number == 0) return Keep::all;
  return impl_->database.integer("SELECT min(keep) FROM basis") == 0 ? Keep::touch : Keep::surface;
}

void StateSpaceFile::add_basis(ToolSpaceId tool_space, std::int64_t number,
                               const PackedBasis& basis) {
  impl_->before_change();
  impl_->make_room_for(basis);
  const std::array<Statement::Blob, 2> modes = rows::modes_of(basis);
  const rows::BasisRow row{number, basis, rows::checksum(modes)};
  Statement insert(impl_->database,
                   std::string("INSERT OR REPLACE INTO basis (scene_id, tool_space_id, ") +
                       rows::basis_columns + ", checksum, " + rows::mode_columns +
                       ") VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(tool_space);
  rows::for_each_number_of_basis(row, rows::Bind{insert});
  insert.bind(rows::checksum(tool_space, row));
  for (const Statement::Blob& blob : modes) insert.bind(blob.data, blob.bytes);
  insert.run();
  impl_->bases.erase(tool_space);
}

void StateSpaceFile::shrink() {
  const auto of_pragma = [&](const char* name) {
    return static_cast<double>(impl_->database.integer(std::string("PRAGMA ") + name));
  };
  if (of_pragma("freelist_count") < kFreeShare * of_pragma("page_count")) return;
  // Every row is written anew.
  if (has_reduced_schema(impl_->database)) {
    impl_->make_room_for_bytes(
        impl_->database.integer("SELECT max(length(numbers)) FROM reduced_array"));
  }
  impl_->database.vacuum();
}

void StateSpaceFile::change_together(const std::function<void()>& body) {
  impl_->before_change();
  {
    Transaction transaction(impl_->database);
    body();
    transaction.commit();
  }
  checkpoint(impl_->database);
}

bool StateSpaceFile::read_fields(ToolSpaceId tool_space, Configuration& configuration) const {
  StoredFields stored;
  if (!read_stored(tool_space, configuration, stored)) return false;
  if (stored.basis != nullptr) {
    expand(*stored.basis, stored.reduced, impl_->points_of(stored.basis->keep),
           static_cast<Index>(impl_->num_points), configuration);
    count_from_mesh(impl_->settled(), configuration);
    return true;
  }
  configuration.u = std::move(stored.whole.u);
  configuration.v = std::move(stored.whole.v);
  configuration.p = std::move(stored.whole.p);
  configuration.p_v = std::move(stored.whole.p_v);
  return true;
}

bool StateSpaceFile::read_stored(ToolSpaceId tool_space, const ConfigurationSummary& configuration,
                                 StoredFields& stored) const {
  const auto which = [&] { return describe(configuration, name_of(tool_space)); };
  std::shared_ptr<const FieldBasis> basis;
  for (Impl::StoredBasis& of_space : impl_->bases_of(tool_space)) {
    if (of_space.row.basis.box.contains(configuration.check_point)) {
      basis = impl_->basis_of(tool_space, of_space);
    }
  }
  bool is_there = true;
  std::int64_t row = 0;
  try {
    if (!impl_->select_fields) {
      impl_->select_fields.emplace(impl_->database,
                                   std::string("SELECT rowid, ") + rows::summary_columns +
                                       ", summary_checksum, checksum, " + rows::field_columns +
                                       " FROM configuration" + kAtKey);
    }
    Statement& select = *impl_->select_fields;
    const Reset reset{select};
    select.bind(tool_space);
    for (std::int32_t x : configuration.check_point) select.bind(std::int64_t{x});
    select.bind(std::int64_t{configuration.level});
    is_there = select.step();
    if (!is_there) throw InputError(quoted(path()) + " holds no " + which() + '.');
    row = select.take_integer();
    bool sound = true;
    ConfigurationSummary summary;
    rows::for_each_number_of_summary(summary, rows::Take{select, sound});
    const std::int64_t of_summary = select.take_integer();
    const std::int64_t of_fields = select.take_integer();
    rows::Fields fields;
    for (Statement::Blob& field : fields) field = select.take_blob();
    if (sound && rows::checksum(fields) == of_fields &&
        rows::checksum(tool_space, summary, of_fields, impl_->checked()) == of_summary) {
      const bool has_fields = fields[0].bytes > 0;
      if (has_fields && basis != nullptr && rows::fit_basis(fields, *basis, impl_->num_points)) {
        stored.basis = std::move(basis);
        stored.reduced = rows::reduced_of(fields);
        if (rows::is_finite(stored.reduced)) return true;
      } else if (impl_->fit(fields)) {
        rows::set_fields(fields, impl_->num_points, stored.whole);
        if (rows::is_finite(stored.whole)) return true;
      }
    }
  } catch (const InputError&) {
    // Else it cannot be read, or is larger than the fields of this body.
    if (!is_there) throw;
  }
  impl_->leave_out(which(), "configuration", row);
  return false;
}

StateSpace StateSpaceFile::read(bool with_fields) const {
  StateSpace space;
  space.scene = read_scene();
  space.scene_hash = impl_->scene_hash;
  space.solver_tolerance = impl_->solver_tolerance;
  space.tool_spaces = read_tool_spaces();
  for (ToolSpace& tool_space : space.tool_spaces) {
    const ToolSpaceId id = tool_space.setup.id;
    for (Configuration& configuration : read_summaries(id)) {
      if (with_fields && !read_fields(id, configuration)) continue;
      tool_space.configurations.push_back(std::move(configuration));
    }
    tool_space.intermediate_states = read_intermediate_states(id);
  }
  return space;
}

void StateSpaceFile::add(const TestSet& set, const TestPoint& point) {
  impl_->before_change();
  add_alone(set, point);
}

void StateSpaceFile::add_alone(const TestSet& set, const TestPoint& point) {
  std::string parameters = "1, ?, ?, ?, ?";
  for (int c = 0; c < rows::num_test_point_columns + 2; ++c) parameters += ", ?";
  Statement insert(impl_->database,
                   std::string("INSERT OR IGNORE INTO test_point (scene_id, tool_space_id, "
                               "tip_radius, half_width, seed, ") +
                       rows::test_point_columns + ", checksum, displacement) VALUES (" +
                       parameters + ')');
  insert.bind(set.tool_space);
  insert.bind(set.tip_radius);
  insert.bind(set.half_width);
  insert.bind(set.seed);
  for_each_number_of_test_point(point, rows::Bind{insert});
  insert.bind(rows::checksum(set, point));
  const auto size = static_cast<std::size_t>(point.displacement.size()) * sizeof(float);
  insert.bind(size == 0 ? nullptr : point.displacement.data(), size);
  insert.run();
}

std::vector<TestPoint> StateSpaceFile::read_test_points(const TestSet& set) const {
  Statement select(
      impl_->database,
      std::string("SELECT rowid, ") + rows::test_point_columns +
          ", checksum, displacement FROM test_point WHERE scene_id = 1 AND tool_space_id "
          "= ? AND tip_radius = ? AND half_width = ? AND seed = ? ORDER BY kind, number");
  select.bind(set.tool_space);
  select.bind(set.tip_radius);
  select.bind(set.half_width);
  select.bind(set.seed);
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
    impl_->leave_out(rows::describe(point, name_of(set.tool_space)), "test_point", row);
    points.pop_back();
  }
  return points;
}

void StateSpaceFile::add_array(const std::string& key, const std::string& name,
                               std::int64_t num_arrays, const Eigen::MatrixXd& array) {
  const auto bytes = static_cast<std::int64_t>(array.size()) * std::int64_t{sizeof(double)};
  if (bytes > kLargestRow - kOfNumbers) {
    throw InputError("The array " + name + " of the reduced model has " + std::to_string(bytes) +
                     " bytes, and " + quoted(path()) + " holds " +
                     std::to_string(kLargestRow - kOfNumbers) +
                     " at the most. Take fewer modes, or a coarser mesh.");
  }
  impl_->make_room_for_bytes(bytes);
  const rows::ReducedArrayRow row{key, name, num_arrays, array.rows(), array.cols()};
  const Statement::Blob numbers{array.data(), static_cast<std::size_t>(bytes)};
  Statement insert(impl_->database,
                   std::string("INSERT OR REPLACE INTO reduced_array (scene_id, ") +
                       rows::reduced_array_columns +
                       ", checksum, numbers) VALUES (1, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(row.model);
  insert.bind(row.name);
  for (const std::int64_t x : {row.num_arrays, row.num_rows, row.num_columns}) insert.bind(x);
  insert.bind(rows::checksum(row, numbers));
  // An address also where there are no numbers: it is no NULL.
  insert.bind(bytes > 0 ? numbers.data : &bytes, numbers.bytes);
  insert.run();
}

void StateSpaceFile::add_reduced_model(const std::string& key, const Arrays& arrays) {
  change_together([&] {
    make_reduced_schema(impl_->database);
    Statement remove(impl_->database, "DELETE FROM reduced_array WHERE scene_id = 1 AND model = ?");
    remove.bind(key);
    remove.run();
    const auto num_arrays = static_cast<std::int64_t>(arrays.size());
    for (const auto& [name, array] : arrays) add_array(key, name, num_arrays, array);
  });
}

void StateSpaceFile::add_training(const std::string& key, const std::string& name,
                                  const Eigen::MatrixXd& array) {
  impl_->before_change();
  Transaction transaction(impl_->database);
  make_reduced_schema(impl_->database);
  add_array(key, name, 0, array);
  transaction.commit();
}

std::vector<std::string> StateSpaceFile::list_reduced_models() const {
  std::vector<std::string> keys;
  if (!has_reduced_schema(impl_->database)) return keys;
  Statement select(impl_->database,
                   "SELECT model FROM reduced_array WHERE scene_id = 1 AND num_arrays > 0 GROUP BY "
                   "model HAVING count(*) = max(num_arrays) ORDER BY max(rowid)");
  while (select.step()) keys.push_back(select.take_text());
  return keys;
}

std::optional<StateSpaceFile::Arrays> StateSpaceFile::read_reduced_model(
    const std::string& key) const {
  const std::vector<std::string> keys = list_reduced_models();
  if (std::find(keys.begin(), keys.end(), key) == keys.end()) return std::nullopt;
  const std::size_t left_out_before = impl_->left_out.size();
  Arrays arrays = read_arrays(key, false);
  if (impl_->left_out.size() != left_out_before || arrays.empty()) return std::nullopt;
  return arrays;
}

StateSpaceFile::Arrays StateSpaceFile::read_training(const std::string& key) const {
  return read_arrays(key, true);
}

StateSpaceFile::Arrays StateSpaceFile::read_arrays(const std::string& key, bool of_training) const {
  Arrays arrays;
  if (!has_reduced_schema(impl_->database)) return arrays;
  // Their sizes first: a row that claims more than its numbers take is not read.
  std::vector<std::pair<std::int64_t, rows::ReducedArrayRow>> heads;
  {
    Statement select(impl_->database,
                     std::string("SELECT rowid, ") + rows::reduced_array_columns +
                         ", length(numbers) FROM reduced_array WHERE scene_id = 1 AND model = ? "
                         "ORDER BY name");
    select.bind(key);
    while (select.step()) {
      const std::int64_t row_id = select.take_integer();
      rows::ReducedArrayRow row;
      row.model = select.take_text();
      row.name = select.take_text();
      for (std::int64_t* x : {&row.num_arrays, &row.num_rows, &row.num_columns}) {
        *x = select.take_integer();
      }
      const std::int64_t bytes = select.take_integer();
      const bool is_of_training = row.num_arrays == 0;
      if (is_of_training != of_training) continue;
      if (row.num_arrays < 0 || !rows::is_possible(row, bytes)) {
        impl_->leave_out(rows::describe(row), "reduced_array", row_id);
        continue;
      }
      impl_->make_room_for_bytes(bytes);
      heads.emplace_back(row_id, row);
    }
  }
  for (const auto& [row_id, row] : heads) {
    try {
      Statement select(impl_->database,
                       "SELECT checksum, numbers FROM reduced_array WHERE rowid = ?");
      select.bind(row_id);
      if (select.step()) {
        const std::int64_t stored = select.take_integer();
        const Statement::Blob numbers = select.take_blob();
        const blobs::Size<double> size = blobs::array(row.num_rows, row.num_columns);
        if (size.fits(numbers.bytes) && stored == rows::checksum(row, numbers)) {
          Eigen::MatrixXd array(row.num_rows, row.num_columns);
          if (blobs::copy(numbers, size, array)) {
            arrays[row.name] = std::move(array);
            continue;
          }
        }
      }
    } catch (const InputError&) {
      // It cannot be read.
    }
    impl_->leave_out(rows::describe(row), "reduced_array", row_id);
  }
  return arrays;
}

std::vector<TestSet> StateSpaceFile::read_test_sets() const {
  Statement select(
      impl_->database,
      "SELECT DISTINCT tool_space_id, tip_radius, half_width, seed FROM test_point WHERE "
      "scene_id = 1");
  std::vector<TestSet> sets;
  while (select.step()) {
    TestSet& set = sets.emplace_back();
    set.tool_space = select.take_integer();
    set.tip_radius = select.take_double();
    set.half_width = select.take_double();
    set.seed = select.take_integer();
  }
  return sets;
}

bool StateSpaceFile::is_of_use(ToolSpaceId tool_space, const ConfigurationSummary& other) const {
  if (!impl_->select_outcome) {
    impl_->select_outcome.emplace(impl_->database,
                                  std::string("SELECT outcome FROM configuration") + kAtKey);
  }
  Statement& select = *impl_->select_outcome;
  const Reset reset{select};
  select.bind(tool_space);
  for (std::int32_t x : other.check_point) select.bind(std::int64_t{x});
  select.bind(std::int64_t{other.level});
  if (!select.step()) return true;
  return static_cast<Outcome>(select.take_integer()) != Outcome::converged && other.usable();
}

std::vector<std::string> StateSpaceFile::merge(const fs::path& other_path) {
  const StateSpaceFile other = open_read_only(other_path);
  if (other.scene_hash() != scene_hash() || other.solver_tolerance() != solver_tolerance()) {
    throw InputError(quoted(other_path) + " cannot be merged into " + quoted(path()) +
                     ": its scene has the hash " + other.scene_hash() + " and the tolerance " +
                     number(other.solver_tolerance()) + ", here they are " + scene_hash() +
                     " and " + number(solver_tolerance()) + ". Leave it out.");
  }
  if (other.keep() != Keep::all) {
    throw InputError(quoted(other_path) + " cannot be merged into " + quoted(path()) +
                     ": it is a finished space, whose fields are reduced. Leave it out.");
  }
  const std::vector<ToolSpace> tool_spaces = other.read_tool_spaces();
  for (const ToolSpace& space : tool_spaces) {
    if (const std::optional<ToolSpace> here = find_tool_space(space.setup.id)) {
      require_extension(other_path, space.setup, here->setup);
    } else {
      add_tool_space(space.setup);
    }
  }
  for (const ToolSpace& space : tool_spaces) {
    const ToolSpaceId id = space.setup.id;
    Transaction transaction(impl_->database);
    std::set<CheckPoint> taken;
    for (Configuration& c : other.read_where(id, "true")) {
      // What is of no use here need not be sound there.
      if (!is_of_use(id, c) || !other.read_fields(id, c)) continue;
      add_alone(id, c);
      if (c.level == 0) taken.insert(c.check_point);
    }
    for (const LevelTransition& transition : other.read_transitions(id)) {
      add_alone(id, transition, "IGNORE");
    }
    for (const IntermediateState& state : other.read_intermediate_states(id)) {
      if (taken.count(state.target) > 0) impl_->write(id, state);
    }
    transaction.commit();
  }
  {
    Transaction transaction(impl_->database);
    for (const TestSet& set : other.read_test_sets()) {
      for (const TestPoint& point : other.read_test_points(set)) add_alone(set, point);
    }
    transaction.commit();
  }
  checkpoint(impl_->database);
  return other.left_out();
}

std::string describe_left_out(const fs::path& path, const std::vector<std::string>& left_out) {
  constexpr std::size_t kNamed = 5;
  std::string names;
  for (std::size_t i = 0; i < std::min(kNamed, left_out.size()); ++i) {
    names += (i > 0 ? ", " : "") + left_out[i];
  }
  if (left_out.size() > kNamed)
    names += " and " + std::to_string(left_out.size() - kNamed) + " more";
  return (left_out.size() == 1 ? "A part of " : std::to_string(left_out.size()) + " parts of ") +
         quoted(path) + (left_out.size() == 1 ? " is" : " are") + " damaged: " + names + '.';
}

}  // namespace palpate
