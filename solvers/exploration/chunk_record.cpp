// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/chunk_record.h"

#include <algorithm>
#include <iterator>

#include "exploration/transfer.h"
#include "interaction/tool_clearance.h"
#include "interpolation/clearance.h"
#include "state_space/surface.h"

namespace palpate {

ChunkRecord::ChunkRecord(std::unique_ptr<Record> record, const std::vector<SpaceBody>& bodies,
                         std::function<InteractionFactory&(BodyId)> tools_of,
                         const std::vector<ToolSpaceSetup>& setups, double bound,
                         Communicator& communicator)
    : record_(std::move(record)),
      bodies_(bodies),
      shown_(bodies),
      tools_of_(std::move(tools_of)),
      setups_(setups),
      bound_(bound),
      communicator_(communicator) {}

void ChunkRecord::keep(ToolSpaceKey tool_space, const Configuration& found,
                       const std::vector<IntermediateState>& way) {
  record_->keep(tool_space, found, way);
  if (found.level >= 0) found_.push_back({tool_space, found, way, {}});
}

void ChunkRecord::keep(ToolSpaceKey tool_space, const LevelTransition& transition) {
  record_->keep(tool_space, transition);
  transitions_.emplace_back(tool_space, transition);
}

void ChunkRecord::settle(ToolSpaceKey tool_space, const ConfigurationSummary& candidate,
                         std::int32_t level) {
  record_->settle(tool_space, candidate, level);
  if (level < 0) return;
  found_.push_back({tool_space, candidate, {}, {}});
  found_.back().summary.level = level;
}

/// Notes what earlier runs have found, which rank 0 alone knows.
void ChunkRecord::note_known() {
  for (const ToolSpaceSetup& setup : setups_) {
    const Known known = record_->known(setup.key());
    std::map<CheckPoint, std::vector<IntermediateState>> ways;
    for (const IntermediateState& state : record_->known_intermediate_states(setup.key())) {
      ways[state.target].push_back(state);
    }
    for (ConfigurationSummary c : known.configurations) {
      if (c.level < 0) continue;
      c.reached = ConfigurationSummary().reached;
      const auto way = c.level == 0 ? ways.find(c.check_point) : ways.end();
      found_.push_back(
          {setup.key(), c, way == ways.end() ? decltype(Found::way)() : way->second, {}});
    }
    for (const LevelTransition& t : known.transitions) transitions_.emplace_back(setup.key(), t);
  }
}

std::vector<ChunkRecord::Found> ChunkRecord::next() {
  std::vector<Found> next;
  const std::size_t number = std::min(found_.size(), kMostInChunk);
  for (std::size_t i = 0; i < number; ++i) {
    Found& found = next.emplace_back(std::move(found_.front()));
    found_.pop_front();
    const auto setup = std::find_if(setups_.begin(), setups_.end(), [&](const ToolSpaceSetup& s) {
      return s.key() == found.tool_space;
    });
    if (setup->presses() || !found.summary.usable()) continue;
    Configuration whole = record_->load(found.tool_space, found.summary);
    count_from_rest(find_body(bodies_, setup->body).at_rest, whole);
    const std::vector<Index>& points = shown_.surface_of(setup->body).mesh_points;
    found.fields = Snapshots(static_cast<Eigen::Index>(points.size()), 0, 1);
    found.fields.set(0, whole, points, setup->grid.field_step());
  }
  return next;
}

std::optional<SpaceChunk> ChunkRecord::take() {
  Packer mine;
  bool is_all = false;
  agree(communicator_, [&] {
    if (!std::exchange(has_noted_known_, true)) note_known();
    mine.put_list(next());
    is_all = found_.empty();
  });
  // The configurations that transitions connect are given out before the transitions.
  if (any(communicator_, !is_all)) {
    mine.put_list(std::vector<std::pair<ToolSpaceKey, LevelTransition>>());
  } else {
    mine.put_list(std::exchange(transitions_, {}));
  }
  std::optional<SpaceChunk> chunk;
  const std::vector<Bytes> all = communicator_.gather(mine.take());
  bool is_empty = true;
  agree(communicator_, [&] {
    if (communicator_.rank() != 0) return;
    std::map<ToolSpaceKey, std::vector<Found>> found;
    std::map<ToolSpaceKey, std::vector<LevelTransition>> transitions;
    for (const Bytes& bytes : all) {
      Unpacker content(bytes);
      for (Found& one : content.take_list<std::vector<Found>>()) {
        found[one.tool_space].push_back(std::move(one));
      }
      for (const auto& [id, t] :
           content.take_list<std::vector<std::pair<ToolSpaceKey, LevelTransition>>>()) {
        transitions[id].push_back(t);
      }
    }
    is_empty = found.empty() && transitions.empty();
    if (is_empty) return;
    chunk.emplace();
    chunk->number = ++num_chunks_;
    for (const ToolSpaceSetup& setup : setups_) {
      if (found.count(setup.key()) == 0 && transitions.count(setup.key()) == 0) continue;
      chunk->tool_spaces.push_back(chunk_of(setup, std::move(found[setup.key()])));
      chunk->tool_spaces.back().transitions = std::move(transitions[setup.key()]);
    }
  });
  if (any(communicator_, !is_empty) && !chunk) chunk.emplace();
  return chunk;
}

ToolSpaceChunk ChunkRecord::chunk_of(const ToolSpaceSetup& setup, std::vector<Found> found) {
  ToolSpaceChunk chunk;
  chunk.setup = setup;
  std::sort(found.begin(), found.end(),
            [](const Found& a, const Found& b) { return a.summary < b.summary; });
  TouchToolSpace marked;
  marked.setup = setup;
  for (const Found& one : found) {
    marked.configurations.push_back(one.summary);
    chunk.intermediate_states.insert(chunk.intermediate_states.end(), one.way.begin(),
                                     one.way.end());
  }
  if (setup.presses()) {
    add_clearance(tools_of_(setup.body).clearance(setup.interaction), marked);
    Clearance& clearance = clearances_[setup.key()];
    if (!clearance) clearance = remembering(std::move(marked.clearance));
    chunk.clearance = clearance;
  } else {
    reduce(setup, found, chunk);
  }
  chunk.configurations = std::move(marked.configurations);
  std::sort(chunk.intermediate_states.begin(), chunk.intermediate_states.end());
  return chunk;
}

void ChunkRecord::reduce(const ToolSpaceSetup& setup, const std::vector<Found>& found,
                         ToolSpaceChunk& chunk) {
  Modes& modes = modes_[setup.key()];
  const Eigen::Index num_points = shown_.surface_of(setup.body).num_points();
  const auto has_fields = [](const Found& one) { return one.fields.u.cols() > 0; };
  const auto number =
      static_cast<Eigen::Index>(std::count_if(found.begin(), found.end(), has_fields));
  chunk.fields.resize(found.size());
  if (number == 0) return;
  Snapshots batch(num_points, 0, number);
  Eigen::Index at = 0;
  for (const Found& one : found) {
    if (has_fields(one)) batch.set(at++, one.fields, 0);
  }
  modes.scale.take(batch);
  const Eigen::Index before = modes.basis.modes.cols();
  FieldReducer reducer(num_points, 0, modes.scale, setup.grid.field_step(), bound_,
                       before > 0 ? &modes.basis : nullptr);
  reducer.add(batch);
  Reduction reduction = reducer.finish();
  at = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!has_fields(found[i])) continue;
    chunk.fields[i] = std::move(reduction.fields[static_cast<std::size_t>(at++)]);
  }
  modes.basis = std::move(reduction.basis);
  chunk.modes =
      shown_.carry(setup.body, modes.basis.modes.rightCols(modes.basis.modes.cols() - before));
  chunk.largest_displacement = modes.basis.largest_displacement;
  chunk.displacement_error = modes.basis.displacement_error;
  chunk.sensitivity_error = modes.basis.sensitivity_error;
}

}  // namespace palpate
