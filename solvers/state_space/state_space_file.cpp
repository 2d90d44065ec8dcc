// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/state_space_file.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <system_error>
#include <type_traits>

#include "base/error.h"
#include "state_space/folder.h"
#include "state_space/schema.sql.h"
#include "state_space/sqlite.h"

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

constexpr std::int64_t kApplicationId = 0x50616c70;

/// Large pages suit large blobs: a configuration of 160 kB is 10 pages.
constexpr int kPageSize = 16384;

std::string quoted(const fs::path& path) { return '\'' + path.string() + '\''; }

/// The shortest text that reads back as the same number.
std::string number(double value) {
  for (int digits = 6;; ++digits) {
    std::ostringstream text;
    text.precision(digits);
    text << value;
    if (digits == 17 || std::strtod(text.str().c_str(), nullptr) == value) return text.str();
  }
}

/// The first bytes of the file, as SQLite's file format defines them.
struct FileHeader {
  explicit FileHeader(const fs::path& path) {
    std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(bytes.data()), bytes.size());
  }
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
                   "whole, or remove the file and compute it again.");
}

void check_is_there(const fs::path& path) {
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
    throw InputError(quoted(path) + " is empty, not a state space. Remove it, or give another " +
                     "file name.");
  }
  // SQLite would take the missing end of the last page as zeros.
  const FileHeader header(path);
  if (header.is_sqlite() && !has_log(path) && header.file_size() > fs::file_size(path)) {
    throw_damaged(path, "its end is missing");
  }
}

void check_identity(const Database& database) {
  if (database.integer("PRAGMA application_id") != kApplicationId) {
    throw InputError(quoted(database.path()) + " is an SQLite file of another program, not a " +
                     "Palpate state space. Give another file name.");
  }
  const std::int64_t version = database.integer("PRAGMA user_version");
  if (version != StateSpaceFile::schema_version) {
    const bool newer = version > StateSpaceFile::schema_version;
    throw InputError(quoted(database.path()) + " has version " + std::to_string(version) +
                     " of the schema; this program knows version " +
                     std::to_string(StateSpaceFile::schema_version) + ". " +
                     (newer ? "Use a newer Palpate." : "Compute the state space again."));
  }
}

/// Opens with the file locked for this program alone: then the log needs no shared memory, and
/// works on network disks.
Database open_exclusively(const fs::path& path) {
  Database database(path, Access::read_write);
  database.execute("PRAGMA locking_mode = EXCLUSIVE");
  check_identity(database);
  return database;
}

[[noreturn]] void throw_log_stays(const fs::path& path) {
  throw BackendError("The log of " + quoted(path) + " cannot be put into the file. Nothing is lost: " +
                     "open it again when no other program uses it.");
}

/// Closes a file that was opened exclusively: afterwards it has no log beside it, and is durable.
void close_as_single_file(Database database) {
  const fs::path path = database.path();
  {
    const Database closed = std::move(database);
    if (closed.text("PRAGMA journal_mode = DELETE") != "delete") throw_log_stays(path);
  }
  sync_folder_of(path);
}

/// Puts the log into the file and waits for the disk: what was stored so far is durable.
void checkpoint(const Database& database) {
  if (database.integer("PRAGMA wal_checkpoint(TRUNCATE)") != 0) throw_log_stays(database.path());
}

Database open_to_read(const fs::path& path) {
  check_is_there(path);
  if (!has_log(path) && !FileHeader(path).has_write_ahead_log()) {
    Database database(path, Access::read_only);
    check_identity(database);
    return database;
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
    check_identity(database);
    return database;
  }
  return {path, Access::read_only};
}

template <class T>
void bind_array(Statement& statement, const std::vector<T>& values) {
  statement.bind(values.empty() ? nullptr : static_cast<const void*>(values.data()),
                 values.size() * sizeof(T));
}

template <class T>
std::vector<T> take_array(Statement& statement, std::int64_t size, const Database& database,
                          const char* what) {
  const Statement::Blob blob = statement.take_blob();
  if (size < 0 || blob.bytes != static_cast<std::size_t>(size) * sizeof(T)) {
    throw_damaged(database.path(), std::string(what) + " has another size than the body");
  }
  std::vector<T> values(static_cast<std::size_t>(size));
  if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), blob.data, blob.bytes);
  return values;
}

/// Calls visit for each number of a summary, in the order of the columns.
template <class Summary, class Visit>
void for_each_number(Summary& c, Visit&& visit) {
  for (auto& x : c.check_point) visit(x);
  visit(c.level);
  for (auto& x : c.parent) visit(x);
  visit(c.parent_level);
  for (int a = 0; a < 3; ++a) visit(c.t[a]);
  visit(c.energy);
  for (int a = 0; a < 3; ++a) visit(c.force[a]);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) visit(c.stiffness(a, b));
  }
  visit(c.outcome);
  visit(c.flags);
  visit(c.residual);
  visit(c.minimum_det_f);
  visit(c.negative_pivots);
  visit(c.iterations);
  visit(c.seconds);
  for (int a = 0; a < 3; ++a) visit(c.signature[a]);
  visit(c.third_derivative);
}

constexpr char kSummaryColumns[] =
    "i, j, k, level, parent_i, parent_j, parent_k, parent_level, t_x, t_y, t_z, energy, force_x, force_y, "
    "force_z, stiffness_xx, stiffness_xy, stiffness_xz, stiffness_yx, stiffness_yy, stiffness_yz, "
    "stiffness_zx, stiffness_zy, stiffness_zz, outcome, flags, residual, minimum_det_f, "
    "negative_pivots, iterations, seconds, signature_x, signature_y, signature_z, third_derivative";
constexpr int kNumSummaryColumns = 35;
constexpr char kFieldColumns[] = "u, v, p, p_v";

constexpr char kAtKey[] =
    " WHERE scene_id = 1 AND active_node = ? AND i = ? AND j = ? AND k = ? AND level = ?";

struct BindNumber {
  Statement& statement;
  void operator()(double x) const { statement.bind(x); }
  void operator()(std::int32_t x) const { statement.bind(std::int64_t{x}); }
  template <class Enumeration>
  void operator()(Enumeration x) const {
    statement.bind(static_cast<std::int64_t>(x));
  }
  void operator()(const ThirdDerivative& x) const {
    statement.bind(x.allFinite() ? x.data() : nullptr, sizeof x);
  }
};

struct TakeNumber {
  Statement& statement;
  const fs::path& path;
  void operator()(double& x) const { x = statement.take_double(); }
  void operator()(std::int32_t& x) const {
    x = static_cast<std::int32_t>(statement.take_integer());
  }
  template <class Enumeration>
  void operator()(Enumeration& x) const {
    x = static_cast<Enumeration>(statement.take_integer());
  }
  void operator()(ThirdDerivative& x) const {
    const auto [data, bytes] = statement.take_blob();
    x.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (bytes == 0) return;
    if (bytes != sizeof x) throw_damaged(path, "a third derivative has another size");
    std::memcpy(static_cast<void*>(x.data()), data, bytes);
  }
};

/// The fields of a configuration, u, v, p and p_v, as they lie in memory or in the file.
using Fields = std::array<Statement::Blob, 4>;

Fields blobs_of(const Configuration& c) {
  const auto blob = [](const auto& field) {
    const auto size = static_cast<std::size_t>(field.size());
    return Statement::Blob{size == 0 ? nullptr : field.data(), size * sizeof(double)};
  };
  return {blob(c.u), blob(c.v), blob(c.p), blob(c.p_v)};
}

std::int64_t checksum(const Fields& fields) {
  XXH64_hash_t sum = 0;
  for (const auto& [data, bytes] : fields) sum = XXH3_64bits_withSeed(data, bytes, sum);
  return static_cast<std::int64_t>(sum);
}

/// Gathers the bytes of a summary but for the flag of the force limit, which changes with the limit.
struct GatherNumber {
  std::vector<std::int64_t>& bits;
  void operator()(double x) const {
    std::int64_t of_x = -1;  // any NaN: the file has only one
    if (!std::isnan(x)) std::memcpy(&of_x, &x, sizeof of_x);
    bits.push_back(of_x);
  }
  void operator()(std::int32_t x) const { bits.push_back(x); }
  template <class Enumeration>
  void operator()(Enumeration x) const {
    bits.push_back(static_cast<std::int64_t>(x));
  }
  void operator()(const ThirdDerivative& x) const {
    if (!x.allFinite()) return;
    for (const double component : x) (*this)(component);
  }
};

std::int64_t checksum(const std::vector<std::int64_t>& bits) {
  return static_cast<std::int64_t>(XXH3_64bits(bits.data(), bits.size() * sizeof bits[0]));
}

std::int64_t checksum(Index active_node, ConfigurationSummary summary) {
  summary.flags &= ~flags::beyond_force_limit;
  std::vector<std::int64_t> bits{active_node};
  for_each_number(summary, GatherNumber{bits});
  return checksum(bits);
}

/// Calls visit for each number of a transition, in the order of the columns.
template <class Transition, class Visit>
void for_each_number_of_transition(Transition& transition, Visit&& visit) {
  for (auto& x : transition.start) visit(x);
  visit(transition.start_level);
  for (auto& x : transition.target) visit(x);
  visit(transition.reached);
}

constexpr char kTransitionColumns[] = "i, j, k, level, to_i, to_j, to_k, reached";

std::int64_t checksum(Index active_node, const LevelTransition& transition) {
  std::vector<std::int64_t> bits{active_node};
  for_each_number_of_transition(transition, GatherNumber{bits});
  return checksum(bits);
}

/// Calls visit for each number of an intermediate state, in the order of the columns.
template <class State, class Visit>
void for_each_number_of_intermediate(State& state, Visit&& visit) {
  for (auto& x : state.target) visit(x);
  visit(state.number);
  for (int a = 0; a < 3; ++a) visit(state.t[a]);
  visit(state.energy);
  for (int a = 0; a < 3; ++a) visit(state.force[a]);
  visit(state.outcome);
  visit(state.flags);
  visit(state.seconds);
}

constexpr char kIntermediateColumns[] =
    "i, j, k, number, t_x, t_y, t_z, energy, force_x, force_y, force_z, outcome, flags, seconds";

std::int64_t checksum(Index active_node, IntermediateState state) {
  state.flags &= ~flags::beyond_force_limit;
  std::vector<std::int64_t> bits{active_node};
  for_each_number_of_intermediate(state, GatherNumber{bits});
  return checksum(bits);
}

constexpr char kTestPointColumns[] =
    "kind, number, t_x, t_y, t_z, energy, force_x, force_y, force_z, stiffness_xx, stiffness_xy, "
    "stiffness_xz, stiffness_yx, stiffness_yy, stiffness_yz, stiffness_zx, stiffness_zy, "
    "stiffness_zz, outcome, flags, seconds";
constexpr int kNumTestPointColumns = 21;

std::int64_t checksum(const TestSet& set, const TestPoint& point) {
  std::vector<std::int64_t> bits{set.active_node, set.seed};
  GatherNumber{bits}(set.tip_radius);
  GatherNumber{bits}(set.half_width);
  for_each_number_of_test_point(point, GatherNumber{bits});
  const auto size = static_cast<std::size_t>(point.displacement.size()) * sizeof(float);
  return static_cast<std::int64_t>(XXH3_64bits_withSeed(
      point.displacement.data(), size, static_cast<XXH64_hash_t>(checksum(bits))));
}

/// Whether they are those of a body with so many points; p may have any length.
bool fit(const Fields& fields, std::int64_t num_points) {
  const auto& [u, v, p, p_v] = fields;
  const std::size_t of_points = static_cast<std::size_t>(num_points) * 3 * sizeof(double);
  return (u.bytes == 0 || u.bytes == of_points) && (v.bytes == 0 || v.bytes == 3 * of_points) &&
         p.bytes % sizeof(double) == 0 && p_v.bytes == 3 * p.bytes;
}

std::string describe(const CheckPoint& c) {
  return '(' + std::to_string(c[0]) + ", " + std::to_string(c[1]) + ", " + std::to_string(c[2]) +
         ')';
}

constexpr char kSiteColumns[] =
    "active_node, tip_radius, half_width, resolution, force_limit, coarsest, tolerance, "
    "tolerance_is_relative, history, intermediate_states, third_derivatives, complete";

SiteSpace take_site(Statement& select) {
  SiteSpace space;
  space.site.active_node = static_cast<Index>(select.take_integer());
  space.site.tip_radius = select.take_double();
  space.site.half_width = select.take_double();
  space.site.resolution = static_cast<std::int32_t>(select.take_integer());
  space.site.force_limit = select.take_double();
  space.site.coarsest = static_cast<std::int32_t>(select.take_integer());
  space.site.tolerance = select.take_double();
  space.site.tolerance_is_relative = select.take_integer() != 0;
  space.site.history = static_cast<History>(select.take_integer());
  space.site.intermediate_states = static_cast<std::int32_t>(select.take_integer());
  space.site.third_derivatives = select.take_integer() != 0;
  space.complete = select.take_integer() != 0;
  return space;
}

std::string describe(const Site& s) {
  return "tip radius " + number(s.tip_radius) + " m, half-width " + number(s.half_width) +
         " m, resolution " + std::to_string(s.resolution) + ", coarsest cells of side " +
         std::to_string(s.coarsest) + ", force limit " + number(s.force_limit) + " N, tolerance " +
         number(s.tolerance) + (s.tolerance_is_relative ? " of the largest force" : " N") + ", " +
         std::to_string(s.intermediate_states) + " intermediate states, " +
         (s.third_derivatives ? "third derivatives" : "no third derivatives");
}

/// Spacings that differ by less than this share are equal but for rounding.
constexpr double kSpacingRounding = 1e-12;

/// @throws InputError what is there around an active node is of no use for what is asked for.
void require_extension(const fs::path& path, const Site& there, const Site& asked) {
  const bool same_grid =
      there.tip_radius == asked.tip_radius && there.coarsest == asked.coarsest &&
      std::abs(there.spacing() - asked.spacing()) <= kSpacingRounding * there.spacing() &&
      (there.tolerance > 0) == (asked.tolerance > 0) &&
      there.intermediate_states == asked.intermediate_states &&
      there.third_derivatives == asked.third_derivatives;
  if (same_grid && asked.resolution >= there.resolution) return;
  throw InputError(
      quoted(path) + " holds active node " + std::to_string(asked.active_node) + " with " +
      describe(there) + "; asked for was " + describe(asked) +
      ". Give another file name, or those values: only the box may grow, by the same spacing, and "
      "force limit, tolerance and history may change.");
}

void write_scene(const Database& database, const Scene& scene, double solver_tolerance) {
  Statement insert(database, "INSERT INTO scene VALUES (1, NULL, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
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
  insert.run();
  static_assert(max_parameters == 10, "as the columns of the table");
  Statement insert_material(database,
                            "INSERT INTO material VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    insert_material.bind(static_cast<std::int64_t>(m));
    insert_material.bind(static_cast<std::int64_t>(scene.materials[m].law));
    insert_material.bind(static_cast<std::int64_t>(scene.materials[m].formulation));
    for (double p : scene.materials[m].parameters) insert_material.bind(p);
    insert_material.run();
  }
}

}  // namespace

struct StateSpaceFile::Impl {
  explicit Impl(Database opened) : database(std::move(opened)) {
    Statement select(database,
                     "SELECT hash, solver_tolerance, num_points FROM scene WHERE "
                     "scene_id = 1");
    if (!select.step()) throw_damaged(database.path(), "it holds no scene");
    scene_hash = select.take_text();
    solver_tolerance = select.take_double();
    num_points = select.take_integer();
  }

  Database database;
  bool writes = false;
  std::string scene_hash;
  double solver_tolerance = 0;
  std::int64_t num_points = 0;
  /// Prepared at the first use.
  std::optional<Statement> insert;
};

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

StateSpaceFile StateSpaceFile::create(const fs::path& path, const Scene& scene,
                                      double solver_tolerance) {
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder)) {
    throw InputError("There is no folder " + quoted(folder) + ". Make it, or give another file " +
                     "name.");
  }
  if (fs::exists(path)) {
    throw InputError(quoted(path) + " is there already. Open it to append, or give another file " +
                     "name.");
  }
  // Filled under another name, so that a run killed here leaves no half file under this one.
  const fs::path part = path.string() + ".part";
  // What SQLite left beside a file that was removed would be taken for a log of the new one.
  std::error_code error;
  fs::remove(part, error);
  for (const fs::path& file : {path, part}) {
    for (const char* suffix : {"-wal", "-shm", "-journal"}) {
      fs::remove(file.string() + suffix, error);
    }
  }
  sync_folder_of(path);
  {
    const Database database(part, Access::create);
    database.execute("PRAGMA page_size = " + std::to_string(kPageSize));
    database.execute("PRAGMA journal_mode = MEMORY");
    Transaction transaction(database);
    database.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
    database.execute("PRAGMA user_version = " + std::to_string(schema_version));
    database.execute(kSchema);
    write_scene(database, scene, solver_tolerance);
    transaction.commit();
  }
  fs::rename(part, path, error);
  if (error) {
    throw BackendError(quoted(part) + " cannot be renamed to " + quoted(path) + ": " +
                       error.message() + ". Check the permissions of the folder.");
  }
  sync_folder_of(path);
  return open_to_append(path, scene, solver_tolerance);
}

StateSpaceFile StateSpaceFile::open_to_append(const fs::path& path, const Scene& scene,
                                              double solver_tolerance) {
  check_is_there(path);
  auto impl = std::make_unique<Impl>(open_exclusively(path));
  const Database& database = impl->database;
  const std::string wanted = hash(scene);
  if (impl->scene_hash != wanted) {
    throw InputError(quoted(path) + " holds the state space of another scene: its hash is " +
                     impl->scene_hash + ", that of this scene (mesh, materials, fixed points) is " +
                     wanted + ". Give another file name, or restore the scene it was made for.");
  }
  if (impl->solver_tolerance != solver_tolerance) {
    throw InputError(quoted(path) + " was computed with the solver tolerance " +
                     number(impl->solver_tolerance) + ", not " + number(solver_tolerance) +
                     " (scene " + wanted + " in both). Give another file name, or that tolerance.");
  }
  if (database.text("PRAGMA journal_mode = WAL") != "wal") {
    throw BackendError("A write-ahead log cannot be kept beside " + quoted(path) +
                       ". Give a file name on another disk.");
  }
  // Safe against the death of the process, which is what a run has to survive; a commit then costs
  // no wait for the disk.
  database.execute("PRAGMA synchronous = NORMAL");
  // What may be touched is no part of the hash, and may have changed since.
  Statement update(database, "UPDATE scene SET touchable = ?1 WHERE touchable <> ?1");
  bind_array(update, scene.touchable);
  update.run();
  impl->writes = true;
  return StateSpaceFile(std::move(impl));
}

StateSpaceFile StateSpaceFile::open_or_create(const fs::path& path, const Scene& scene,
                                              double solver_tolerance) {
  return fs::exists(path) ? open_to_append(path, scene, solver_tolerance)
                          : create(path, scene, solver_tolerance);
}

StateSpaceFile StateSpaceFile::open_read_only(const fs::path& path) {
  return StateSpaceFile(std::make_unique<Impl>(open_to_read(path)));
}

void StateSpaceFile::close() {
  const std::unique_ptr<Impl> impl = std::move(impl_);
  impl->insert.reset();
  if (impl->writes) close_as_single_file(std::move(impl->database));
}

const fs::path& StateSpaceFile::path() const { return impl_->database.path(); }
const std::string& StateSpaceFile::scene_hash() const { return impl_->scene_hash; }
double StateSpaceFile::solver_tolerance() const { return impl_->solver_tolerance; }

Scene StateSpaceFile::read_scene() const {
  const Database& database = impl_->database;
  Statement select(database,
                   "SELECT element_order, num_points, num_cells, points, cells, material_of_cell "
                   "IS NULL, material_of_cell, fixed, touchable FROM scene WHERE scene_id = 1");
  select.step();
  Scene scene;
  TetMesh& mesh = scene.mesh;
  const std::int64_t order = select.take_integer();
  if (order != 1 && order != 2) throw_damaged(database.path(), "an unknown order of elements");
  mesh.order = static_cast<ElementOrder>(order);
  const std::int64_t num_points = select.take_integer();
  const std::int64_t num_cells = select.take_integer();
  mesh.points = take_array<Vec3>(select, num_points, database, "points");
  mesh.cells = take_array<Index>(select, num_cells * nodes_per_cell(mesh.order), database, "cells");
  const bool uniform = select.take_integer() != 0;
  scene.material_of_cell =
      take_array<Index>(select, uniform ? 0 : num_cells, database, "material_of_cell");
  scene.fixed = take_array<char>(select, num_points, database, "fixed");
  scene.touchable = take_array<char>(select, num_points, database, "touchable");

  Statement materials(database,
                      "SELECT law, formulation, parameter_0, parameter_1, parameter_2, "
                      "parameter_3, parameter_4, parameter_5, parameter_6, parameter_7, "
                      "parameter_8, parameter_9 FROM material WHERE scene_id = 1 ORDER BY material");
  while (materials.step()) {
    Material material;
    const std::int64_t law = materials.take_integer();
    if (law < 0 || law >= num_laws) throw_damaged(database.path(), "an unknown law");
    material.law = static_cast<Law>(law);
    const std::int64_t formulation = materials.take_integer();
    if (formulation != 0 && formulation != 1) {
      throw_damaged(database.path(), "an unknown formulation");
    }
    material.formulation = static_cast<Formulation>(formulation);
    for (double& p : material.parameters) p = materials.take_double();
    scene.materials.push_back(material);
  }
  const auto known = static_cast<Index>(scene.materials.size());
  const auto unknown = [&](Index m) { return m < 0 || m >= known; };
  if (known == 0 ||
      std::any_of(scene.material_of_cell.begin(), scene.material_of_cell.end(), unknown)) {
    throw_damaged(database.path(), "a material is missing");
  }
  if (hash(scene) != impl_->scene_hash) {
    throw_damaged(database.path(), "the scene has not the hash it was stored with");
  }
  return scene;
}

void StateSpaceFile::add_site(const Site& site) {
  if (const std::optional<Site> there = find_site(site.active_node)) {
    require_extension(path(), *there, site);
    if (!(*there == site)) extend(site);
    return;
  }
  Statement insert(impl_->database,
                   "INSERT INTO site VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, 0)");
  insert.bind(std::int64_t{site.active_node});
  insert.bind(site.tip_radius);
  insert.bind(site.half_width);
  insert.bind(std::int64_t{site.resolution});
  insert.bind(site.force_limit);
  insert.bind(std::int64_t{site.coarsest});
  insert.bind(site.tolerance);
  insert.bind(std::int64_t{site.tolerance_is_relative});
  insert.bind(static_cast<std::int64_t>(site.history));
  insert.bind(std::int64_t{site.intermediate_states});
  insert.bind(std::int64_t{site.third_derivatives});
  insert.run();
}

void StateSpaceFile::extend(const Site& site) {
  Transaction transaction(impl_->database);
  {
    Statement update(impl_->database,
                     "UPDATE site SET half_width = ?, resolution = ?, force_limit = ?, tolerance = "
                     "?, tolerance_is_relative = ?, history = ?, complete = 0 WHERE scene_id = 1 AND "
                     "active_node = ?");
    update.bind(site.half_width);
    update.bind(std::int64_t{site.resolution});
    update.bind(site.force_limit);
    update.bind(site.tolerance);
    update.bind(std::int64_t{site.tolerance_is_relative});
    update.bind(static_cast<std::int64_t>(site.history));
    update.bind(std::int64_t{site.active_node});
    update.run();
  }
  const std::string beyond = std::to_string(flags::beyond_force_limit);
  for (const std::string table : {"configuration", "intermediate"}) {
    Statement flag(impl_->database,
                   "UPDATE " + table + " SET flags = (flags & ~" + beyond +
                       ") | CASE WHEN ?1 > 0 AND force_x * force_x + force_y * force_y + force_z * "
                       "force_z > ?1 * ?1 THEN " +
                       beyond + " ELSE 0 END WHERE scene_id = 1 AND active_node = ?2");
    flag.bind(site.force_limit);
    flag.bind(std::int64_t{site.active_node});
    flag.run();
  }
  transaction.commit();
}

void StateSpaceFile::set_complete(Index active_node, bool complete) {
  Statement update(impl_->database,
                   "UPDATE site SET complete = ? WHERE scene_id = 1 AND active_node = ?");
  update.bind(std::int64_t{complete});
  update.bind(std::int64_t{active_node});
  update.run();
}

std::vector<SiteSpace> StateSpaceFile::read_sites() const {
  Statement select(impl_->database, std::string("SELECT ") + kSiteColumns +
                                        " FROM site WHERE scene_id = 1 ORDER BY active_node");
  std::vector<SiteSpace> sites;
  while (select.step()) sites.push_back(take_site(select));
  return sites;
}

std::optional<Site> StateSpaceFile::find_site(Index active_node) const {
  Statement select(impl_->database, std::string("SELECT ") + kSiteColumns +
                                        " FROM site WHERE scene_id = 1 AND active_node = ?");
  select.bind(std::int64_t{active_node});
  if (!select.step()) return std::nullopt;
  return take_site(select).site;
}

void StateSpaceFile::add(Index active_node, const Configuration& configuration,
                         const std::vector<IntermediateState>& way) {
  if (way.empty()) return add_alone(active_node, configuration);
  Transaction transaction(impl_->database);
  for (const IntermediateState& state : way) add_alone(active_node, state);
  add_alone(active_node, configuration);
  transaction.commit();
}

void StateSpaceFile::add_alone(Index active_node, const Configuration& configuration) {
  const Fields fields = blobs_of(configuration);
  if (!fit(fields, impl_->num_points)) {
    throw InputError("Configuration " + describe(configuration.check_point) + " of active node " +
                     std::to_string(active_node) + " has fields of another size than the " +
                     std::to_string(impl_->num_points) + " points of the body.");
  }
  if (!impl_->insert) {
    std::string parameters = "?1";
    for (int c = 1; c < kNumSummaryColumns + 7; ++c) parameters += ", ?" + std::to_string(c + 1);
    // Through the table of sites, so that nothing is stored for a site that is not there.
    impl_->insert.emplace(impl_->database,
                          "INSERT OR REPLACE INTO configuration (scene_id, active_node, " +
                              std::string(kSummaryColumns) + ", summary_checksum, checksum, " +
                              kFieldColumns + ") SELECT 1, " +
                              parameters + " FROM site WHERE scene_id = 1 AND active_node = ?1");
  }
  Statement& insert = *impl_->insert;
  insert.bind(std::int64_t{active_node});
  for_each_number(configuration, BindNumber{insert});
  insert.bind(checksum(active_node, configuration));
  insert.bind(checksum(fields));
  for (const auto& [data, bytes] : fields) insert.bind(data, bytes);
  insert.run();
  if (impl_->database.changes() == 0) {
    throw InputError(quoted(path()) + " has no site at active node " + std::to_string(active_node) +
                     ". Add the site first.");
  }
}

std::vector<Configuration> StateSpaceFile::read_where(Index active_node, const char* level) const {
  Statement select(impl_->database, std::string("SELECT ") + kSummaryColumns +
                                        ", summary_checksum FROM configuration WHERE scene_id = 1 "
                                        "AND active_node = ? AND " +
                                        level + " ORDER BY i, j, k, level");
  select.bind(std::int64_t{active_node});
  std::vector<Configuration> configurations;
  while (select.step()) {
    Configuration& configuration = configurations.emplace_back();
    for_each_number(configuration, TakeNumber{select, path()});
    if (select.take_integer() != checksum(active_node, configuration)) {
      throw_damaged(path(), "configuration " + describe(configuration.check_point) +
                                " of active node " + std::to_string(active_node));
    }
  }
  return configurations;
}

std::vector<Configuration> StateSpaceFile::read_summaries(Index active_node) const {
  std::vector<Configuration> configurations = read_where(active_node, "level >= 0");
  for (const LevelTransition& transition : read_transitions(active_node)) {
    Configuration key;
    key.check_point = transition.start;
    key.level = transition.start_level;
    const auto start = std::lower_bound(configurations.begin(), configurations.end(), key);
    if (start == configurations.end() || key < *start) continue;
    start->reached[neighbour_number(transition.start, transition.target)] = transition.reached;
  }
  return configurations;
}

std::vector<Configuration> StateSpaceFile::read_candidates(Index active_node) const {
  return read_where(active_node, "level < 0");
}

void StateSpaceFile::settle(Index active_node, const ConfigurationSummary& candidate,
                            std::int32_t level) {
  const auto bind_key = [&](Statement& statement) {
    statement.bind(std::int64_t{active_node});
    for (std::int32_t x : candidate.check_point) statement.bind(std::int64_t{x});
    statement.bind(std::int64_t{candidate.level});
    statement.run();
  };
  if (level < 0) {
    Statement remove(impl_->database, std::string("DELETE FROM configuration") + kAtKey);
    return bind_key(remove);
  }
  ConfigurationSummary settled = candidate;
  settled.level = level;
  Statement update(impl_->database, std::string("UPDATE configuration SET level = ?, "
                                                "summary_checksum = ?") +
                                        kAtKey);
  update.bind(std::int64_t{level});
  update.bind(checksum(active_node, settled));
  bind_key(update);
}

void StateSpaceFile::add(Index active_node, const LevelTransition& transition) {
  Statement insert(impl_->database, std::string("INSERT OR REPLACE INTO transition (scene_id, "
                                                "active_node, ") +
                                        kTransitionColumns +
                                        ", checksum) VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(std::int64_t{active_node});
  for_each_number_of_transition(transition, BindNumber{insert});
  insert.bind(checksum(active_node, transition));
  insert.run();
}

std::vector<LevelTransition> StateSpaceFile::read_transitions(Index active_node) const {
  Statement select(impl_->database, std::string("SELECT ") + kTransitionColumns +
                                        ", checksum FROM transition WHERE scene_id = 1 AND "
                                        "active_node = ? ORDER BY i, j, k, level, to_i, to_j, to_k");
  select.bind(std::int64_t{active_node});
  std::vector<LevelTransition> transitions;
  while (select.step()) {
    LevelTransition& transition = transitions.emplace_back();
    for_each_number_of_transition(transition, TakeNumber{select, path()});
    if (select.take_integer() != checksum(active_node, transition) ||
        neighbour_number(transition.start, transition.target) < 0) {
      throw_damaged(path(), "a transition from " + describe(transition.start) + " of active node " +
                                std::to_string(active_node));
    }
  }
  return transitions;
}

void StateSpaceFile::add_alone(Index active_node, const IntermediateState& state) {
  Statement insert(impl_->database,
                   std::string("INSERT OR REPLACE INTO intermediate (scene_id, active_node, ") +
                       kIntermediateColumns +
                       ", checksum) VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(std::int64_t{active_node});
  for_each_number_of_intermediate(state, BindNumber{insert});
  insert.bind(checksum(active_node, state));
  insert.run();
}

std::vector<IntermediateState> StateSpaceFile::read_intermediate_states(Index active_node) const {
  Statement select(impl_->database, std::string("SELECT ") + kIntermediateColumns +
                                        ", checksum FROM intermediate WHERE scene_id = 1 AND "
                                        "active_node = ? ORDER BY i, j, k, number");
  select.bind(std::int64_t{active_node});
  std::vector<IntermediateState> states;
  while (select.step()) {
    IntermediateState& state = states.emplace_back();
    for_each_number_of_intermediate(state, TakeNumber{select, path()});
    if (select.take_integer() != checksum(active_node, state)) {
      throw_damaged(path(), "an intermediate state on the way to " + describe(state.target) +
                                " of active node " + std::to_string(active_node));
    }
  }
  return states;
}

void StateSpaceFile::read_fields(Index active_node, Configuration& configuration) const {
  const Database& database = impl_->database;
  Statement select(database, std::string("SELECT checksum, ") + kFieldColumns +
                                 " FROM configuration" + kAtKey);
  select.bind(std::int64_t{active_node});
  for (std::int32_t x : configuration.check_point) select.bind(std::int64_t{x});
  select.bind(std::int64_t{configuration.level});
  const std::string which = "configuration " + describe(configuration.check_point) +
                            " of active node " + std::to_string(active_node);
  if (!select.step()) throw InputError(quoted(path()) + " holds no " + which + '.');
  const std::int64_t stored_checksum = select.take_integer();
  Fields fields;
  for (Statement::Blob& field : fields) field = select.take_blob();
  if (!fit(fields, impl_->num_points) || checksum(fields) != stored_checksum) {
    throw_damaged(database.path(), "the fields of " + which);
  }
  auto field = fields.begin();
  for_each_field(configuration, [&](auto& values) {
    const auto [data, bytes] = *field++;
    using Field = std::decay_t<decltype(values)>;
    values = Field();
    if (bytes == 0) return;
    constexpr Eigen::Index columns = Field::ColsAtCompileTime == 1 ? 1 : 3;
    values.resize(static_cast<Eigen::Index>(bytes / sizeof(double)) / columns, columns);
    std::memcpy(values.data(), data, bytes);
  });
}

StateSpace StateSpaceFile::read(bool with_fields) const {
  StateSpace space;
  space.scene = read_scene();
  space.scene_hash = impl_->scene_hash;
  space.solver_tolerance = impl_->solver_tolerance;
  space.sites = read_sites();
  for (SiteSpace& site : space.sites) {
    const Index node = site.site.active_node;
    site.configurations = read_summaries(node);
    site.intermediate_states = read_intermediate_states(node);
    if (!with_fields) continue;
    for (Configuration& configuration : site.configurations) read_fields(node, configuration);
  }
  return space;
}

void StateSpaceFile::add(const TestSet& set, const TestPoint& point) {
  std::string parameters = "1, ?, ?, ?, ?";
  for (int c = 0; c < kNumTestPointColumns + 2; ++c) parameters += ", ?";
  Statement insert(impl_->database,
                   std::string("INSERT OR IGNORE INTO test_point (scene_id, active_node, "
                               "tip_radius, half_width, seed, ") +
                       kTestPointColumns + ", checksum, displacement) VALUES (" + parameters + ')');
  insert.bind(std::int64_t{set.active_node});
  insert.bind(set.tip_radius);
  insert.bind(set.half_width);
  insert.bind(set.seed);
  for_each_number_of_test_point(point, BindNumber{insert});
  insert.bind(checksum(set, point));
  const auto size = static_cast<std::size_t>(point.displacement.size()) * sizeof(float);
  insert.bind(size == 0 ? nullptr : point.displacement.data(), size);
  insert.run();
}

std::vector<TestPoint> StateSpaceFile::read_test_points(const TestSet& set) const {
  Statement select(impl_->database,
                   std::string("SELECT ") + kTestPointColumns +
                       ", checksum, displacement FROM test_point WHERE scene_id = 1 AND active_node "
                       "= ? AND tip_radius = ? AND half_width = ? AND seed = ? ORDER BY kind, number");
  select.bind(std::int64_t{set.active_node});
  select.bind(set.tip_radius);
  select.bind(set.half_width);
  select.bind(set.seed);
  std::vector<TestPoint> points;
  while (select.step()) {
    TestPoint& point = points.emplace_back();
    for_each_number_of_test_point(point, TakeNumber{select, path()});
    const std::int64_t stored_checksum = select.take_integer();
    const Statement::Blob blob = select.take_blob();
    point.displacement.resize(static_cast<Eigen::Index>(blob.bytes / sizeof(float)));
    if (blob.bytes > 0) {
      std::memcpy(point.displacement.data(), blob.data,
                  static_cast<std::size_t>(point.displacement.size()) * sizeof(float));
    }
    if (checksum(set, point) != stored_checksum) {
      throw_damaged(path(), "test point " + std::to_string(point.number) + " of active node " +
                                std::to_string(set.active_node));
    }
  }
  return points;
}

void StateSpaceFile::merge(const std::vector<fs::path>& others) {
  const Database& database = impl_->database;
  for (const fs::path& other_path : others) {
    std::vector<SiteSpace> sites;
    {
      // Opened by itself first: that checks it, and takes up the log of a rank that was killed.
      const StateSpaceFile other = open_read_only(other_path);
      if (other.scene_hash() != scene_hash() || other.solver_tolerance() != solver_tolerance()) {
        throw InputError(quoted(other_path) + " cannot be merged into " + quoted(path()) +
                         ": its scene has the hash " + other.scene_hash() + " and the tolerance " +
                         number(other.solver_tolerance()) + ", here they are " + scene_hash() +
                         " and " + number(solver_tolerance()) + ". Leave it out.");
      }
      sites = other.read_sites();
    }
    for (const SiteSpace& site : sites) {
      if (const std::optional<Site> here = find_site(site.site.active_node)) {
        require_extension(other_path, site.site, *here);
      } else {
        add_site(site.site);
      }
    }

    const sqlite::Attachment attachment(database, other_path);
    for (const SiteSpace& site : sites) {
      const std::string node = std::to_string(site.site.active_node);
      Transaction transaction(database);
      database.execute(
          "DELETE FROM main.configuration AS here WHERE scene_id = 1 AND active_node = " + node +
          " AND outcome <> 0 AND EXISTS (SELECT 1 FROM other.configuration AS there WHERE "
          "there.scene_id = 1 AND there.active_node = here.active_node AND there.i = here.i AND "
          "there.j = here.j AND there.k = here.k AND there.level = here.level AND there.outcome "
          "= 0)");
      database.execute(
          "INSERT OR IGNORE INTO main.configuration SELECT * FROM other.configuration WHERE "
          "scene_id = 1 AND active_node = " +
          node + " ORDER BY i, j, k, level");
      database.execute(
          "INSERT OR IGNORE INTO main.transition SELECT * FROM other.transition WHERE scene_id = 1 "
          "AND active_node = " +
          node);
      database.execute(
          "INSERT OR IGNORE INTO main.intermediate SELECT * FROM other.intermediate WHERE scene_id "
          "= 1 AND active_node = " +
          node + " ORDER BY i, j, k, number");
      transaction.commit();
    }
    database.execute("INSERT OR IGNORE INTO main.test_point SELECT * FROM other.test_point");
  }
  checkpoint(database);
}

}  // namespace palpate
