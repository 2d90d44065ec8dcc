// SPDX-License-Identifier: BSD-3-Clause
#include "storage/mesh_errors.h"

#include <algorithm>
#include <string>

#include "storage/rows.h"
#include "storage/schema.h"

namespace palpate::storage {

bool MeshErrors::is_there() const { return has_table(connection_.database(), table_.name()); }

void MeshErrors::add(const ToolSpaceKey& key, const ConfigurationSummary& configuration) {
  if (!configuration.mesh_error.is_known()) {
    if (is_there()) remove(key, configuration);
    return;
  }
  make_table(connection_.database(), table_.name());
  Statement insert(connection_.database(), table_.insert());
  bind(key, insert);
  rows::for_each_number_of_mesh_error_row(configuration, rows::Bind{insert});
  insert.bind(rows::checksum_of_mesh_error(key, configuration));
  insert.run();
}

void MeshErrors::remove(const ToolSpaceKey& key, const ConfigurationSummary& configuration) {
  Statement statement(connection_.database(), std::string("DELETE FROM mesh_error") + kAtKey);
  bind_key(key, configuration.check_point, configuration.level, statement);
  statement.run();
}

void MeshErrors::settle(const ToolSpaceKey& key, const ConfigurationSummary& candidate,
                        std::int32_t level) {
  if (!is_there()) return;
  remove(key, candidate);
  if (level < 0) return;
  ConfigurationSummary settled = candidate;
  settled.level = level;
  add(key, settled);
}

void MeshErrors::set(const ToolSpaceKey& key, std::vector<Configuration>& configurations) const {
  if (!is_there()) return;
  const auto name = [&](const ConfigurationSummary& c) {
    return "error of the mesh at " + describe(c, tool_spaces_.name_of(key));
  };
  const auto take = [&](Statement& select, ConfigurationSummary& c) {
    bool sound = true;
    rows::for_each_number_of_mesh_error_row(c, rows::Take{select, sound});
    return sound && select.take_integer() == rows::checksum_of_mesh_error(key, c) &&
           c.mesh_error.is_known() && c.mesh_error.force.allFinite();
  };
  const std::string columns = table_.columns("i", "checksum") + ", checksum";
  for (const auto& error : read_rows<ConfigurationSummary>(key, columns, "true", take, name)) {
    const auto found = std::lower_bound(configurations.begin(), configurations.end(), error);
    if (found != configurations.end() && !(error < *found)) found->mesh_error = error.mesh_error;
  }
}

}  // namespace palpate::storage
