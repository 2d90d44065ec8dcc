// SPDX-License-Identifier: BSD-3-Clause
// The tool spaces of a file without what was found in them: the tables tool_space, contact_offset,
// tool_motion and mesh_region.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "state_space/state_space.h"
#include "storage/bodies.h"
#include "storage/connection.h"
#include "storage/table.h"

namespace palpate::storage {

class ToolSpaces {
 public:
  ToolSpaces(Connection& connection, const Bodies& bodies);

  /// Checks a tool space. @throws InputError it cannot be stored.
  void check(const ToolSpaceSetup& setup) const;
  /// Adds a tool space that is not there.
  /// @throws InputError there would be more check-points than a state space may have.
  void add(const ToolSpaceSetup& setup);
  /// Writes a tool space, in place of the one with its key.
  void write(const ToolSpace& space);
  void set_complete(const ToolSpaceKey& key, bool complete);

  /// The tool spaces of all bodies in the order of their keys, without configurations.
  [[nodiscard]] const std::vector<ToolSpace>& read_all() const;
  [[nodiscard]] std::optional<ToolSpace> find(const ToolSpaceKey& key) const;
  /// The name of a tool space, for a message.
  [[nodiscard]] std::string name_of(const ToolSpaceKey& key) const;

  /// Reads all tool spaces.
  /// @returns A function that writes them again, after the schema of the file was converted.
  [[nodiscard]] std::function<void()> read_for_conversion();
  /// Forgets what was read.
  void forget() const { known_.reset(); }

 private:
  /// The offset of the contact layer of a rigid tool, m.
  [[nodiscard]] double contact_offset(const ToolSpaceKey& key) const;
  /// Sets how a rigid tool is moved. @returns Whether what is stored of it is sound.
  bool take_motion(const ToolSpaceKey& key, RigidTool& tool) const;
  /// The region in which a tool space serves; nothing: everywhere.
  [[nodiscard]] std::optional<MeshRegion> mesh_region(const ToolSpaceKey& key) const;
  /// Writes the row of a tool space in an optional table.
  void write_optional(const char* table, const ToolSpaceKey& key,
                      const std::function<void(sqlite::Statement&)>& bind_numbers);
  void read_into(BodyId body, std::vector<ToolSpace>& tool_spaces) const;

  Connection& connection_;
  const Bodies& bodies_;
  Table table_{"tool_space"};
  /// The tool spaces of all bodies; nothing: they were not read yet, or have changed since.
  mutable std::optional<std::vector<ToolSpace>> known_;
  mutable bool is_tentative_ = false;
};

/// Checks that a stored tool space can be extended to the one that is asked for.
/// @throws InputError it cannot.
/// @param path The file that holds it.
void require_extension(const std::filesystem::path& path, const ToolSpaceSetup& there,
                       const ToolSpaceSetup& asked);

}  // namespace palpate::storage
