// SPDX-License-Identifier: BSD-3-Clause
// The table configuration: what was found in the tool spaces of a file.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "storage/bases.h"
#include "storage/mesh_errors.h"
#include "storage/tool_space_rows.h"
#include "storage/turn_derivatives.h"

namespace palpate::storage {

class Configurations : private ToolSpaceRows {
 public:
  Configurations(Connection& connection, const Bodies& bodies, const ToolSpaces& tool_spaces,
                 const Bases& bases)
      : ToolSpaceRows(connection, tool_spaces, "configuration"),
        bodies_(bodies),
        bases_(bases),
        mesh_errors_(connection, tool_spaces),
        turns_(connection, tool_spaces) {}

  /// Adds a configuration to a tool space, in place of one with the same check-point and level.
  /// @throws InputError there is no such tool space, or a field has a size that is not the body's;
  ///   all may be empty.
  void add(const ToolSpaceKey& key, const Configuration& configuration);
  /// Adds a configuration with its fields by the modes of the basis that serves its check-point, in
  /// place of one with the same check-point and level.
  void add(const ToolSpaceKey& key, const ConfigurationSummary& summary,
           const ReducedFields& reduced);

  /// All configurations of a tool space without fields, of all levels, in the order of operator<.
  [[nodiscard]] std::vector<Configuration> read_all(const ToolSpaceKey& key) const;
  /// The configurations that have a level, in contrast to candidates.
  [[nodiscard]] std::vector<Configuration> read_settled(const ToolSpaceKey& key) const;
  /// The candidates: configurations that transitions have found, and that settle() has given no
  /// level yet.
  [[nodiscard]] std::vector<Configuration> read_candidates(const ToolSpaceKey& key) const;
  /// Gives a candidate its level, or removes it.
  /// @param level Below zero: the candidate is removed, as it is a configuration that is known.
  void settle(const ToolSpaceKey& key, const ConfigurationSummary& candidate, std::int32_t level);
  /// Sets the flag of the configurations that are beyond the force limit, and clears it in all
  /// others.
  void mark(const ToolSpaceSetup& setup);

  /// Fills in the fields u, v, p and p_v of a configuration: what is kept of them, and zero
  /// elsewhere.
  /// @returns False where the fields are damaged, or hold what is no number; then they are left
  ///   out.
  [[nodiscard]] bool read_fields(const ToolSpaceKey& key, Configuration& configuration) const;
  /// Reads the fields as they are stored.
  /// @returns False where they are damaged; then they are left out.
  [[nodiscard]] bool read_stored(const ToolSpaceKey& key, const ConfigurationSummary& summary,
                                 StoredFields& stored) const;
  /// The usable configurations of a tool space whose fields are whole, in the order of operator<.
  [[nodiscard]] std::vector<StateKey> list_whole(const ToolSpaceKey& key) const;
  /// The part of the fields that is kept for a configuration.
  [[nodiscard]] Keep keep_of(const ToolSpaceKey& key, const ConfigurationSummary& summary) const;
  /// Whether a configuration of another file is worth taking over: none with its key is here, or
  /// the one that is here did not converge while the other one did.
  [[nodiscard]] bool is_of_use(const ToolSpaceKey& key, const ConfigurationSummary& other) const;

  /// Removes the configurations of which an intermediate state is missing, so that they are
  /// computed again together with all states on the way to them.
  void remove_without_way();
  /// Takes over the configurations of another file that are of use here.
  /// @param there The key of the tool space in that file.
  /// @returns The check-points whose level 0 was taken over.
  std::set<CheckPoint> merge(const ToolSpaceKey& key, const Configurations& other,
                             const ToolSpaceKey& there);
  /// Finds the rows whose checksum differs between the versions of the schema.
  /// @returns A function that writes their checksums again, after the schema of the file was
  ///   converted.
  [[nodiscard]] std::function<void()> read_for_conversion();

  /// Finalises the prepared statements, so that the file can be closed.
  void release();

 private:
  [[nodiscard]] std::vector<Configuration> read_where(const ToolSpaceKey& key,
                                                      const std::string& condition) const;
  /// Replaces the numbers of a row, and keeps its fields.
  /// @param level The level under which the row is stored now.
  void rewrite(const ToolSpaceKey& key, std::int32_t level,
               const ConfigurationSummary& summary) const;
  /// Inserts a row, in place of one with the same key.
  void insert(const ToolSpaceKey& key, const ConfigurationSummary& summary,
              const rows::Fields& fields);
  /// Whether fields that are whole have the sizes of the body.
  [[nodiscard]] bool fit(BodyId body, const rows::Fields& fields) const;
  /// The least size of a displacement that is stored as a whole, bytes. Coefficients of modes take
  /// less, by which the two are told apart.
  [[nodiscard]] std::int64_t bytes_of_whole(BodyId body) const;

  const Bodies& bodies_;
  const Bases& bases_;
  MeshErrors mesh_errors_;
  TurnDerivatives turns_;
  /// This statement is prepared at its first use.
  std::optional<sqlite::Statement> insert_;
  mutable std::optional<sqlite::Statement> select_fields_;
  mutable std::optional<sqlite::Statement> select_outcome_;
};

}  // namespace palpate::storage
