// SPDX-License-Identifier: BSD-3-Clause
// What was found in the tool spaces of a file: the table configuration.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "storage/bases.h"
#include "storage/tool_space_rows.h"

namespace palpate::storage {

class Configurations : private ToolSpaceRows {
 public:
  Configurations(Connection& connection, const Bodies& bodies, const ToolSpaces& tool_spaces,
                 const Bases& bases)
      : ToolSpaceRows(connection, tool_spaces, "configuration"), bodies_(bodies), bases_(bases) {}

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
  /// Those that have their level.
  [[nodiscard]] std::vector<Configuration> read_settled(const ToolSpaceKey& key) const;
  /// Those that transitions have found and settle() was not told of.
  [[nodiscard]] std::vector<Configuration> read_candidates(const ToolSpaceKey& key) const;
  /// Gives a candidate its level, or removes it.
  /// @param level Below zero: the candidate is removed, as it is a configuration that is known.
  void settle(const ToolSpaceKey& key, const ConfigurationSummary& candidate, std::int32_t level);
  /// Marks those that are beyond the force limit, and no others.
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
  /// What is kept of the fields of one.
  [[nodiscard]] Keep keep_of(const ToolSpaceKey& key, const ConfigurationSummary& summary) const;
  /// Whether there is no such configuration here, or one that did not converge while the other did.
  [[nodiscard]] bool is_of_use(const ToolSpaceKey& key, const ConfigurationSummary& other) const;

  /// Removes those of which an intermediate state is missing: they are computed again with all
  /// states on the way to them.
  void remove_without_way();
  /// Takes over those of another file that are of use here.
  /// @param there Which tool space it is there. @returns The check-points of which level 0 came.
  std::set<CheckPoint> merge(const ToolSpaceKey& key, const Configurations& other,
                             const ToolSpaceKey& there);
  /// Reads what a conversion of the file writes again: the checksums of those of which it was
  /// another.
  [[nodiscard]] std::function<void()> read_for_conversion();

  /// Gives back the prepared statements.
  void release();

 private:
  [[nodiscard]] std::vector<Configuration> read_where(const ToolSpaceKey& key,
                                                      const std::string& condition) const;
  /// Gives a row other numbers; its fields stay.
  /// @param level That it is found by.
  void rewrite(const ToolSpaceKey& key, std::int32_t level,
               const ConfigurationSummary& summary) const;
  /// Inserts a row, in place of one with the same key.
  void insert(const ToolSpaceKey& key, const ConfigurationSummary& summary,
              const rows::Fields& fields);
  /// Whether fields that are whole have the sizes of the body.
  [[nodiscard]] bool fit(BodyId body, const rows::Fields& fields) const;
  /// A displacement that is whole has no fewer bytes; coefficients of modes have.
  [[nodiscard]] std::int64_t bytes_of_whole(BodyId body) const;

  const Bodies& bodies_;
  const Bases& bases_;
  /// Prepared at the first use.
  std::optional<sqlite::Statement> insert_;
  mutable std::optional<sqlite::Statement> select_fields_;
  mutable std::optional<sqlite::Statement> select_outcome_;
};

}  // namespace palpate::storage
