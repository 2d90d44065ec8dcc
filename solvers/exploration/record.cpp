// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/record.h"

#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "base/error.h"
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

  [[nodiscard]] Known known() const override { return {}; }

  void keep(Index active_node, const Configuration& found,
            const std::vector<IntermediateState>& way) override {
    found_[active_node].emplace(key_of(found), found);
    for (const IntermediateState& state : way) intermediate_states_.emplace_back(active_node, state);
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
    Packer mine;
    if (communicator_.rank() != 0) {
      for (const auto& [node, configurations] : found_) {
        for (const auto& [key, c] : configurations) {
          mine.put(node);
          mine.put(c);
        }
      }
      found_.clear();
    }
    Packer my_transitions;
    for (const auto& [node, transition] : transitions_) {
      my_transitions.put(node);
      my_transitions.put(transition);
    }
    const std::vector<Bytes> all_transitions = communicator_.gather(my_transitions.take());
    Packer my_intermediate_states;
    for (const auto& [node, state] : intermediate_states_) {
      my_intermediate_states.put(node);
      my_intermediate_states.put(state);
    }
    const std::vector<Bytes> all_intermediate_states =
        communicator_.gather(my_intermediate_states.take());
    std::vector<Bytes> all = communicator_.gather(mine.take());
    TouchSpace result;
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      for (Bytes& bytes : all) {
        for (Unpacker of_rank(bytes); !of_rank.at_end();) {
          const auto node = of_rank.take<Index>();
          Configuration c = of_rank.take_configuration();
          found_[node].emplace(key_of(c), std::move(c));
        }
        bytes = {};
      }
      for (const Bytes& bytes : all_transitions) {
        for (Unpacker of_rank(bytes); !of_rank.at_end();) {
          const auto node = of_rank.take<Index>();
          const auto transition = of_rank.take<LevelTransition>();
          found_.at(node).at({transition.start, transition.start_level})
              .reached[neighbour_number(transition.start, transition.target)] =
              static_cast<std::int8_t>(transition.reached);
        }
      }
      std::map<Index, std::vector<IntermediateState>> intermediate_states;
      for (const Bytes& bytes : all_intermediate_states) {
        for (Unpacker of_rank(bytes); !of_rank.at_end();) {
          const auto node = of_rank.take<Index>();
          intermediate_states[node].push_back(of_rank.take_intermediate_state());
        }
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
      : path_(path), sites_(sites), communicator_(communicator) {
    // Rank 0 first: where it fails, no other rank leaves a file behind.
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      if (const auto left = files_of_ranks(); !left.empty() && !fs::exists(path_)) {
        throw InputError("The file " + path_.string() + " is gone, but " + left.front().string() +
                         " of its last run is there. Remove that too, or give another file name.");
      }
      file_ = StateSpaceFile::open_or_create(path_, scene, solver_tolerance);
      take_over_rank_files();
      for (const Site& site : sites_) file_->add_site(site);
    });
    agree(communicator_, [&] {
      if (communicator_.rank() == 0) return;
      file_ = StateSpaceFile::create(path_of_rank(communicator_.rank()), scene, solver_tolerance);
      for (const Site& site : sites_) file_->add_site(site);
    });
  }

  [[nodiscard]] Known known() const override {
    Known all;
    if (communicator_.rank() != 0) return all;
    for (const Site& site : sites_) {
      const Index node = site.active_node;
      for (const auto& found : {file_->read_summaries(node), file_->read_candidates(node)}) {
        for (const Configuration& c : found) all.configurations.emplace_back(node, c);
      }
      for (const LevelTransition& transition : file_->read_transitions(node)) {
        all.transitions.emplace_back(node, transition);
      }
    }
    return all;
  }

  void keep(Index active_node, const Configuration& found,
            const std::vector<IntermediateState>& way) override {
    file_->add(active_node, found, way);
  }

  void keep(Index active_node, const LevelTransition& transition) override {
    file_->add(active_node, transition);
  }

  void settle(Index active_node, const ConfigurationSummary& candidate,
              std::int32_t level) override {
    file_->settle(active_node, candidate, level);
  }

  [[nodiscard]] Configuration load(Index active_node,
                                   const ConfigurationSummary& summary) const override {
    Configuration configuration{summary, {}, {}, {}, {}};
    file_->read_fields(active_node, configuration);
    return configuration;
  }

  [[nodiscard]] TouchSpace finish(bool complete, double bound) override {
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) file_->close();
    });
    TouchSpace result;
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      take_over_rank_files();
      if (complete) {
        for (const Site& site : sites_) file_->set_complete(site.active_node, true);
      }
      file_->close();
      result = make_touch_space(StateSpaceFile::open_read_only(path_), bound);
    });
    return result;
  }

 private:
  [[nodiscard]] fs::path path_of_rank(int rank) const {
    return path_.string() + ".rank" + std::to_string(rank);
  }

  /// What ranks of this or of an earlier, killed run have left.
  [[nodiscard]] std::vector<fs::path> files_of_ranks() const {
    std::vector<fs::path> files;
    const std::string prefix = path_.filename().string() + ".rank";
    const fs::path folder = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
    std::error_code missing;  // StateSpaceFile says so
    for (const auto& entry : fs::directory_iterator(folder, missing)) {
      const std::string name = entry.path().filename().string();
      if (name.size() > prefix.size() && name.compare(0, prefix.size(), prefix) == 0 &&
          name.find_first_not_of("0123456789", prefix.size()) == std::string::npos) {
        files.push_back(entry.path());
      }
    }
    return files;
  }

  /// Merges and removes one after the other: never more than one of them is on the disk twice.
  void take_over_rank_files() {
    for (const fs::path& file : files_of_ranks()) {
      file_->merge({file});
      std::error_code error;
      if (!fs::remove(file, error)) {
        throw BackendError("The file " + file.string() + ", whose content is in " + path_.string() +
                           " now, cannot be removed: " + error.message() + ". Remove it by hand.");
      }
    }
  }

  fs::path path_;
  std::vector<Site> sites_;
  Communicator& communicator_;
  std::optional<StateSpaceFile> file_;
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
