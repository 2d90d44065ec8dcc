// SPDX-License-Identifier: BSD-3-Clause
#include "storage/turn_derivatives.h"

#include <algorithm>
#include <string>

#include "storage/rows.h"
#include "storage/schema.h"

namespace palpate::storage {

bool TurnDerivatives::is_there() const { return has_table(connection_.database(), table_.name()); }

void TurnDerivatives::add(const ToolSpaceKey& key, const ConfigurationSummary& configuration) {
  if (configuration.of_turns.empty()) {
    if (!is_there()) return;
    Statement remove(connection_.database(), "DELETE FROM turn_derivative" + std::string(kAtKey));
    bind_key(key, configuration.check_point, configuration.level, remove);
    remove.run();
    return;
  }
  make_table(connection_.database(), table_.name());
  Statement insert(connection_.database(), table_.insert());
  bind(key, insert);
  rows::for_each_number_of_turn_row(configuration, rows::Bind{insert});
  insert.bind(rows::checksum_of_turns(key, configuration));
  insert.run();
}

void TurnDerivatives::set(const ToolSpaceKey& key,
                          std::vector<Configuration>& configurations) const {
  if (!is_there()) return;
  const auto name = [&](const ConfigurationSummary& c) {
    return "derivatives by turns at " + describe(c, tool_spaces_.name_of(key));
  };
  const auto take = [&](Statement& select, ConfigurationSummary& c) {
    bool sound = true;
    rows::for_each_number_of_turn_row(c, rows::Take{select, sound});
    return sound && select.take_integer() == rows::checksum_of_turns(key, c);
  };
  const std::string columns = table_.columns("i", "checksum") + ", checksum";
  for (auto& read : read_rows<ConfigurationSummary>(key, columns, "true", take, name)) {
    const auto found = std::lower_bound(configurations.begin(), configurations.end(), read);
    if (found != configurations.end() && !(read < *found)) {
      found->of_turns = std::move(read.of_turns);
    }
  }
}

}  // namespace palpate::storage
