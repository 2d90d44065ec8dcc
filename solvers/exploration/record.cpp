// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/record.h"

#include <map>
#include <utility>

#include "base/error.h"
#include "exploration/rank_files.h"
#include "exploration/transfer.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class MemoryRecord final : public Record {
 public:
  MemoryRecord(const Scene& scene, const std::vector<ToolSpaceSetup>& setups,
               double solver_tolerance, Communicator& communicator)
      : communicator_(communicator) {
    space_.scene = scene;
    space_.scene_hash = hash(scene);
    space_.solver_tolerance = solver_tolerance;
    for (const ToolSpaceSetup& setup : setups) space_.tool_spaces.push_back({setup, false, {}, {}});
    sort(space_);
  }

  [[nodiscard]] Known known(ToolSpaceId /*tool_space*/) const override { return {}; }
  [[nodiscard]] std::vector<std::string> damaged() const override { return {}; }

  void keep(ToolSpaceId tool_space, const Configuration& found,
            const std::vector<IntermediateState>& way) override {
    found_.emplace(key_of(tool_space, found), found);
    for (const IntermediateState& state : way) {
      intermediate_states_.emplace_back(tool_space, state);
    }
  }

  void keep(ToolSpaceId tool_space, const LevelTransition& transition) override {
    transitions_.emplace_back(tool_space, transition);
  }

  void settle(ToolSpaceId tool_space, const ConfigurationSummary& candidate,
              std::int32_t level) override {
    auto settled = found_.extract(key_of(tool_space, candidate));
    if (level < 0) return;
    settled.mapped().level = level;
    settled.key().level = level;
    found_.insert(std::move(settled));
  }

  [[nodiscard]] Configuration load(ToolSpaceId tool_space,
                                   const ConfigurationSummary& summary) const override {
    return found_.at(key_of(tool_space, summary));
  }

  [[nodiscard]] TouchSpace finish(bool complete, double bound) override {
    std::vector<std::pair<ToolSpaceId, Configuration>> configurations;
    for (auto& [key, c] : found_) configurations.emplace_back(key.tool_space, std::move(c));
    found_.clear();
    gather(configurations, communicator_);
    gather(transitions_, communicator_);
    gather(intermediate_states_, communicator_);
    TouchSpace result;
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      for (auto& [id, c] : configurations) found_.emplace(key_of(id, c), std::move(c));
      for (const auto& [id, transition] : transitions_) {
        found_.at({id, transition.start, transition.start_level})
            .reached[neighbour_number(transition.start, transition.target)] = transition.reached;
      }
      std::map<ToolSpaceId, ToolSpace*> tool_spaces;
      for (ToolSpace& tool_space : space_.tool_spaces) {
        tool_space.complete = complete;
        tool_spaces[tool_space.setup.id] = &tool_space;
      }
      for (auto& [key, c] : found_) {
        if (c.level < 0) continue;
        tool_spaces.at(key.tool_space)->configurations.push_back(std::move(c));
      }
      for (const auto& [id, state] : intermediate_states_) {
        tool_spaces.at(id)->intermediate_states.push_back(state);
      }
      sort(space_);
      found_.clear();
      result = make_touch_space(space_, bound);
    });
    return result;
  }

 private:
  Communicator& communicator_;
  StateSpace space_;
  std::map<StateKey, Configuration> found_;
  std::vector<std::pair<ToolSpaceId, LevelTransition>> transitions_;
  std::vector<std::pair<ToolSpaceId, IntermediateState>> intermediate_states_;
};

class FileRecord final : public Record {
 public:
  FileRecord(const fs::path& path, const Scene& scene, const std::vector<ToolSpaceSetup>& setups,
             double solver_tolerance, Communicator& communicator)
      : path_(path),
        setups_(setups),
        communicator_(communicator),
        files_(path, scene, solver_tolerance, communicator) {
    files_.open([&](StateSpaceFile& file) {
      for (const ToolSpaceSetup& setup : setups) file.add_tool_space(setup);
    });
  }

  [[nodiscard]] Known known(ToolSpaceId tool_space) const override {
    Known all;
    if (communicator_.rank() != 0) return all;
    const StateSpaceFile& file = files_.own();
    const std::vector<Configuration> settled = file.read_summaries(tool_space);
    for (const auto& found : {settled, file.read_candidates(tool_space)}) {
      all.configurations.insert(all.configurations.end(), found.begin(), found.end());
    }
    all.transitions = file.read_linked_transitions(tool_space, settled);
    return all;
  }

  [[nodiscard]] std::vector<std::string> damaged() const override { return files_.damaged(); }

  void keep(ToolSpaceId tool_space, const Configuration& found,
            const std::vector<IntermediateState>& way) override {
    files_.own().add(tool_space, found, way);
  }

  void keep(ToolSpaceId tool_space, const LevelTransition& transition) override {
    files_.own().add(tool_space, transition);
  }

  void settle(ToolSpaceId tool_space, const ConfigurationSummary& candidate,
              std::int32_t level) override {
    files_.own().settle(tool_space, candidate, level);
  }

  [[nodiscard]] Configuration load(ToolSpaceId tool_space,
                                   const ConfigurationSummary& summary) const override {
    Configuration configuration{summary, {}, {}, {}, {}};
    if (!files_.own().read_fields(tool_space, configuration)) {
      throw InputError("A part of " + path_.string() + " was damaged while it was in use: " +
                       files_.own().left_out().front() + ". Check the disk and run again.");
    }
    return configuration;
  }

  [[nodiscard]] TouchSpace finish(bool complete, double bound) override {
    files_.merge();
    TouchSpace result;
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      StateSpaceFile& file = files_.own();
      if (complete) {
        for (const ToolSpaceSetup& setup : setups_) file.set_complete(setup.id, true);
      }
      file.close();
      result = make_touch_space(StateSpaceFile::open_read_only(path_), bound);
    });
    return result;
  }

 private:
  fs::path path_;
  std::vector<ToolSpaceSetup> setups_;
  Communicator& communicator_;
  RankFiles files_;
};

}  // namespace

std::unique_ptr<Record> make_memory_record(const Scene& scene,
                                           const std::vector<ToolSpaceSetup>& setups,
                                           double solver_tolerance, Communicator& communicator) {
  return std::make_unique<MemoryRecord>(scene, setups, solver_tolerance, communicator);
}

std::unique_ptr<Record> make_file_record(const fs::path& path, const Scene& scene,
                                         const std::vector<ToolSpaceSetup>& setups,
                                         double solver_tolerance, Communicator& communicator) {
  return std::make_unique<FileRecord>(path, scene, setups, solver_tolerance, communicator);
}

}  // namespace palpate
