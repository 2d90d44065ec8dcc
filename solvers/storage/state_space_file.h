// SPDX-License-Identifier: BSD-3-Clause
// The durable form of a state space: an SQLite database, one file, usually named *.palpate.
//
// `PRAGMA application_id` is 0x50616c70 ("Palp"), `PRAGMA user_version` the version of the schema:
//
//   scene          one row a body: where it is held, where it may be touched, its hash
//   material       the different materials of a body
//   tool_space     a tool, its grid and how it is explored; complete = 1 when nothing is left to
//                  find
//   configuration  one row each: all of state_space/configuration.h; outcome and flags are those of
//                  base/outcome.h
//   basis           what the fields of a finished space are reduced to, see packed_basis.h
//   transition     which level is reached from where, in a space with levels
//   intermediate   states on the way to each configuration, where they were asked for
//   test_point     equilibria beside the configurations, see state_space/test_point.h
//   tool_motion    how a rigid tool is moved that is not translated; a file without such a tool has
//                  no such table
//   mesh_region    the region that a tool space is for, of an organ that is divided; a file without
//                  regions has no such table
//   body_cut       the cut of a body and the stage at which that is; a file without cuts has no
//   such
//                  table
//   reduced_array  the arrays of reduced models and of what was trained at places, and of training
//                  that is under way; a file that holds none of them has no such table
//
// schema.sql.h says each column, its shape and unit. Blobs are little-endian arrays: float64, int32
// or uint8. A NaN is a NULL. scene_id is the number of a body: 1 is the first, and in most files
// the only one; others are other discretisations of the same organ, or stages of its cut, with tool
// spaces of their own. With Python (and NumPy):
//
//   import sqlite3, numpy
//   file = sqlite3.connect("liver.palpate")
//   rest = numpy.frombuffer(file.execute("SELECT points FROM scene").fetchone()[0]).reshape(-1, 3)
//   for i, j, k, h in file.execute("SELECT i, j, k, force_x FROM configuration"):
//       print((i, j, k), h)
//
// Durability. A writer keeps a write-ahead log beside the file ("-wal"): when add() returns, the
// configuration outlives the death of the process at any instant, also by kill -9. A loss of power
// never takes the file, what was merged, or what was there when close() returned; of a file that is
// being written it may take what was added within a second after the disk was last waited for.
// close() leaves the single file; the log of a writer that was killed is taken up by the next one
// that opens the file. One writer at a time.
//
// Damage. Every row has a checksum of all its columns. Damaged rows are left out and reported; all
// others are read. A file that somebody else made is not trusted: it may have no other tables than
// those of schema.sql.h, its numbers must be possible, and no memory is taken for sizes that it
// merely claims.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "state_space/state_space.h"
#include "storage/bases.h"
#include "storage/bodies.h"
#include "storage/reduced_models.h"
#include "storage/test_points.h"

namespace palpate {

namespace storage {
struct Tables;
}

/// An open file. Not thread-safe: one object for each thread.
///
/// Every member throws InputError for a file that is no state space or damaged in its scene, and
/// BackendError where the disk, its space, the permissions or another writer stand in the way.
class StateSpaceFile {
 public:
  /// Makes the file for a scene, its first body, open to append. It appears complete or not at all.
  /// @param at_rest The body at rest, for a scene with a load.
  /// @throws InputError there is such a file, or its folder is missing.
  [[nodiscard]] static StateSpaceFile create(const std::filesystem::path& path, const Scene& scene,
                                             double solver_tolerance,
                                             const SettledBody& at_rest = {});

  /// Opens a file to append. One of an older schema becomes one of this.
  /// @param scene Any of its bodies.
  /// @throws InputError it is missing, of another schema, or was made for another scene or
  ///   tolerance.
  [[nodiscard]] static StateSpaceFile open_to_append(const std::filesystem::path& path,
                                                     const Scene& scene, double solver_tolerance);

  /// open_to_append where there is a file, else create.
  [[nodiscard]] static StateSpaceFile open_or_create(const std::filesystem::path& path,
                                                     const Scene& scene, double solver_tolerance,
                                                     const SettledBody& at_rest = {});

  /// Opens a file to read, also where nothing may be written.
  /// @throws InputError it is missing or of another schema.
  [[nodiscard]] static StateSpaceFile open_read_only(const std::filesystem::path& path);

  /// Whether a writer is at work on a file, or was killed.
  [[nodiscard]] static bool is_being_written(const std::filesystem::path& path);

  /// Closes the file, and ignores errors. Call close() to hear of them.
  ~StateSpaceFile();
  StateSpaceFile(StateSpaceFile&&) noexcept;
  StateSpaceFile& operator=(StateSpaceFile&&) noexcept;

  /// @throws InputError it was made for another scene or tolerance.
  void require(const Scene& scene, double solver_tolerance) const;

  /// Puts everything into the single file. Nothing may be called afterwards.
  void close();
  /// Makes the file smaller by the pages that are free in it. Call this only while nothing else is
  /// under way.
  void shrink();
  /// Runs `body` in one transaction: its changes become durable together, or not at all if it
  /// throws.
  void change_together(const std::function<void()>& body);

  [[nodiscard]] const std::filesystem::path& path() const;
  [[nodiscard]] double solver_tolerance() const;
  /// The names of the parts that were found damaged while the file was read so far, and so were
  /// left out: "configuration (1, 0, -1) of active node 8", and rows that belong to nothing.
  [[nodiscard]] std::vector<std::string> left_out() const;
  /// Reads everything and removes what is damaged, so that it is computed again.
  /// @returns The names of the removed parts, as left_out() gives them.
  /// @throws InputError the damage is such that it cannot be told row by row.
  std::vector<std::string> remove_damaged();

  /// Adds a body of the organ, unless it is there.
  /// @throws InputError it is of another organ, loaded or held otherwise than those that are there,
  ///   or too large.
  BodyId add_body(const Scene& scene, const SettledBody& at_rest = {});
  /// Does the same for a body whose hash is known. Where it may be touched is taken over too.
  BodyId add_body(const SpaceBody& body);
  /// @throws InputError the body is larger than a file can hold.
  static void require_size(const Scene& scene);
  /// The numbers of the bodies, ascending.
  [[nodiscard]] std::vector<BodyId> list_bodies() const;
  /// The body with a hash, or nothing.
  [[nodiscard]] std::optional<BodyId> find_body(const std::string& scene_hash) const;
  /// @throws InputError there is no such body; as read_scene().
  [[nodiscard]] const std::string& scene_hash(BodyId body = kFirstBody) const;
  /// The result of join_hashes() for all bodies.
  [[nodiscard]] std::string scene_hashes() const;
  /// Reads the scene of a body.
  /// @throws InputError also where the scene does not have the hash that it is stored with.
  [[nodiscard]] Scene read_scene(BodyId body = kFirstBody) const;
  /// The body at rest under its loads; empty where there are none.
  [[nodiscard]] const SettledBody& read_rest(BodyId body = kFirstBody) const;
  /// Reads all bodies, in the order of their numbers.
  [[nodiscard]] std::vector<SpaceBody> read_bodies() const;

  /// Adds a tool space to the body that it names. One that is there is extended: its box may become
  /// larger, with the same spacing, its force limit, its tolerance and its history may be others;
  /// then it is no longer complete.
  /// @throws InputError it is there with a larger box, with another tip radius, spacing, coarsest
  ///   cells or number of intermediate states, or only one of the two has third derivatives; there
  ///   is no such body.
  void add_tool_space(const ToolSpaceSetup& setup);
  void set_complete(const ToolSpaceKey& key, bool complete);
  /// The tool spaces of all bodies in the order of their keys, without configurations.
  [[nodiscard]] std::vector<ToolSpace> read_tool_spaces() const;

  /// Adds a configuration to a tool space, in place of one with the same check-point and level.
  /// @param way The intermediate states on the way to it: they are there as soon as it is.
  /// @throws InputError there is no such tool space, or a field has a size that is not the body's;
  ///   all may be empty.
  void add(const ToolSpaceKey& key, const Configuration& configuration,
           const std::vector<IntermediateState>& way = {});
  /// Adds a configuration with its fields by the modes of the basis that serves its check-point, in
  /// place of one with the same check-point and level.
  void add(const ToolSpaceKey& key, const ConfigurationSummary& summary,
           const ReducedFields& reduced);
  /// All configurations of a tool space without fields, in the order of operator<.
  [[nodiscard]] std::vector<Configuration> read_summaries(const ToolSpaceKey& key) const;
  /// The candidates, without fields: configurations that transitions have found, and that settle()
  /// has given no level yet.
  [[nodiscard]] std::vector<Configuration> read_candidates(const ToolSpaceKey& key) const;
  /// Gives a candidate its level, or removes it.
  /// @param level Below zero: the candidate is removed, as it is a configuration that is known.
  void settle(const ToolSpaceKey& key, const ConfigurationSummary& candidate, std::int32_t level);
  /// Whether a configuration of another file is worth taking over: none with its key is here, or
  /// the one that is here did not converge while the other one did.
  [[nodiscard]] bool is_of_use(const ToolSpaceKey& key, const ConfigurationSummary& other) const;

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

  void add(const ToolSpaceKey& key, const LevelTransition& transition);
  [[nodiscard]] std::vector<LevelTransition> read_transitions(const ToolSpaceKey& key) const;
  /// The transitions of which both ends are among the configurations: others may have been lost.
  /// @param configurations Those of the tool space, in the order of operator<.
  [[nodiscard]] std::vector<LevelTransition> read_linked_transitions(
      const ToolSpaceKey& key, const std::vector<Configuration>& configurations) const;

  /// Adds an intermediate state, in place of one of the same number on the same way.
  void add(const ToolSpaceKey& key, const IntermediateState& state);
  /// All intermediate states of a tool space, in the order of operator<.
  [[nodiscard]] std::vector<IntermediateState> read_intermediate_states(
      const ToolSpaceKey& key) const;

  /// The bases to which the fields of a finished space are reduced.
  [[nodiscard]] storage::Bases& bases();
  [[nodiscard]] const storage::Bases& bases() const;
  /// What was read of a file, and need not be read again.
  struct Known {
    storage::Bases::Known bases;
    storage::Bodies::NumPressures num_pressures;
  };
  /// From now on parts of the file are looked up in `known` before they are read, and are added to
  /// it, so that several objects of one file share what they have read.
  void share(Known& known);

  /// The test points: equilibria beside the configurations.
  [[nodiscard]] storage::TestPoints& test_points();
  [[nodiscard]] const storage::TestPoints& test_points() const;

  /// @throws InputError there is no such body.
  [[nodiscard]] storage::ReducedModels& reduced_models(BodyId body = kFirstBody);
  [[nodiscard]] const storage::ReducedModels& reduced_models(BodyId body = kFirstBody) const;

  /// Reads everything but test points and reduced models; fields only if `with_fields`.
  [[nodiscard]] StateSpace read(bool with_fields) const;

  /// Takes over tool spaces, configurations and test points of another file of the same bodies, or
  /// some of them, such as that of a rank of a run; the bodies may have other numbers there. What
  /// is here stays, except that a configuration that converged there replaces one that did not
  /// converge here. The other file stays as it is; killed half-way, it can be done again. What was
  /// taken over is durable when this returns: the other file may be removed, if nothing was left
  /// out.
  /// @returns What is damaged in the other file, as left_out().
  /// @throws InputError another scene or tolerance, or another tip or grid of the same tool space;
  ///   a file with reduced fields, which no run leaves to be merged.
  [[nodiscard]] std::vector<std::string> merge(const std::filesystem::path& other);

 private:
  explicit StateSpaceFile(std::unique_ptr<storage::Tables> tables);
  std::unique_ptr<storage::Tables> tables_;
};

}  // namespace palpate
