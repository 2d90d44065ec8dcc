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
 public:
  MemoryRecord(const Scene& scene, const std::vector<Site>& sites, double solver_tolerance,
               Communicator& communicator)
      : communicator_(communicator) {
    space_.scene = scene;
    space_.scene_hash = hash(scene);
    space_.solver_tolerance = solver_tolerance;
    for (const Site& site : sites) space_.sites.push_back({site, false, {}});
    sort(space_);
  }

  [[nodiscard]] std::vector<std::pair<Index, ConfigurationSummary>> known() const override {
    return {};
  }

  void keep(Index active_node, const Configuration& found) override {
    found_[active_node].emplace(found.check_point, found);
  }

  [[nodiscard]] Configuration load(Index active_node,
                                   const ConfigurationSummary& summary) const override {
    return found_.at(active_node).at(summary.check_point);
  }

  [[nodiscard]] TouchSpace finish(bool complete, double bound) override {
    Packer mine;
    if (communicator_.rank() != 0) {
      for (const auto& [node, configurations] : found_) {
        for (const auto& [check_point, c] : configurations) {
          mine.put(node);
          mine.put(c);
        }
      }
      found_.clear();
    }
    std::vector<Bytes> all = communicator_.gather(mine.take());
    TouchSpace result;
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      for (Bytes& bytes : all) {
        for (Unpacker of_rank(bytes); !of_rank.at_end();) {
          const auto node = of_rank.take<Index>();
          Configuration c = of_rank.take_configuration();
          found_[node].emplace(c.check_point, std::move(c));
        }
        bytes = {};
      }
      for (SiteSpace& site : space_.sites) {
        site.complete = complete;
        for (auto& [check_point, c] : found_[site.site.active_node]) {
          site.configurations.push_back(std::move(c));
        }
      }
      found_.clear();
      result = make_touch_space(space_, bound);
    });
    return result;
  }

 private:
  Communicator& communicator_;
  StateSpace space_;
  /// By active node and check-point.
  std::map<Index, std::map<CheckPoint, Configuration>> found_;
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

  [[nodiscard]] std::vector<std::pair<Index, ConfigurationSummary>> known() const override {
    std::vector<std::pair<Index, ConfigurationSummary>> all;
    if (communicator_.rank() != 0) return all;
    for (const Site& site : sites_) {
      for (const Configuration& c : file_->read_summaries(site.active_node)) {
        all.emplace_back(site.active_node, c);
      }
    }
    return all;
  }

  void keep(Index active_node, const Configuration& found) override {
    file_->add(active_node, found);
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
