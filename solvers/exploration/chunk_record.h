// SPDX-License-Identifier: BSD-3-Clause
// A record that also notes what it keeps, so that it can be given out in chunks while the
// exploration goes on. Only what is new travels to rank 0.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "exploration/record.h"
#include "fields/space_chunk.h"
#include "interaction/interaction_spec.h"
#include "state_space/shown_surface.h"

namespace palpate {

class ChunkRecord final : public Record {
 public:
  /// @param record Keeps the results.
  /// @param setups The tool spaces, ordered by their keys.
  /// @param bodies, communicator They must outlive this object.
  /// @param tools_of The factory of the tools of a body.
  ChunkRecord(std::unique_ptr<Record> record, const std::vector<SpaceBody>& bodies,
              std::function<InteractionFactory&(BodyId)> tools_of,
              const std::vector<ToolSpaceSetup>& setups, double bound, Communicator& communicator);

  /// The largest number of configurations of one rank in a chunk.
  static constexpr std::size_t kMostInChunk = 256;

  /// Takes a chunk of what was found since the last one; the first chunks also have what earlier
  /// runs have found. If there is very much, the chunk has a part of it. Call this between runs,
  /// before publish() and finish().
  /// @returns The chunk on rank 0, an empty one on other ranks; nothing: there is nothing new.
  /// @note Collective
  [[nodiscard]] std::optional<SpaceChunk> take();

  [[nodiscard]] Known known(ToolSpaceKey tool_space) const override {
    return record_->known(tool_space);
  }
  [[nodiscard]] std::vector<IntermediateState> known_intermediate_states(
      ToolSpaceKey tool_space) const override {
    return record_->known_intermediate_states(tool_space);
  }
  [[nodiscard]] std::vector<std::string> damaged() const override { return record_->damaged(); }
  void keep(ToolSpaceKey tool_space, const Configuration& found,
            const std::vector<IntermediateState>& way) override;
  void keep(ToolSpaceKey tool_space, const LevelTransition& transition) override;
  void settle(ToolSpaceKey tool_space, const ConfigurationSummary& candidate,
              std::int32_t level) override;
  [[nodiscard]] Configuration load(ToolSpaceKey tool_space,
                                   const ConfigurationSummary& summary) const override {
    return record_->load(tool_space, summary);
  }
  [[nodiscard]] Keep kept(ToolSpaceKey tool_space,
                          const ConfigurationSummary& summary) const override {
    return record_->kept(tool_space, summary);
  }
  [[nodiscard]] TouchSpace publish(double bound) override { return record_->publish(bound); }
  void resume() override { record_->resume(); }
  [[nodiscard]] bool has_moved() const override { return record_->has_moved(); }
  [[nodiscard]] TouchSpace finish(bool complete, double bound) override {
    return record_->finish(complete, bound);
  }

 private:
  /// A configuration that was found, as a rank sends it to rank 0.
  struct Found {
    ToolSpaceKey tool_space;
    ConfigurationSummary summary;
    std::vector<IntermediateState> way;
    /// The fields at the surface, from the body at rest; without columns: there are none.
    Snapshots fields;
  };
  template <class Visit>
  friend void for_each_part(Found& found, Visit&& visit) {
    visit(found.tool_space);
    visit(found.summary);
    visit(found.way);
    visit(found.fields);
  }
  /// The modes of a tool space so far, on rank 0.
  struct Modes {
    FieldBasis basis;
    FieldScale scale;
  };

  void note_known();
  /// The next configurations of this rank, with their fields.
  [[nodiscard]] std::vector<Found> next();
  /// Makes the chunk of a tool space, on rank 0.
  [[nodiscard]] ToolSpaceChunk chunk_of(const ToolSpaceSetup& setup, std::vector<Found> found);
  void reduce(const ToolSpaceSetup& setup, const std::vector<Found>& found, ToolSpaceChunk& chunk);

  std::unique_ptr<Record> record_;
  const std::vector<SpaceBody>& bodies_;
  ShownSurface shown_;
  std::function<InteractionFactory&(BodyId)> tools_of_;
  std::vector<ToolSpaceSetup> setups_;
  double bound_;
  Communicator& communicator_;
  bool has_noted_known_ = false;
  /// The configurations that no chunk has had yet.
  std::deque<Found> found_;
  std::vector<std::pair<ToolSpaceKey, LevelTransition>> transitions_;
  std::int64_t num_chunks_ = 0;
  std::map<ToolSpaceKey, Modes> modes_;
  /// The clearances of rigid tools.
  std::map<ToolSpaceKey, Clearance> clearances_;
};

}  // namespace palpate
