// SPDX-License-Identifier: BSD-3-Clause
#include "storage/tables.h"

#include <algorithm>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/printable.h"
#include "storage/schema.h"
#include "storage/stored_kind.h"
#include "storage/versions.h"

namespace palpate::storage {

using sqlite::Transaction;

namespace {

/// The number here of each body of another file.
std::map<BodyId, BodyId> match_bodies(const Tables& here, const Tables& other) {
  const double tolerance = here.bodies.solver_tolerance();
  std::map<BodyId, BodyId> numbers;
  for (const BodyId number : other.bodies.list()) {
    const BodyHead& body = other.bodies.head(number);
    const std::optional<BodyId> found = here.bodies.find(body.hash);
    if (!found || body.solver_tolerance != tolerance) {
      throw InputError(quoted(other.connection.path()) + " cannot be merged into " +
                       quoted(here.connection.path()) + ": its scene has the hash " + body.hash +
                       " and the tolerance " + shortest(body.solver_tolerance) +
                       ", here they are " + here.bodies.head(kFirstBody).hash + " and " +
                       shortest(tolerance) + ". Leave it out.");
    }
    numbers[number] = *found;
  }
  return numbers;
}

}  // namespace

Tables::Tables(sqlite::Database opened) : connection(std::move(opened)) {
  for (const BodyId body : bodies.list()) reduced_models.try_emplace(body, connection, body);
}

BodyId find_body(const Tables& tables, const Scene& scene, double solver_tolerance) {
  const std::string path = quoted(tables.connection.path());
  const std::string wanted = hash(scene);
  const std::optional<BodyId> found = tables.bodies.find(wanted);
  if (!found) {
    throw InputError(path + " holds the state space of another scene: its hash is " +
                     tables.bodies.head(kFirstBody).hash +
                     ", that of this scene (mesh, materials, fixed points, supports and loads, "
                     "and with a BodyForce that and the densities) is " +
                     wanted + ". Give another file name, or restore the scene it was made for.");
  }
  const double tolerance = tables.bodies.solver_tolerance();
  if (tolerance != solver_tolerance) {
    throw InputError(path + " was computed with the solver tolerance " + shortest(tolerance) +
                     ", not " + shortest(solver_tolerance) + " (scene " + wanted +
                     " in both). Give another file name, or that tolerance.");
  }
  return *found;
}

BodyId add_body(Tables& tables, const Scene& scene, const std::string& scene_hash,
                const SettledBody& at_rest) {
  const BodyId body = tables.bodies.add(scene, scene_hash, at_rest);
  tables.reduced_models.try_emplace(body, tables.connection, body);
  return body;
}

void change_together(Connection& connection, const std::function<void()>& body) {
  connection.before_change();
  {
    Transaction transaction(connection.database());
    body();
    transaction.commit();
  }
  connection.checkpoint();
}

void shrink(const Tables& tables) {
  // Every row is written anew, so the largest one must fit.
  for (const auto& [body, models] : tables.reduced_models) models.make_room();
  tables.connection.shrink();
}

void add_tool_space(Tables& tables, const ToolSpaceSetup& setup) {
  tables.tool_spaces.check(setup);
  const std::optional<ToolSpace> there = tables.tool_spaces.find(setup.key());
  if (!there) return tables.tool_spaces.add(setup);
  require_extension(tables.connection.path(), there->setup, setup);
  if (there->setup == setup) return;
  tables.connection.before_change();
  Transaction transaction(tables.connection.database());
  tables.tool_spaces.write(ToolSpace{setup, false, {}, {}});
  tables.configurations.mark(setup);
  tables.intermediate_states.mark(setup);
  transaction.commit();
}

void add_with_way(Tables& tables, const ToolSpaceKey& key, const Configuration& configuration,
                  const std::vector<IntermediateState>& way) {
  if (way.empty()) return tables.configurations.add(key, configuration);
  tables.connection.before_change();
  Transaction transaction(tables.connection.database());
  for (const IntermediateState& state : way) tables.intermediate_states.add(key, state);
  tables.configurations.add(key, configuration);
  transaction.commit();
}

std::vector<Configuration> read_summaries(const Tables& tables, const ToolSpaceKey& key) {
  std::vector<Configuration> configurations = tables.configurations.read_settled(key);
  for (const LevelTransition& transition : tables.transitions.read_linked(key, configurations)) {
    note(transition, configurations);
  }
  return configurations;
}

StateSpace read_space(const Tables& tables, bool with_fields) {
  StateSpace space;
  space.bodies = tables.bodies.read_all();
  space.solver_tolerance = tables.bodies.solver_tolerance();
  space.tool_spaces = tables.tool_spaces.read_all();
  for (ToolSpace& tool_space : space.tool_spaces) {
    const ToolSpaceKey key = tool_space.setup.key();
    for (Configuration& configuration : read_summaries(tables, key)) {
      if (with_fields && !tables.configurations.read_fields(key, configuration)) continue;
      tool_space.configurations.push_back(std::move(configuration));
    }
    tool_space.intermediate_states = tables.intermediate_states.read(key);
  }
  return space;
}

std::vector<std::string> list_left_out(const Tables& tables) {
  std::vector<std::string> names = tables.connection.damage().names();
  // A row whose key was damaged may belong to nothing that is read, and where the index is damaged
  // a row is not found by its key.
  const std::vector<std::string> lost = list_lost_rows(tables.connection.database());
  names.insert(names.end(), lost.begin(), lost.end());
  return names;
}

std::vector<std::string> remove_damaged(Tables& tables) {
  for (const ToolSpace& space : tables.tool_spaces.read_all()) {
    const ToolSpaceKey key = space.setup.key();
    for (const BasisBox& box : tables.bases.list(key)) (void)tables.bases.read(key, box.number);
    for (const Configuration& c : tables.configurations.read_all(key)) {
      StoredFields stored;
      (void)tables.configurations.read_stored(key, c, stored);
    }
    (void)tables.transitions.read(key);
    (void)tables.intermediate_states.read(key);
  }
  for (const BodyId body : tables.bodies.list()) {
    for (const TestSet& set : tables.test_points.list_sets(body)) {
      (void)tables.test_points.read(set);
    }
  }
  for (const auto& [body, models] : tables.reduced_models) models.check();
  Damage& damage = tables.connection.damage();
  if (damage.size() == 0) return {};
  tables.connection.before_change();
  Transaction transaction(tables.connection.database());
  damage.remove_from(tables.connection.database());
  if (damage.is_in("intermediate")) tables.configurations.remove_without_way();
  transaction.commit();
  std::vector<std::string> names = damage.names();
  damage.clear();
  tables.tool_spaces.forget();
  tables.bases.forget_all();
  return names;
}

void merge(Tables& here, const Tables& other) {
  const std::map<BodyId, BodyId> bodies = match_bodies(here, other);
  if (other.bases.keep() != Keep::all) {
    throw InputError(quoted(other.connection.path()) + " cannot be merged into " +
                     quoted(here.connection.path()) +
                     ": it is a finished space, whose fields are reduced. Leave it out.");
  }
  for (const ToolSpace& space : other.tool_spaces.read_all()) {
    ToolSpaceSetup setup = space.setup;
    setup.body = bodies.at(setup.body);
    if (const std::optional<ToolSpace> there = here.tool_spaces.find(setup.key())) {
      require_extension(other.connection.path(), setup, there->setup);
    } else {
      add_tool_space(here, setup);
    }
  }
  for (const ToolSpace& space : other.tool_spaces.read_all()) {
    const ToolSpaceKey there = space.setup.key();
    const ToolSpaceKey key{there.id, bodies.at(there.body)};
    Transaction transaction(here.connection.database());
    const std::set<CheckPoint> taken = here.configurations.merge(key, other.configurations, there);
    here.transitions.merge(key, other.transitions, there);
    here.intermediate_states.merge(key, other.intermediate_states, there, taken);
    transaction.commit();
  }
  {
    Transaction transaction(here.connection.database());
    for (const auto& [there, body] : bodies) {
      here.test_points.merge(body, other.test_points, there);
    }
    transaction.commit();
  }
  here.connection.checkpoint();
}

void convert(Tables& tables) {
  const sqlite::Database& database = tables.connection.database();
  show_as_this_version(database, tables.connection.version());
  const std::function<void()> write_again[] = {
      tables.tool_spaces.read_for_conversion(), tables.configurations.read_for_conversion(),
      tables.intermediate_states.read_for_conversion(), tables.bases.read_for_conversion()};
  show_as_it_is(database);
  Transaction transaction(database);
  convert_schema(database, tables.connection.version());
  for (const std::function<void()>& write : write_again) write();
  transaction.commit();
  tables.connection.set_version(kSchemaVersion);
  // These two were made anew, without the rows that are damaged.
  for (const char* table : {"tool_space", "basis"}) tables.connection.damage().leave_behind(table);
  tables.tool_spaces.forget();
  tables.bases.forget_all();
}

}  // namespace palpate::storage
