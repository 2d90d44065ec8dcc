// SPDX-License-Identifier: BSD-3-Clause
#include "storage/state_space_file.h"

#include <utility>

#include "base/error.h"
#include "base/new_file.h"
#include "base/printable.h"
#include "state_space/space_hash.h"
#include "storage/open_file.h"
#include "storage/schema.h"
#include "storage/tables.h"
#include "storage/versions.h"

namespace palpate {
namespace fs = std::filesystem;
using storage::Tables;

StateSpaceFile::StateSpaceFile(std::unique_ptr<Tables> tables) : tables_(std::move(tables)) {}
StateSpaceFile::StateSpaceFile(StateSpaceFile&&) noexcept = default;
StateSpaceFile& StateSpaceFile::operator=(StateSpaceFile&&) noexcept = default;

StateSpaceFile::~StateSpaceFile() {
  try {
    if (tables_) close();
  } catch (const std::exception&) {
    // The log is left beside the file, and is taken up when it is opened again.
  }
}

StateSpaceFile StateSpaceFile::create(const fs::path& path, const Scene& scene,
                                      double solver_tolerance, const SettledBody& at_rest) {
  const fs::path target = without_links(path);
  if (fs::exists(target) || !storage::make_file(target, scene, at_rest, solver_tolerance)) {
    throw InputError(quoted(path) + " is there already. Open it to append, or give another file " +
                     "name.");
  }
  return open_to_append(target, scene, solver_tolerance);
}

StateSpaceFile StateSpaceFile::open_to_append(const fs::path& path, const Scene& scene,
                                              double solver_tolerance) {
  StateSpaceFile file(std::make_unique<Tables>(storage::open_exclusively(path)));
  Tables& tables = *file.tables_;
  const BodyId body = storage::find_body(tables, scene, solver_tolerance);
  storage::Connection& connection = tables.connection;
  connection.begin_to_write();
  // The file is there, and no other writer has it.
  remove_unfinished(connection.path());
  connection.before_change();
  if (connection.version() < storage::kSchemaVersion) storage::convert(tables);
  // What may be touched is no part of the hash, and may have changed since.
  tables.bodies.set_touchable(body, scene.body.touchable);
  return file;
}

StateSpaceFile StateSpaceFile::open_or_create(const fs::path& path, const Scene& scene,
                                              double solver_tolerance, const SettledBody& at_rest) {
  const fs::path target = without_links(path);
  // If another run creates the file first, the file is opened like one that existed before.
  if (!fs::exists(target)) (void)storage::make_file(target, scene, at_rest, solver_tolerance);
  return open_to_append(target, scene, solver_tolerance);
}

StateSpaceFile StateSpaceFile::open_read_only(const fs::path& path) {
  auto tables = std::make_unique<Tables>(storage::open_to_read(path));
  storage::show_as_this_version(tables->connection.database(), tables->connection.version());
  return StateSpaceFile(std::move(tables));
}

bool StateSpaceFile::is_being_written(const fs::path& path) {
  return storage::has_log(without_links(path));
}

void StateSpaceFile::require(const Scene& scene, double solver_tolerance) const {
  (void)storage::find_body(*tables_, scene, solver_tolerance);
}

void StateSpaceFile::close() {
  const std::unique_ptr<Tables> tables = std::move(tables_);
  tables->configurations.release();
  tables->connection.close();
}

void StateSpaceFile::shrink() { storage::shrink(*tables_); }

void StateSpaceFile::change_together(const std::function<void()>& body) {
  storage::change_together(tables_->connection, body);
}

const fs::path& StateSpaceFile::path() const { return tables_->connection.path(); }

double StateSpaceFile::solver_tolerance() const { return tables_->bodies.solver_tolerance(); }

std::vector<std::string> StateSpaceFile::left_out() const {
  return storage::list_left_out(*tables_);
}

std::vector<std::string> StateSpaceFile::remove_damaged() {
  return storage::remove_damaged(*tables_);
}

BodyId StateSpaceFile::add_body(const Scene& scene, const SettledBody& at_rest) {
  return storage::add_body(*tables_, scene, hash(scene), at_rest);
}

BodyId StateSpaceFile::add_body(const SpaceBody& body) {
  return storage::add_body(*tables_, *body.scene, body.hash, body.at_rest);
}

void StateSpaceFile::require_size(const Scene& scene) { storage::Bodies::require_size(scene); }

std::vector<BodyId> StateSpaceFile::list_bodies() const { return tables_->bodies.list(); }

std::optional<BodyId> StateSpaceFile::find_body(const std::string& scene_hash) const {
  return tables_->bodies.find(scene_hash);
}

const std::string& StateSpaceFile::scene_hash(BodyId body) const {
  return tables_->bodies.head(body).hash;
}

std::string StateSpaceFile::scene_hashes() const {
  std::vector<std::string> hashes;
  for (const BodyId body : list_bodies()) hashes.push_back(scene_hash(body));
  return join_hashes(hashes);
}

Scene StateSpaceFile::read_scene(BodyId body) const { return tables_->bodies.read(body); }

const SettledBody& StateSpaceFile::read_rest(BodyId body) const {
  return tables_->bodies.settled(body);
}

std::vector<SpaceBody> StateSpaceFile::read_bodies() const { return tables_->bodies.read_all(); }

void StateSpaceFile::add_tool_space(const ToolSpaceSetup& setup) {
  storage::add_tool_space(*tables_, setup);
}

void StateSpaceFile::set_complete(const ToolSpaceKey& key, bool complete) {
  tables_->tool_spaces.set_complete(key, complete);
}

std::vector<ToolSpace> StateSpaceFile::read_tool_spaces() const {
  return tables_->tool_spaces.read_all();
}

void StateSpaceFile::add(const ToolSpaceKey& key, const Configuration& configuration,
                         const std::vector<IntermediateState>& way) {
  storage::add_with_way(*tables_, key, configuration, way);
}

void StateSpaceFile::add(const ToolSpaceKey& key, const ConfigurationSummary& summary,
                         const ReducedFields& reduced) {
  tables_->configurations.add(key, summary, reduced);
}

std::vector<Configuration> StateSpaceFile::read_summaries(const ToolSpaceKey& key) const {
  return storage::read_summaries(*tables_, key);
}

std::vector<Configuration> StateSpaceFile::read_candidates(const ToolSpaceKey& key) const {
  return tables_->configurations.read_candidates(key);
}

void StateSpaceFile::settle(const ToolSpaceKey& key, const ConfigurationSummary& candidate,
                            std::int32_t level) {
  tables_->configurations.settle(key, candidate, level);
}

bool StateSpaceFile::is_of_use(const ToolSpaceKey& key, const ConfigurationSummary& other) const {
  return tables_->configurations.is_of_use(key, other);
}

bool StateSpaceFile::read_fields(const ToolSpaceKey& key, Configuration& configuration) const {
  return tables_->configurations.read_fields(key, configuration);
}

bool StateSpaceFile::read_stored(const ToolSpaceKey& key, const ConfigurationSummary& summary,
                                 StoredFields& stored) const {
  return tables_->configurations.read_stored(key, summary, stored);
}

std::vector<StateKey> StateSpaceFile::list_whole(const ToolSpaceKey& key) const {
  return tables_->configurations.list_whole(key);
}

Keep StateSpaceFile::keep_of(const ToolSpaceKey& key, const ConfigurationSummary& summary) const {
  return tables_->configurations.keep_of(key, summary);
}

void StateSpaceFile::add(const ToolSpaceKey& key, const LevelTransition& transition) {
  tables_->transitions.add(key, transition);
}

std::vector<LevelTransition> StateSpaceFile::read_transitions(const ToolSpaceKey& key) const {
  return tables_->transitions.read(key);
}

std::vector<LevelTransition> StateSpaceFile::read_linked_transitions(
    const ToolSpaceKey& key, const std::vector<Configuration>& configurations) const {
  return tables_->transitions.read_linked(key, configurations);
}

void StateSpaceFile::add(const ToolSpaceKey& key, const IntermediateState& state) {
  tables_->intermediate_states.add(key, state);
}

std::vector<IntermediateState> StateSpaceFile::read_intermediate_states(
    const ToolSpaceKey& key) const {
  return tables_->intermediate_states.read(key);
}

storage::Bases& StateSpaceFile::bases() { return tables_->bases; }
const storage::Bases& StateSpaceFile::bases() const { return tables_->bases; }

void StateSpaceFile::share(Known& known) {
  tables_->bases.share(known.bases);
  tables_->bodies.share(known.num_pressures);
}

storage::TestPoints& StateSpaceFile::test_points() { return tables_->test_points; }
const storage::TestPoints& StateSpaceFile::test_points() const { return tables_->test_points; }

storage::ReducedModels& StateSpaceFile::reduced_models(BodyId body) {
  return tables_->reduced_models.at(tables_->bodies.head(body).number);
}
const storage::ReducedModels& StateSpaceFile::reduced_models(BodyId body) const {
  return tables_->reduced_models.at(tables_->bodies.head(body).number);
}

StateSpace StateSpaceFile::read(bool with_fields) const {
  return storage::read_space(*tables_, with_fields);
}

std::vector<std::string> StateSpaceFile::merge(const fs::path& other_path) {
  const StateSpaceFile other = open_read_only(other_path);
  storage::merge(*tables_, *other.tables_);
  return other.left_out();
}

}  // namespace palpate
