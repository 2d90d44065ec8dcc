// SPDX-License-Identifier: BSD-3-Clause
#include "storage/bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "assembly/pressures.h"
#include "base/error.h"
#include "base/printable.h"
#include "storage/blob_sizes.h"
#include "storage/schema.h"
#include "storage/table.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "The blobs of a state space are little-endian and are written as they lie in memory."
#endif

namespace palpate::storage {
namespace {

using blobs::kLargestRow;
using sqlite::Database;
using sqlite::Statement;

constexpr char kBodyForce[] = "body_force";
constexpr char kBoundary[] = "boundary_array";
constexpr char kContact[] = "body_contact";
constexpr char kCut[] = "body_cut";

/// @tparam Values std::vector or Eigen::VectorXd.
template <class Values>
void bind_array(Statement& statement, const Values& values) {
  statement.bind(values.size() == 0 ? nullptr : static_cast<const void*>(values.data()),
                 static_cast<std::size_t>(values.size()) * sizeof(typename Values::value_type));
}

/// @throws InputError the BLOB has another size than the body asks for.
template <class Number, class Values>
void take_array(Statement& statement, const blobs::Size<Number>& size, const Database& database,
                const char* what, Values& values) {
  if (!blobs::copy(statement.take_blob(), size, values)) {
    throw_damaged(database.path(), std::string(what) + " has another size than the body");
  }
}

/// The bytes of the largest row of a body, without its numbers: that of the body itself, or of a
/// configuration without a basis. The memory that is taken to read it is no more.
std::int64_t bytes_of_body(std::int64_t num_points, std::int64_t num_cells) {
  // The scene: points, fixed, touchable, or directions; at most ten nodes a cell, and its material.
  const std::int64_t of_scene = num_points * (6 * 8 + 2) + num_cells * (10 + 1) * 4;
  // u and v; p and p_v at most at four corners a cell.
  const std::int64_t of_fields = num_points * 12 * 8 + num_cells * 16 * 8;
  return std::max(of_scene, of_fields);
}

bool is_too_large(std::int64_t num_points, std::int64_t num_cells) {
  return bytes_of_body(num_points, num_cells) > kLargestRow - blobs::kOfNumbers;
}

/// The name of a body, for a message.
std::string name_of_body(BodyId body) {
  return body == kFirstBody ? "the body" : "body " + std::to_string(body);
}

void write_scene(const Database& database, BodyId body, const Scene& scene,
                 double solver_tolerance) {
  Statement insert(database, Table("scene").insert("ABORT"));
  insert.bind(body);
  insert.bind(nullptr, 0);  // It has no parent.
  const TetMesh& mesh = scene.body.mesh;
  insert.bind(hash(scene));
  insert.bind(solver_tolerance);
  insert.bind(static_cast<std::int64_t>(mesh.order));
  insert.bind(std::int64_t{mesh.num_points()});
  insert.bind(std::int64_t{mesh.num_cells()});
  bind_array(insert, mesh.points);
  bind_array(insert, mesh.cells);
  bind_array(insert, scene.body.material_of_cell);
  bind_array(insert, scene.body.fixed);
  bind_array(insert, scene.body.touchable);
  insert.bind(rows::checksum(body, scene.body.touchable, solver_tolerance));
  insert.run();
  static_assert(max_parameters == 10, "as the columns of the table");
  Statement insert_material(database, Table("material").insert("ABORT"));
  for (std::size_t m = 0; m < scene.organ.materials.size(); ++m) {
    insert_material.bind(body);
    insert_material.bind(static_cast<std::int64_t>(m));
    insert_material.bind(static_cast<std::int64_t>(scene.organ.materials[m].law));
    insert_material.bind(static_cast<std::int64_t>(scene.organ.materials[m].formulation));
    for (double p : scene.organ.materials[m].parameters) insert_material.bind(p);
    insert_material.run();
  }
}

/// @param scene It must have a load.
void require_rest_of(const Scene& scene, const SettledBody& at_rest) {
  if (at_rest.u.size() == 3 * Eigen::Index{scene.body.mesh.num_points()}) return;
  throw InputError(
      "The rest of the body under its load is needed to store its state space, and is not there. "
      "Find it first.");
}

/// Calls visit(name, array) for the arrays of what holds and loads the surface.
template <class AnyBody, class Visit>
void for_each_boundary_array(AnyBody& body, const Visit& visit) {
  visit("HeldDirection", body.held_directions);
  visit("SupportStiffness", body.support_stiffness);
  visit("AppliedPressure", body.applied_pressure);
  visit("AppliedTraction", body.applied_traction);
}
constexpr char kRestDisplacement[] = "RestDisplacement";
constexpr char kRestPressure[] = "RestPressure";

/// The rest of a body is stored with the arrays of its surface.
bool rests_in_boundary(const Scene& scene) {
  return scene.has_load() && !scene.organ.has_body_force();
}

/// @param scene It must have supports or loads of its surface.
void write_boundary(const Database& database, BodyId body, const Scene& scene,
                    const SettledBody& at_rest) {
  make_table(database, kBoundary);
  Statement insert(database, Table(kBoundary).insert("ABORT"));
  const auto write = [&](const std::string& name, const auto& array) {
    using Value = std::decay_t<decltype(array[0])>;
    const Statement::Blob numbers{array.size() == 0 ? nullptr : array.data(),
                                  static_cast<std::size_t>(array.size()) * sizeof(Value)};
    insert.bind(body);
    insert.bind(name);
    insert.bind(rows::checksum(body, name, numbers));
    insert.bind(numbers.data, numbers.bytes);
    insert.run();
  };
  for_each_boundary_array(scene.body, [&](const char* name, const auto& array) {
    if (!array.empty()) write(name, array);
  });
  if (!rests_in_boundary(scene)) return;
  require_rest_of(scene, at_rest);
  write(kRestDisplacement, at_rest.u);
  write(kRestPressure, at_rest.p);
}

/// @param scene It must have a body force.
void write_body_force(const Database& database, BodyId body, const Scene& scene,
                      const SettledBody& at_rest) {
  require_rest_of(scene, at_rest);
  make_table(database, kBodyForce);
  Statement insert(database, Table(kBodyForce).insert("ABORT"));
  insert.bind(body);
  insert.bind(scene.organ.body_force.data(), 3 * sizeof(double));
  bind_array(insert, scene.organ.densities);
  bind_array(insert, at_rest.u);
  bind_array(insert, at_rest.p);
  insert.bind(rows::checksum(body, at_rest));
  insert.run();
}

/// @param scene Its parts must touch each other.
void write_contact(const Database& database, BodyId body, const Scene& scene) {
  make_table(database, kContact);
  Statement insert(database, Table(kContact).insert("ABORT"));
  insert.bind(body);
  insert.bind(static_cast<std::int64_t>(scene.organ.touching));
  insert.bind(scene.organ.contact.thickness);
  insert.bind(scene.organ.contact.stiffness);
  bind_array(insert, scene.body.part_of_cell);
  insert.run();
}

template <class Value>
sqlite::Statement::Blob blob_of(const std::vector<Value>& values) {
  return {values.data(), values.size() * sizeof(Value)};
}

/// @param cut It has faces.
void write_cut(const Database& database, BodyId body, const Cut& cut) {
  make_table(database, kCut);
  Statement insert(database, Table(kCut).insert("ABORT"));
  insert.bind(body);
  insert.bind(std::int64_t{cut.stage});
  bind_array(insert, cut.areas);
  bind_array(insert, cut.faces);
  insert.bind(rows::checksum(body, cut.stage, blob_of(cut.areas), blob_of(cut.faces)));
  insert.run();
}

void write_body(const Database& database, BodyId body, const Scene& scene,
                const SettledBody& at_rest, double solver_tolerance) {
  write_scene(database, body, scene, solver_tolerance);
  if (scene.organ.has_body_force()) write_body_force(database, body, scene, at_rest);
  if (scene.body.has_supports_or_surface_loads()) write_boundary(database, body, scene, at_rest);
  if (scene.organ.touching != TouchingParts::none) write_contact(database, body, scene);
  if (!scene.body.cut.faces.empty()) write_cut(database, body, scene.body.cut);
}

}  // namespace

Bodies::Bodies(Connection& connection) : connection_(connection) { read_heads(); }

void Bodies::read_heads() {
  heads_.clear();
  Statement select(connection_.database(),
                   "SELECT scene_id, hash, solver_tolerance, num_points, num_cells FROM scene "
                   "ORDER BY scene_id");
  while (select.step()) {
    BodyHead head;
    head.number = select.take_integer();
    head.hash = select.take_text();
    head.solver_tolerance = select.take_double();
    head.num_points = select.take_integer();
    head.num_cells = select.take_integer();
    if (head.num_points < 0 || head.num_points > kLargestRow || head.num_cells < 0 ||
        head.num_cells > kLargestRow || is_too_large(head.num_points, head.num_cells)) {
      throw_damaged(connection_.path(), "a body of " + std::to_string(head.num_points) +
                                            " points and " + std::to_string(head.num_cells) +
                                            " cells");
    }
    heads_[head.number] = head;
  }
  if (heads_.empty() || heads_.begin()->first != kFirstBody) {
    throw_damaged(connection_.path(), "it holds no scene");
  }
  for (const auto& [number, head] : heads_) {
    connection_.make_room(bytes_of_body(head.num_points, head.num_cells));
  }
}

void Bodies::write_first(const Database& database, const Scene& scene, const SettledBody& at_rest,
                         double solver_tolerance) {
  write_body(database, kFirstBody, scene, at_rest, solver_tolerance);
}

void Bodies::require_size(const Scene& scene) {
  if (!is_too_large(scene.body.mesh.num_points(), scene.body.mesh.num_cells())) return;
  throw InputError("The body has " + std::to_string(scene.body.mesh.num_points()) + " points and " +
                   std::to_string(scene.body.mesh.num_cells()) +
                   " cells: more than a state-space file can hold. Take a coarser mesh.");
}

BodyId Bodies::add(const Scene& scene, const std::string& scene_hash, const SettledBody& at_rest) {
  if (const std::optional<BodyId> there = find(scene_hash)) {
    connection_.before_change();
    set_touchable(*there, scene.body.touchable);
    return *there;
  }
  require_size(scene);
  require_one_organ(read(kFirstBody), scene);
  const Database& database = connection_.database();
  const BodyId number = heads_.rbegin()->first + 1;
  connection_.make_room(bytes_of_body(scene.body.mesh.num_points(), scene.body.mesh.num_cells()));
  connection_.before_change();
  sqlite::Transaction transaction(database);
  write_body(database, number, scene, at_rest, solver_tolerance());
  transaction.commit();
  read_heads();
  return number;
}

std::vector<BodyId> Bodies::list() const {
  std::vector<BodyId> numbers;
  for (const auto& [number, head] : heads_) numbers.push_back(number);
  return numbers;
}

std::optional<BodyId> Bodies::find(const std::string& hash) const {
  for (const auto& [number, head] : heads_) {
    if (head.hash == hash) return number;
  }
  return std::nullopt;
}

const BodyHead& Bodies::head(BodyId body) const {
  const auto found = heads_.find(body);
  if (found != heads_.end()) return found->second;
  throw InputError(quoted(connection_.path()) + " has no body " + std::to_string(body) +
                   ". Add it first.");
}

Scene Bodies::read(BodyId body) const {
  const Database& database = connection_.database();
  const bool has_checksum = connection_.has_checksums();
  const auto& [number, stored_hash, tolerance, num_points, num_cells] = head(body);
  Scene scene;
  scene.body.mesh = read_mesh(body);
  const TetMesh& mesh = scene.body.mesh;
  Statement select(database, std::string("SELECT fixed, touchable, ") +
                                 (has_checksum ? "checksum" : "NULL") +
                                 " FROM scene WHERE scene_id = ?");
  select.bind(body);
  select.step();
  take_array(select, blobs::marks(num_points), database, "fixed", scene.body.fixed);
  take_array(select, blobs::marks(num_points), database, "touchable", scene.body.touchable);
  if (has_checksum &&
      select.take_integer() != rows::checksum(body, scene.body.touchable, tolerance)) {
    connection_.damage().leave_out("where " + name_of_body(body) + " may be touched", "scene", 0);
    std::fill(scene.body.touchable.begin(), scene.body.touchable.end(), char{0});
  }
  read_materials(body, scene);
  SettledBody at_rest;
  if (has_table(database, kBodyForce)) read_body_force(body, scene.organ, at_rest);
  if (has_table(database, kBoundary)) read_boundary(body, scene, at_rest);
  if (has_table(database, kContact)) read_contact(body, scene);
  if (has_table(database, kCut)) read_cut(body, scene.body.cut);
  if (hash(scene) != stored_hash) {
    throw_damaged(database.path(), "the scene has not the hash it was stored with");
  }
  // Someone may have made a file whose hash fits a body that is not valid.
  if (!std::all_of(mesh.points.begin(), mesh.points.end(),
                   [](const Vec3& p) { return p.allFinite(); })) {
    throw_damaged(database.path(), "a point of the body is none");
  }
  read_[body].settled = std::move(at_rest);
  return scene;
}

std::vector<SpaceBody> Bodies::read_all() const {
  std::vector<SpaceBody> all;
  for (const auto& [number, head] : heads_) {
    SpaceBody& body = all.emplace_back();
    body.number = number;
    body.scene = std::make_shared<const Scene>(read(number));
    body.hash = head.hash;
    body.at_rest = settled(number);
  }
  return all;
}

void Bodies::set_touchable(BodyId body, const std::vector<char>& touchable) const {
  Statement update(connection_.database(),
                   "UPDATE scene SET touchable = ?1, checksum = ?2 WHERE scene_id = ?3 AND "
                   "(touchable <> ?1 OR checksum IS NOT ?2)");
  bind_array(update, touchable);
  update.bind(rows::checksum(body, touchable, solver_tolerance()));
  update.bind(body);
  update.run();
}

Index Bodies::num_pressures(BodyId body) const {
  const auto known = num_pressures_->find(body);
  if (known != num_pressures_->end()) return known->second;
  Scene scene;
  scene.body.mesh = read_mesh(body);
  read_materials(body, scene);
  return (*num_pressures_)[body] = count_pressures(scene);
}

const SettledBody& Bodies::settled(BodyId body) const {
  std::optional<SettledBody>& settled = read_[body].settled;
  if (settled) return *settled;
  Scene scene;
  SettledBody at_rest;
  const Database& database = connection_.database();
  if (has_table(database, kBodyForce)) {
    read_materials(body, scene);
    read_body_force(body, scene.organ, at_rest);
  } else if (has_table(database, kBoundary)) {
    read_boundary(body, scene, at_rest);
  }
  return *(settled = std::move(at_rest));
}

const std::vector<Index>& Bodies::points_of(BodyId body, Keep keep) const {
  Read& of_body = read_[body];
  const auto found = of_body.points.find(keep);
  if (found != of_body.points.end()) return found->second;
  if (!of_body.body) {
    of_body.body.emplace();
    of_body.body->mesh = read_mesh(body);
    if (has_table(connection_.database(), kCut)) read_cut(body, of_body.body->cut);
  }
  return of_body.points[keep] = kept_points(of_body.body->mesh, make_surface(*of_body.body), keep);
}

TetMesh Bodies::read_mesh(BodyId body) const {
  const Database& database = connection_.database();
  const auto& [number, hash, tolerance, num_points, num_cells] = head(body);
  Statement select(database, "SELECT element_order, points, cells FROM scene WHERE scene_id = ?");
  select.bind(body);
  select.step();
  TetMesh read;
  const std::int64_t order = select.take_integer();
  if (order != 1 && order != 2) throw_damaged(connection_.path(), "an unknown order of elements");
  read.order = static_cast<ElementOrder>(order);
  take_array(select, blobs::points(num_points), database, "points", read.points);
  take_array(select, blobs::cells(num_cells, nodes_per_cell(read.order)), database, "cells",
             read.cells);
  if (std::any_of(read.cells.begin(), read.cells.end(),
                  [&](Index p) { return p < 0 || p >= num_points; })) {
    throw_damaged(connection_.path(), "a cell of the body is none");
  }
  return read;
}

void Bodies::read_materials(BodyId body, Scene& scene) const {
  const Database& database = connection_.database();
  {
    Statement select(database, "SELECT material_of_cell FROM scene WHERE scene_id = ?");
    select.bind(body);
    select.step();
    take_array(select, blobs::of_cells(head(body).num_cells), database, "material_of_cell",
               scene.body.material_of_cell);
  }
  Statement select(database, "SELECT " + Table("material").columns("law", "") +
                                 " FROM material WHERE scene_id = ? ORDER BY material");
  select.bind(body);
  while (select.step()) {
    const std::int64_t law = select.take_integer();
    if (law < 0 || law >= num_laws) throw_damaged(connection_.path(), "an unknown law");
    const std::int64_t formulation = select.take_integer();
    if (formulation < 0 || formulation >= num_formulations) {
      throw_damaged(connection_.path(), "an unknown formulation");
    }
    std::array<double, max_parameters> parameters{};
    for (double& p : parameters) p = select.take_double();
    try {
      Material& material = scene.organ.materials.emplace_back(with_formulation(
          make_material(static_cast<Law>(law), parameters), static_cast<Formulation>(formulation)));
      // The hash takes in all parameters as they were given, also those that the law does not have.
      material.parameters = parameters;
    } catch (const InputError& error) {
      throw_damaged(connection_.path(), std::string("a material is none: ") + error.what());
    }
  }
  const auto known_materials = static_cast<Index>(scene.organ.materials.size());
  if (known_materials == 0 ||
      std::any_of(scene.body.material_of_cell.begin(), scene.body.material_of_cell.end(),
                  [&](Index m) { return m < 0 || m >= known_materials; })) {
    throw_damaged(connection_.path(), "a material is missing");
  }
}

void Bodies::read_contact(BodyId body, Scene& scene) const {
  const Database& database = connection_.database();
  Statement select(database,
                   "SELECT touching, thickness, stiffness, part_of_cell FROM body_contact WHERE "
                   "scene_id = ?");
  select.bind(body);
  if (!select.step()) throw_damaged(connection_.path(), "the contact of the parts is missing");
  const std::int64_t touching = select.take_integer();
  if (touching < 1 || touching > 3) throw_damaged(connection_.path(), "an unknown contact");
  scene.organ.touching = static_cast<TouchingParts>(touching);
  scene.organ.contact.thickness = select.take_double();
  scene.organ.contact.stiffness = select.take_double();
  take_array(select, blobs::of_cells(head(body).num_cells), database, "part_of_cell",
             scene.body.part_of_cell);
}

void Bodies::read_cut(BodyId body, Cut& cut) const {
  const Database& database = connection_.database();
  Statement select(database,
                   "SELECT stage, areas, faces, checksum FROM body_cut WHERE scene_id = ?");
  select.bind(body);
  if (!select.step()) return;
  const std::int64_t stage = select.take_integer();
  take_array(select, blobs::areas_of_stages(), database, "the areas of the cut", cut.areas);
  take_array(select, blobs::faces_of_cells(head(body).num_cells), database, "the cut", cut.faces);
  if (select.take_integer() !=
      rows::checksum(body, stage, blob_of(cut.areas), blob_of(cut.faces))) {
    throw_damaged(connection_.path(), "the cut is none");
  }
  cut.stage = static_cast<std::int32_t>(stage);
}

void Bodies::read_body_force(BodyId body, Organ& organ, SettledBody& at_rest) const {
  const Database& database = connection_.database();
  Statement select(database,
                   "SELECT acceleration, densities, displacement, pressures, checksum FROM "
                   "body_force WHERE scene_id = ?");
  select.bind(body);
  if (!select.step()) throw_damaged(connection_.path(), "the body force is missing");
  take_array(select, blobs::vector(), database, "acceleration", organ.body_force);
  const auto num_materials = static_cast<std::int64_t>(organ.materials.size());
  take_array(select, blobs::densities(num_materials), database, "densities", organ.densities);
  take_array(select, blobs::settled_displacement(num_points(body)), database,
             "the displacement at rest", at_rest.u);
  take_array(select, blobs::pressures<double>(num_pressures(body)), database,
             "the pressures at rest", at_rest.p);
  if (select.take_integer() != rows::checksum(body, at_rest) || !at_rest.u.allFinite() ||
      !at_rest.p.allFinite()) {
    throw_damaged(connection_.path(), "the rest under the body force is none");
  }
  if (!organ.body_force.allFinite() || organ.body_force.isZero(0) ||
      !std::all_of(organ.densities.begin(), organ.densities.end(),
                   [](double density) { return std::isfinite(density) && density >= 0; })) {
    throw_damaged(connection_.path(), "the body force is none");
  }
}

void Bodies::read_boundary(BodyId body, Scene& scene, SettledBody& at_rest) const {
  Statement select(connection_.database(),
                   "SELECT name, checksum, numbers FROM boundary_array WHERE scene_id = ?");
  select.bind(body);
  while (select.step()) {
    const std::string name = select.take_text();
    const std::int64_t sum = select.take_integer();
    const Statement::Blob numbers = select.take_blob();
    bool is_good = rows::checksum(body, name, numbers) == sum;
    const auto take = [&](const auto& size, auto& array) {
      is_good = is_good && blobs::copy(numbers, size, array);
    };
    if (name == kRestDisplacement) {
      take(blobs::settled_displacement(num_points(body)), at_rest.u);
    } else if (name == kRestPressure) {
      take(blobs::pressures<double>(num_pressures(body)), at_rest.p);
    } else {
      bool is_known = false;
      for_each_boundary_array(scene.body, [&](const char* known_name, auto& array) {
        if (name != known_name) return;
        is_known = true;
        take(blobs::boundary_array(num_points(body), sizeof array[0] / sizeof(double)), array);
      });
      is_good = is_good && is_known;
    }
    if (!is_good)
      throw_damaged(connection_.path(), "the array " + name + " of the boundary is none");
  }
  if (!at_rest.u.allFinite() || !at_rest.p.allFinite()) {
    throw_damaged(connection_.path(), "the rest under the loads is none");
  }
  const bool lacks_rest = rests_in_boundary(scene) && at_rest.u.size() == 0;
  if (!scene.body.has_supports_or_surface_loads() || lacks_rest) {
    throw_damaged(connection_.path(), "the supports and loads of the body are not complete");
  }
}

}  // namespace palpate::storage
