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
  using Key = std::pair<CheckPoint, std::int32_t>;
  [[nodiscard]] static Key key_of(const ConfigurationSummary& c) {
    return {c.check_point, c.level};
  }

 public:
  MemoryRecord(const Scene& scene, const std::vector<Site>& sites, double solver_tolerance,
               Communicator& communicator)
      : communicator_(communicator) {
    space_.scene = scene;
    space_.scene_hash = hash(scene);
    space_.solver_tolerance = solver_tolerance;
    for (const Site& site : sites) space_.sites.push_back({site, false, {}, {}});
    sort(space_);
  }

  [[nodiscard]] Known known(Index /*active_node*/) const override { return {}; }
  [[nodiscard]] std::vector<std::string> damaged() const override { return {}; }

  void keep(Index active_node, const Configuration& found,
            const std::vector<IntermediateState>& way) override {
    found_[active_node].emplace(key_of(found), found);
    for (const IntermediateState& state : way) {
      intermediate_states_.emplace_back(active_node, state);
    }
  }

  void keep(Index active_node, const LevelTransition& transition) override {
    transitions_.emplace_back(active_node, transition);
  }

  void settle(Index active_node, const ConfigurationSummary& candidate,
              std::int32_t level) override {
    auto& found = found_.at(active_node);
    auto settled = found.extract(key_of(candidate));
    if (level < 0) return;
    settled.mapped().level = level;
    settled.key() = key_of(settled.mapped());
    found.insert(std::move(settled));
  }

  [[nodiscard]] Configuration load(Index active_node,
                                   const ConfigurationSummary& summary) const override {
    return found_.at(active_node).at(key_of(summary));
  }

  [[nodiscard]] TouchSpace finish(bool complete, double bound) override {
    std::vector<std::pair<Index, Configuration>> configurations;
    for (auto& [node, found] : found_) {
      for (auto& [key, c] : found) configurations.emplace_back(node, std::move(c));
    }
    found_.clear();
    gather(configurations, communicator_);
    gather(transitions_, communicator_);
    gather(intermediate_states_, communicator_);
    TouchSpace result;
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      for (auto& [node, c] : configurations) found_[node].emplace(key_of(c), std::move(c));
      for (const auto& [node, transition] : transitions_) {
        found_.at(node)
            .at({transition.start, transition.start_level})
            .reached[neighbour_number(transition.start, transition.target)] = transition.reached;
      }
      std::map<Index, std::vector<IntermediateState>> intermediate_states;
      for (const auto& [node, state] : intermediate_states_) {
        intermediate_states[node].push_back(state);
      }
      for (SiteSpace& site : space_.sites) {
        site.complete = complete;
        for (auto& [key, c] : found_[site.site.active_node]) {
          if (c.level >= 0) site.configurations.push_back(std::move(c));
        }
        site.intermediate_states = std::move(intermediate_states[site.site.active_node]);
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
  /// By active node, check-point and level.
  std::map<Index, std::map<Key, Configuration>> found_;
  std::vector<std::pair<Index, LevelTransition>> transitions_;
  std::vector<std::pair<Index, IntermediateState>> intermediate_states_;
};

class FileRecord final : public Record {
 public:
  FileRecord(const fs::path& path, const Scene& scene, const std::vector<Site>& sites,
             double solver_tolerance, Communicator& communicator)
      : path_(path),
        sites_(sites),
        communicator_(communicator),
        files_(path, scene, solver_tolerance, communicator) {
    files_.open([&](StateSpaceFile& file) {
      for (const Site& site : sites) file.add_site(site);
    });
  }

  [[nodiscard]] Known known(Index active_node) const override {
    Known all;
    if (communicator_.rank() != 0) return all;
    const StateSpaceFile& file = files_.own();
    const std::vector<Configuration> settled = file.read_summaries(active_node);
    for (const auto& found : {settled, file.read_candidates(active_node)}) {
      all.configurations.insert(all.configurations.end(), found.begin(), found.end());
    }
    all.transitions = file.read_linked_transitions(active_node, settled);
    return all;
  }

  [[nodiscard]] std::vector<std::string> damaged() const override { return files_.damaged(); }

  void keep(Index active_node, const Configuration& found,
            const std::vector<IntermediateState>& way) override {
    files_.own().add(active_node, found, way);
  }

  void keep(Index active_node, const LevelTransition& transition) override {
    files_.own().add(active_node, transition);
  }

  void settle(Index active_node, const ConfigurationSummary& candidate,
              std::int32_t level) override {
    files_.own().settle(active_node, candidate, level);
  }

  [[nodiscard]] Configuration load(Index active_node,
                                   const ConfigurationSummary& summary) const override {
    Configuration configuration{summary, {}, {}, {}, {}};
    if (!files_.own().read_fields(active_node, configuration)) {
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
        for (const Site& site : sites_) file.set_complete(site.active_node, true);
      }
      file.close();
      result = make_touch_space(StateSpaceFile::open_read_only(path_), bound);
    });
    return result;
  }

 private:
  fs::path path_;
  std::vector<Site> sites_;
  Communicator& communicator_;
  RankFiles files_;
};

}  // namespace

std::unique_ptr<Record> make_memory_record(const Scene& scene, const std::vector<Site>& sites,
                                           double solver_tolerance, Communicator& communicator) {
  return std::make_unique<MemoryRecord>(scene, sites, solver_tolerance, communicator);
}

std::unique_ptr<Record> make_file_record(const fs::path& path, const Scene& scene,
                                         const std::vector<Site>& sites, double solver_tolerance,
                                         Communicator& communicator) {
  return std::make_unique<FileRecord>(path, scene, sites, solver_tolerance, communicator);
}

}  // namespace palpate
