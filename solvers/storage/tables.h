// SPDX-License-Identifier: BSD-3-Clause
// The tables of an open file, with one class for each family of tables, and the functions that
// concern several families.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "state_space/state_space.h"
#include "storage/bases.h"
#include "storage/bodies.h"
#include "storage/configurations.h"
#include "storage/connection.h"
#include "storage/reduced_models.h"
#include "storage/test_points.h"
#include "storage/tool_spaces.h"
#include "storage/transitions.h"

namespace palpate::storage {

struct Tables {
  /// @throws InputError the file has no body, or a body that cannot be one.
  explicit Tables(sqlite::Database opened);

  Connection connection;
  Bodies bodies{connection};
  ToolSpaces tool_spaces{connection, bodies};
  Bases bases{connection, bodies, tool_spaces};
  Configurations configurations{connection, bodies, tool_spaces, bases};
  Transitions transitions{connection, tool_spaces};
  IntermediateStates intermediate_states{connection, tool_spaces};
  TestPoints test_points{connection, tool_spaces};
  /// By body.
  std::map<BodyId, ReducedModels> reduced_models;
};

/// The number of the body that has this scene.
/// @throws InputError the file has no such body, or was made for another tolerance.
BodyId find_body(const Tables& tables, const Scene& scene, double solver_tolerance);

/// Adds a body of the organ, unless it is there. @throws InputError as Bodies::add() does.
BodyId add_body(Tables& tables, const Scene& scene, const std::string& scene_hash,
                const SettledBody& at_rest);

/// Runs `body` in one transaction: its changes become durable together, or not at all if it throws.
void change_together(Connection& connection, const std::function<void()>& body);

/// Makes the file smaller by the pages that are free in it, if that is worth the time.
void shrink(const Tables& tables);

/// Adds a tool space, or extends the one that is there; then it is no longer complete, and what was
/// found is marked by the new force limit.
/// @throws InputError it cannot be stored, or not become what is asked for.
void add_tool_space(Tables& tables, const ToolSpaceSetup& setup);

/// Adds a configuration with the states on the way to it: they are there as soon as it is.
void add_with_way(Tables& tables, const ToolSpaceKey& key, const Configuration& configuration,
                  const std::vector<IntermediateState>& way);

/// All configurations of a tool space that have their level, with what transitions from them have
/// reached, without fields.
[[nodiscard]] std::vector<Configuration> read_summaries(const Tables& tables,
                                                        const ToolSpaceKey& key);

/// Reads everything but test points and reduced models.
[[nodiscard]] StateSpace read_space(const Tables& tables, bool with_fields);

/// What was found damaged in all that was read so far, and rows that belong to nothing.
[[nodiscard]] std::vector<std::string> list_left_out(const Tables& tables);
/// Reads everything and removes what is damaged. @returns What it was.
/// @throws InputError the damage is such that it cannot be told row by row.
std::vector<std::string> remove_damaged(Tables& tables);

/// Takes over what another file has of the same bodies; it is durable when this returns.
/// @throws InputError another body or tolerance, another grid or tool of the same tool space, or
///   reduced fields.
void merge(Tables& here, const Tables& other);

/// Makes the tables of an older version those of this one. A tool space or a basis that is damaged
/// is left behind; other rows that are damaged stay so, as their checksums are not made anew.
void convert(Tables& tables);

}  // namespace palpate::storage
