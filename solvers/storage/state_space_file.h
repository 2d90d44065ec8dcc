// SPDX-License-Identifier: BSD-3-Clause
// The durable form of a state space: an SQLite database, one file, usually named *.palpate.
//
// `PRAGMA application_id` is 0x50616c70 ("Palp"), `PRAGMA user_version` the version of the schema:
//
//   scene          one row: the body, where it is held, where it may be touched, its hash
//   material       the different materials of the scene
//   tool_space     a tool, its grid and how it is explored; complete = 1 when nothing is left to
//                  find
//   configuration  one row each: all of state_space/configuration.h; outcome and flags are those of
//                  base/outcome.h
//   basis           what the fields of a finished space are reduced to, see packed_basis.h
//   transition     which level is reached from where, in a space with levels
//   intermediate   states on the way to each configuration, where they were asked for
//   test_point     equilibria beside the configurations, see state_space/test_point.h
//   reduced_array  the arrays of reduced models and of what was trained at places, and of training
//                  that is under way; a file that holds none of them has no such table
//
// schema.sql.h says each column, its shape and unit. Blobs are little-endian arrays: float64, int32
// or uint8. scene_id is 1; it and parent_scene_id leave room for a body whose topology changes.
// A NaN is a NULL. With Python (and NumPy):
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
// Damage. Every row has a checksum of all its columns. What is damaged is left out, and said: all
// else is read. A file that somebody else made is trusted in nothing: its tables must be those of
// schema.sql.h alone, its numbers possible, and no memory is taken for what it merely claims.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fields/packed_basis.h"
#include "state_space/state_space.h"
#include "state_space/test_point.h"

namespace palpate {

/// An open file. Not thread-safe: one object for each thread.
///
/// Every member throws InputError for a file that is no state space or damaged in its scene, and
/// BackendError where the disk, its space, the permissions or another writer stand in the way.
class StateSpaceFile {
 public:
  /// Makes the file for a scene, open to append. It appears complete or not at all.
  /// @throws InputError there is such a file, or its folder is missing.
  [[nodiscard]] static StateSpaceFile create(const std::filesystem::path& path, const Scene& scene,
                                             double solver_tolerance);

  /// Opens a file to append. One of an older schema becomes one of this.
  /// @throws InputError it is missing, of another schema, or was made for another scene or
  ///   tolerance.
  [[nodiscard]] static StateSpaceFile open_to_append(const std::filesystem::path& path,
                                                     const Scene& scene, double solver_tolerance);

  /// open_to_append where there is a file, else create.
  [[nodiscard]] static StateSpaceFile open_or_create(const std::filesystem::path& path,
                                                     const Scene& scene, double solver_tolerance);

  /// Opens a file to read, also where nothing may be written.
  /// @throws InputError it is missing or of another schema.
  [[nodiscard]] static StateSpaceFile open_read_only(const std::filesystem::path& path);

  /// Whether a writer is at work on a file, or was killed.
  [[nodiscard]] static bool is_being_written(const std::filesystem::path& path);

  /// Closes without a word when something fails: call close() to know.
  ~StateSpaceFile();
  StateSpaceFile(StateSpaceFile&&) noexcept;
  StateSpaceFile& operator=(StateSpaceFile&&) noexcept;

  /// @throws InputError it was made for another scene or tolerance.
  void require(const Scene& scene, double solver_tolerance) const;

  /// Puts everything into the single file. Nothing may be called afterwards.
  void close();

  [[nodiscard]] const std::filesystem::path& path() const;
  [[nodiscard]] const std::string& scene_hash() const;
  [[nodiscard]] double solver_tolerance() const;
  /// What was found damaged in all that was read so far, and so was left out: "configuration
  /// (1, 0, -1) of active node 8", and rows that belong to nothing.
  [[nodiscard]] std::vector<std::string> left_out() const;
  /// Reads everything and removes what is damaged, so that it is computed again.
  /// @returns What it was, as left_out().
  /// @throws InputError the damage is such that it cannot be told row by row.
  std::vector<std::string> remove_damaged();
  /// @throws InputError also where the scene does not have the hash it is stored with.
  [[nodiscard]] Scene read_scene() const;

  /// Adds a tool space. One that is there is extended: its box may become larger, with the same
  /// spacing, its force limit, its tolerance and its history may be others; then it is no longer
  /// complete.
  /// @throws InputError it is there with a larger box, with another tip radius, spacing, coarsest
  ///   cells or number of intermediate states, or only one of the two has third derivatives.
  void add_tool_space(const ToolSpaceSetup& setup);
  void set_complete(ToolSpaceId tool_space, bool complete);
  /// The tool spaces in the order of their numbers, without configurations.
  [[nodiscard]] std::vector<ToolSpace> read_tool_spaces() const;

  /// Adds a configuration to a tool space, in place of one with the same check-point and level.
  /// @param way The intermediate states on the way to it: they are there as soon as it is.
  /// @throws InputError there is no such tool space, or a field has a size that is not the body's;
  /// all
  ///   may be empty.
  void add(ToolSpaceId tool_space, const Configuration& configuration,
           const std::vector<IntermediateState>& way = {});

  /// All configurations of a tool space without fields, in the order of operator<.
  [[nodiscard]] std::vector<Configuration> read_summaries(ToolSpaceId tool_space) const;
  /// What transitions have found and settle() was not told of, without fields.
  [[nodiscard]] std::vector<Configuration> read_candidates(ToolSpaceId tool_space) const;
  /// Gives a candidate its level, or removes it.
  /// @param level Below zero: the candidate is removed, as it is a configuration that is known.
  void settle(ToolSpaceId tool_space, const ConfigurationSummary& candidate, std::int32_t level);

  void add(ToolSpaceId tool_space, const LevelTransition& transition);
  /// Adds an intermediate state, in place of one of the same number on the same way.
  void add(ToolSpaceId tool_space, const IntermediateState& state);
  [[nodiscard]] std::vector<LevelTransition> read_transitions(ToolSpaceId tool_space) const;
  /// The transitions of which both ends are among the configurations: others may have been lost.
  /// @param configurations Those of the tool space, in the order of operator<.
  [[nodiscard]] std::vector<LevelTransition> read_linked_transitions(
      ToolSpaceId tool_space, const std::vector<Configuration>& configurations) const;

  /// All intermediate states of a tool space, in the order of operator<.
  [[nodiscard]] std::vector<IntermediateState> read_intermediate_states(
      ToolSpaceId tool_space) const;

  /// Fills in the fields u, v, p and p_v of a configuration: what is kept of them, and zero
  /// elsewhere.
  /// @returns False where the fields are damaged, or hold what is no number; then they are left
  ///   out.
  [[nodiscard]] bool read_fields(ToolSpaceId tool_space, Configuration& configuration) const;
  /// The usable configurations of a tool space whose fields are whole, in the order of operator<.
  [[nodiscard]] std::vector<StateKey> list_whole(ToolSpaceId tool_space) const;
  /// Reads the fields as they are stored.
  /// @returns False where they are damaged; then they are left out.
  [[nodiscard]] bool read_stored(ToolSpaceId tool_space, const ConfigurationSummary& summary,
                                 StoredFields& stored) const;

  /// What is kept of the fields of all configurations: the least of any.
  [[nodiscard]] Keep keep() const;
  /// What is kept of those of one.
  [[nodiscard]] Keep keep_of(ToolSpaceId tool_space, const ConfigurationSummary& summary) const;
  /// Whether there is no such configuration here, or one that did not converge while the other did.
  [[nodiscard]] bool is_of_use(ToolSpaceId tool_space, const ConfigurationSummary& other) const;
  /// The numbers of the bases of a tool space, ascending, and their boxes.
  struct BasisBox {
    std::int64_t number = 0;
    CheckPointBox box;
    Keep keep = Keep::touch;
    /// That its modes make in a displacement, as a share of the largest one.
    double error = 0;
  };
  [[nodiscard]] std::vector<BasisBox> list_bases(ToolSpaceId tool_space) const;
  /// A basis, read when it is first asked for; null where it is damaged, and so left out.
  [[nodiscard]] std::shared_ptr<const FieldBasis> read_basis(ToolSpaceId tool_space,
                                                             std::int64_t number) const;
  /// Gives back the memory of the bases that were read. They are read anew when they are asked for.
  void forget_bases() const;
  /// What was read of a file, and need not be read again.
  struct Known {
    /// By tool space and checksum.
    std::map<std::pair<ToolSpaceId, std::int64_t>, std::shared_ptr<const FieldBasis>> bases;
    /// Of the body; nothing: it was not asked for.
    std::optional<Index> num_pressures;
  };
  /// Has this taken from here, and put here, that another object has read of the same file before.
  void share(Known& known);
  /// Stores a basis, in place of one of the same number. That one's modes must be the first of its
  /// own: what was reduced by them stays so.
  void add_basis(ToolSpaceId tool_space, std::int64_t number, const PackedBasis& basis);
  /// Adds a configuration with its fields by the modes of the basis that serves its check-point, in
  /// place of one with the same check-point and level.
  void add(ToolSpaceId tool_space, const ConfigurationSummary& summary,
           const ReducedFields& reduced);
  /// Gives the disk what is free in the file. It may be called where nothing else is under way.
  void shrink();
  /// Runs `body`; what it changes becomes durable together, or where it throws not at all.
  void change_together(const std::function<void()>& body);

  /// Reads everything but test points; fields only if `with_fields`.
  [[nodiscard]] StateSpace read(bool with_fields) const;

  /// Adds a test point, unless it is there. It needs no tool space.
  void add(const TestSet& set, const TestPoint& point);
  /// The test points of a set, in the order of operator<.
  [[nodiscard]] std::vector<TestPoint> read_test_points(const TestSet& set) const;

  /// The arrays of a reduced model by name, as those of reduced/model_arrays.h.
  using Arrays = std::map<std::string, Eigen::MatrixXd>;
  /// Stores a reduced model, all of it or nothing, in place of one with the same key and of what
  /// its training has stored. It is durable when this returns.
  /// @param key Tells the model from any other: what follows from the same has the same.
  /// @param arrays At least one.
  /// @throws InputError an array is larger than a row may be.
  void add_reduced_model(const std::string& key, const Arrays& arrays);
  /// The keys of what is complete, reduced models and trainings at places, in the order of storing.
  [[nodiscard]] std::vector<std::string> list_reduced_models() const;
  /// Nothing where there is no such model, or a part of it is damaged and so left out.
  [[nodiscard]] std::optional<Arrays> read_reduced_model(const std::string& key) const;
  /// Stores an array that the training of a model has found, in place of one of the same name.
  void add_training(const std::string& key, const std::string& name, const Eigen::MatrixXd& array);
  /// What the training of a model has stored; what is damaged is left out.
  [[nodiscard]] Arrays read_training(const std::string& key) const;

  /// Takes over tool spaces, configurations and test points of another file of the same scene, such
  /// as that of a rank of a run. What is here stays, except that a configuration that converged
  /// there replaces one that did not converge here. The other file stays as it is; killed half-way,
  /// it can be done again. What was taken over is durable when this returns: the other file may be
  /// removed, if nothing was left out.
  /// @returns What is damaged in the other file, as left_out().
  /// @throws InputError another scene or tolerance, or another tip or grid of the same tool space;
  /// a
  ///   file with reduced fields, which no run leaves to be merged.
  [[nodiscard]] std::vector<std::string> merge(const std::filesystem::path& other);

 private:
  struct Impl;
  explicit StateSpaceFile(std::unique_ptr<Impl> impl);
  void upgrade();
  /// What it is called in a message.
  [[nodiscard]] std::string name_of(ToolSpaceId tool_space) const;
  [[nodiscard]] std::optional<ToolSpace> find_tool_space(ToolSpaceId tool_space) const;
  /// @param condition A condition on the row, in SQL.
  [[nodiscard]] std::vector<Configuration> read_where(ToolSpaceId tool_space,
                                                      const std::string& condition) const;
  [[nodiscard]] std::vector<TestSet> read_test_sets() const;
  void extend(const ToolSpaceSetup& setup);
  void add_array(const std::string& key, const std::string& name, std::int64_t num_arrays,
                 const Eigen::MatrixXd& array);
  /// Those of a model, or of a training.
  [[nodiscard]] Arrays read_arrays(const std::string& key, bool of_training) const;
  void add_alone(ToolSpaceId tool_space, const Configuration& configuration);
  /// @param where_there_is_one What SQLite does where there is one already: REPLACE or IGNORE.
  void add_alone(ToolSpaceId tool_space, const LevelTransition& transition,
                 const std::string& where_there_is_one);
  void add_alone(const TestSet& set, const TestPoint& point);
  std::unique_ptr<Impl> impl_;
};

/// The message "3 parts of 'a.palpate' are damaged: …, … and 1 more." for a list that is not empty.
[[nodiscard]] std::string describe_left_out(const std::filesystem::path& path,
                                            const std::vector<std::string>& left_out);

}  // namespace palpate
