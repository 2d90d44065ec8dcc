// SPDX-License-Identifier: BSD-3-Clause
#include "storage/configurations.h"

#include <map>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/printable.h"
#include "storage/rows.h"
#include "storage/stored_kind.h"

namespace palpate::storage {
namespace {

using sqlite::Statement;

/// Resets a statement at the end of the scope, so that it is ready for the next use.
struct Reset {
  Statement& statement;
  ~Reset() { statement.reset(); }
};

}  // namespace

bool Configurations::fit(BodyId body, const rows::Fields& fields) const {
  return rows::fit(fields, bodies_.num_points(body),
                   fields[2].bytes > 0 ? bodies_.num_pressures(body) : 0);
}

std::int64_t Configurations::bytes_of_whole(BodyId body) const {
  return bodies_.num_points(body) * 3 * static_cast<std::int64_t>(sizeof(float));
}

void Configurations::add(const ToolSpaceKey& key, const Configuration& configuration) {
  rows::SingleFields single;
  const bool is_single = kind_of(key.id).has_single_fields();
  if (is_single) single = rows::single_fields_of(configuration);
  const rows::Fields fields = is_single ? rows::fields_of(single) : rows::fields_of(configuration);
  connection_.before_change();
  if (!fit(key.body, fields)) {
    throw InputError("Configuration " + describe(configuration.check_point) + " of " +
                     tool_spaces_.name_of(key) + " has fields of another size than the body of " +
                     std::to_string(bodies_.num_points(key.body)) + " points.");
  }
  insert(key, configuration, fields);
  if (connection_.database().changes() == 0) {
    throw InputError(quoted(connection_.path()) + " has no " + tool_spaces_.name_of(key) +
                     ". Add it first.");
  }
  mesh_errors_.add(key, configuration);
  turns_.add(key, configuration);
}

void Configurations::add(const ToolSpaceKey& key, const ConfigurationSummary& summary,
                         const ReducedFields& reduced) {
  connection_.before_change();
  insert(key, summary, rows::fields_of(reduced));
  mesh_errors_.add(key, summary);
  turns_.add(key, summary);
}

void Configurations::insert(const ToolSpaceKey& key, const ConfigurationSummary& summary,
                            const rows::Fields& fields) {
  if (!insert_) {
    // Select from the table of tool spaces, so that nothing is stored for a tool space that is not
    // there.
    insert_.emplace(connection_.database(),
                    table_.insert_into() + " SELECT " + table_.parameters() +
                        " FROM tool_space WHERE scene_id = ?1 AND tool_space_id = ?2");
  }
  bind(key, *insert_);
  for_each_number_of_summary(summary, rows::Bind{*insert_});
  const std::int64_t of_fields = rows::checksum(fields);
  insert_->bind(rows::checksum(key, summary, of_fields));
  insert_->bind(of_fields);
  for (const auto& [data, bytes] : fields) insert_->bind(data, bytes);
  insert_->run();
}

void Configurations::rewrite(const ToolSpaceKey& key, std::int32_t level,
                             const ConfigurationSummary& summary) const {
  const sqlite::Database& database = connection_.database();
  std::int64_t of_fields = 0;
  {
    Statement select(database, std::string("SELECT checksum FROM configuration") + kAtKey);
    bind_key(key, summary.check_point, level, select);
    if (!select.step()) return;
    of_fields = select.take_integer();
  }
  Statement update(database,
                   std::string("UPDATE configuration SET level = ?, flags = ?, summary_checksum = "
                               "?") +
                       kAtKey);
  update.bind(std::int64_t{summary.level});
  update.bind(std::int64_t{summary.flags});
  update.bind(rows::checksum(key, summary, of_fields));
  bind_key(key, summary.check_point, level, update);
  update.run();
}

std::vector<Configuration> Configurations::read_where(const ToolSpaceKey& key,
                                                      const std::string& condition) const {
  const std::optional<ToolSpace> space = tool_spaces_.find(key);
  if (!space) return {};
  std::vector<Configuration> configurations = read_rows<Configuration>(
      key, table_.columns("i", "summary_checksum") + ", checksum, summary_checksum", condition,
      [&](Statement& select, Configuration& c) {
        bool sound = true;
        for_each_number_of_summary(c, rows::Take{select, sound});
        const std::int64_t of_fields = select.take_integer();
        const std::int64_t stored = select.take_integer();
        return sound && stored == rows::checksum(key, c, of_fields, connection_.checked()) &&
               rows::is_possible(space->setup.grid, c);
      },
      [&](const Configuration& c) { return describe(c, space->setup.name()); });
  mesh_errors_.set(key, configurations);
  turns_.set(key, configurations);
  return configurations;
}

std::vector<Configuration> Configurations::read_all(const ToolSpaceKey& key) const {
  return read_where(key, "true");
}

std::vector<Configuration> Configurations::read_settled(const ToolSpaceKey& key) const {
  return read_where(key, "level >= 0");
}

std::vector<Configuration> Configurations::read_candidates(const ToolSpaceKey& key) const {
  return read_where(key, "level < 0");
}

void Configurations::settle(const ToolSpaceKey& key, const ConfigurationSummary& candidate,
                            std::int32_t level) {
  connection_.before_change();
  mesh_errors_.settle(key, candidate, level);
  if (level < 0) {
    Statement remove(connection_.database(), std::string("DELETE FROM configuration") + kAtKey);
    bind_key(key, candidate.check_point, candidate.level, remove);
    return remove.run();
  }
  ConfigurationSummary settled = candidate;
  settled.level = level;
  rewrite(key, candidate.level, settled);
}

void Configurations::mark(const ToolSpaceSetup& setup) {
  for (Configuration& c : read_all(setup.key())) {
    const Flags flags = setup.policy.marked(c.flags, c.force);
    if (flags == c.flags) continue;
    c.flags = flags;
    rewrite(setup.key(), c.level, c);
  }
}

bool Configurations::read_fields(const ToolSpaceKey& key, Configuration& configuration) const {
  StoredFields stored;
  if (!read_stored(key, configuration, stored)) return false;
  if (stored.basis != nullptr) {
    expand(*stored.basis, stored.reduced, bodies_.points_of(key.body, stored.basis->keep),
           static_cast<Index>(bodies_.num_points(key.body)), configuration);
    count_from_mesh(bodies_.settled(key.body), configuration);
    return true;
  }
  configuration.u = std::move(stored.whole.u);
  configuration.v = std::move(stored.whole.v);
  configuration.p = std::move(stored.whole.p);
  configuration.p_v = std::move(stored.whole.p_v);
  return true;
}

bool Configurations::read_stored(const ToolSpaceKey& key, const ConfigurationSummary& configuration,
                                 StoredFields& stored) const {
  const auto which = [&] { return describe(configuration, tool_spaces_.name_of(key)); };
  std::shared_ptr<const FieldBasis> basis = bases_.serving(key, configuration.check_point);
  bool is_there = true;
  std::int64_t row = 0;
  try {
    if (!select_fields_) {
      select_fields_.emplace(connection_.database(), "SELECT rowid, " + table_.columns("i", "u") +
                                                         ", u, v, p, p_v FROM configuration" +
                                                         kAtKey);
    }
    Statement& select = *select_fields_;
    const Reset reset{select};
    bind_key(key, configuration.check_point, configuration.level, select);
    is_there = select.step();
    if (!is_there) throw InputError(quoted(connection_.path()) + " holds no " + which() + '.');
    row = select.take_integer();
    bool sound = true;
    ConfigurationSummary summary;
    for_each_number_of_summary(summary, rows::Take{select, sound});
    const std::int64_t of_summary = select.take_integer();
    const std::int64_t of_fields = select.take_integer();
    rows::Fields fields;
    for (Statement::Blob& field : fields) field = select.take_blob();
    if (sound && rows::checksum(fields) == of_fields &&
        rows::checksum(key, summary, of_fields, connection_.checked()) == of_summary) {
      const std::int64_t num_points = bodies_.num_points(key.body);
      const bool has_fields = fields[0].bytes > 0;
      if (has_fields && basis != nullptr && rows::fit_basis(fields, *basis, num_points)) {
        stored.basis = std::move(basis);
        stored.reduced = rows::reduced_of(fields);
        if (rows::is_finite(stored.reduced)) return true;
      } else if (fit(key.body, fields)) {
        rows::set_fields(fields, num_points, stored.whole);
        if (rows::is_finite(stored.whole)) return true;
      }
    }
  } catch (const InputError&) {
    // A row that is there either cannot be read, or is larger than the fields of this body.
    if (!is_there) throw;
  }
  connection_.damage().leave_out(which(), table_.name(), row);
  return false;
}

std::vector<StateKey> Configurations::list_whole(const ToolSpaceKey& key) const {
  Statement select(connection_.database(),
                   "SELECT i, j, k, level FROM configuration WHERE scene_id = ? AND tool_space_id "
                   "= ? AND level >= 0 AND outcome = 0 AND length(u) >= ? ORDER BY i, j, k, level");
  bind(key, select);
  select.bind(bytes_of_whole(key.body));
  std::vector<StateKey> keys;
  while (select.step()) {
    StateKey& found = keys.emplace_back();
    found.tool_space = key;
    for (auto& x : found.check_point) x = static_cast<std::int32_t>(select.take_integer());
    found.level = static_cast<std::int32_t>(select.take_integer());
  }
  return keys;
}

Keep Configurations::keep_of(const ToolSpaceKey& key, const ConfigurationSummary& summary) const {
  const std::optional<Keep> of_basis = bases_.keep_at(key, summary.check_point);
  if (!of_basis) return Keep::all;
  Statement select(connection_.database(),
                   std::string("SELECT length(u) FROM configuration") + kAtKey);
  bind_key(key, summary.check_point, summary.level, select);
  const bool is_whole = !select.step() || select.take_integer() >= bytes_of_whole(key.body);
  return is_whole ? Keep::all : *of_basis;
}

bool Configurations::is_of_use(const ToolSpaceKey& key, const ConfigurationSummary& other) const {
  if (!select_outcome_) {
    select_outcome_.emplace(connection_.database(),
                            std::string("SELECT outcome FROM configuration") + kAtKey);
  }
  Statement& select = *select_outcome_;
  const Reset reset{select};
  bind_key(key, other.check_point, other.level, select);
  if (!select.step()) return true;
  return static_cast<Outcome>(select.take_integer()) != Outcome::converged && other.usable();
}

void Configurations::remove_without_way() {
  connection_.database().execute(
      "DELETE FROM configuration AS c WHERE level = 0 AND outcome = 0 AND (i <> 0 OR j <> 0 OR k "
      "<> 0) AND (SELECT count(*) FROM intermediate AS w WHERE w.scene_id = c.scene_id AND "
      "w.tool_space_id = c.tool_space_id AND w.i = c.i AND w.j = c.j AND w.k = c.k) <> (SELECT "
      "intermediate_states FROM tool_space AS s WHERE s.scene_id = c.scene_id AND "
      "s.tool_space_id = c.tool_space_id)");
}

std::set<CheckPoint> Configurations::merge(const ToolSpaceKey& key, const Configurations& other,
                                           const ToolSpaceKey& there) {
  std::set<CheckPoint> taken;
  for (Configuration& c : other.read_all(there)) {
    // A configuration that is of no use here need not be sound in the other file.
    if (!is_of_use(key, c) || !other.read_fields(there, c)) continue;
    add(key, c);
    if (c.level == 0) taken.insert(c.check_point);
  }
  return taken;
}

std::function<void()> Configurations::read_for_conversion() {
  std::vector<std::pair<ToolSpaceKey, Configuration>> all;
  if (connection_.checked() == rows::Checked::as_version_5) {
    for (const ToolSpace& space : tool_spaces_.read_all()) {
      for (Configuration& c : read_all(space.setup.key())) {
        all.emplace_back(space.setup.key(), std::move(c));
      }
    }
  }
  return [this, all = std::move(all)] {
    for (const auto& [key, c] : all) rewrite(key, c.level, c);
  };
}

void Configurations::release() {
  insert_.reset();
  select_fields_.reset();
  select_outcome_.reset();
}

}  // namespace palpate::storage
