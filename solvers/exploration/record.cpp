// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/record.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "exploration/rank_files.h"
#include "exploration/reduction.h"
#include "exploration/transfer.h"
#include "fields/make_touch_space.h"
#include "storage/stored_touch_space.h"

namespace palpate {
namespace storage {

template <class Visit>
void for_each_part(BasisBox& box, Visit&& visit) {
  visit(box.number);
  visit(box.box);
  visit(box.keep);
  visit(box.error);
}

}  // namespace storage

namespace {

/// The rounding error of a ratio of two stored numbers.
constexpr double kRounding = 1e-12;

namespace fs = std::filesystem;

/// Results of the ranks, without fields.
struct Parts {
  std::vector<std::pair<ToolSpaceKey, ConfigurationSummary>> configurations;
  std::vector<std::pair<ToolSpaceKey, LevelTransition>> transitions;
  std::vector<std::pair<ToolSpaceKey, IntermediateState>> intermediate_states;

  /// Moves the results of all ranks to rank 0.
  /// @note Collective
  void gather_all(Communicator& communicator) {
    gather(configurations, communicator);
    gather(transitions, communicator);
    gather(intermediate_states, communicator);
  }
};

/// The spaces of active nodes of a body are reduced to modes of its surface, region by region on
/// all ranks.
ReductionTask task_of(const SpaceBody& body, const std::vector<ToolSpaceSetup>& setups, Keep keep,
                      double bound) {
  ReductionTask task;
  task.keep = keep;
  task.bound = bound;
  task.points = kept_points(body.mesh(), make_surface(body.scene->body), keep);
  for (const ToolSpaceSetup& setup : setups) {
    if (setup.presses() || setup.body != body.number) continue;
    for (ReductionRegion& region : plan_regions(setup, {}, {})) {
      task.regions.push_back(std::move(region));
    }
  }
  return task;
}

/// A configuration whose fields count from the body at rest, as they are reduced.
Configuration from_rest(const SpaceBody& body, Configuration configuration) {
  count_from_rest(body.at_rest, configuration);
  return configuration;
}

/// The states of one body.
StateHolders holders_of(const SpaceBody& body, const StateHolders& all) {
  StateHolders holders;
  for (const auto& [key, holder] : all) {
    if (key.tool_space.body == body.number) holders.emplace(key, holder);
  }
  return holders;
}

/// Makes the touch space from the results of all ranks.
/// @param parts The results of this rank.
/// @param whole The states whose fields this rank has.
/// @returns The touch space on rank 0; an empty one elsewhere.
/// @note Collective
TouchSpace assemble(const std::vector<SpaceBody>& bodies, std::vector<ToolSpaceSetup> setups,
                    Parts parts, const std::vector<StateKey>& whole,
                    const std::function<Configuration(const StateKey&)>& load, double bound,
                    Communicator& communicator) {
  TouchSpace space;
  std::optional<ShownSurface> shown;
  agree(communicator, [&] {
    std::sort(setups.begin(), setups.end(),
              [](const ToolSpaceSetup& a, const ToolSpaceSetup& b) { return a.key() < b.key(); });
    if (communicator.rank() != 0) return;
    shown.emplace(bodies);
    space = make_empty_touch_space(*shown);
  });
  const StateHolders holders = find_holders(whole, communicator);
  std::map<ToolSpaceKey, FieldBasis> bases;
  std::map<StateKey, ReducedFields> fields;
  for (const SpaceBody& body : bodies) {
    ReductionTask task;
    agree(communicator, [&] {
      task = task_of(body, setups, Keep::touch, bound);
      task.load = load;
      task.holders = holders_of(body, holders);
    });
    reduce_on_ranks(task, communicator,
                    [&](const ReductionRegion& region, const std::vector<StateKey>& keys,
                        PackedReduction reduction) {
                      bases[region.tool_space] =
                          *unpack(reduction.basis, static_cast<std::int64_t>(task.points.size()));
                      for (std::size_t i = 0; i < keys.size(); ++i) {
                        fields.emplace(keys[i], std::move(reduction.fields[i]));
                      }
                    });
  }
  parts.gather_all(communicator);
  agree(communicator, [&] {
    if (communicator.rank() != 0) return;
    std::map<StateKey, ConfigurationSummary> found;
    for (const auto& [id, c] : parts.configurations) {
      const auto [there, is_new] = found.emplace(key_of(id, c), c);
      // A configuration that failed in an earlier run may have been found in this one.
      if (!is_new && !there->second.usable()) there->second = c;
    }
    std::sort(parts.intermediate_states.begin(), parts.intermediate_states.end());
    for (const ToolSpaceSetup& setup : setups) {
      std::vector<ConfigurationSummary> configurations;
      std::vector<const ReducedFields*> of_configurations;
      for (auto c = found.lower_bound({setup.key(), {INT32_MIN, INT32_MIN, INT32_MIN}, INT32_MIN});
           c != found.end() && c->first.tool_space == setup.key(); ++c) {
        configurations.push_back(c->second);
        const auto reduced = fields.find(c->first);
        of_configurations.push_back(reduced == fields.end() ? nullptr : &reduced->second);
      }
      for (const auto& [id, transition] : parts.transitions) {
        // A run that was killed may have lost its last configurations.
        const bool is_lost = transition.reached >= 0 &&
                             found.count({id, transition.target, transition.reached}) == 0;
        if (id == setup.key() && !is_lost) note(transition, configurations);
      }
      std::vector<IntermediateState> states;
      for (const auto& [id, state] : parts.intermediate_states) {
        if (id == setup.key()) states.push_back(state);
      }
      const auto basis = bases.find(setup.key());
      add_tool_space(find_body(bodies, setup.body), *shown, setup, configurations,
                     std::move(states), basis == bases.end() ? nullptr : &basis->second,
                     of_configurations, space);
    }
    add_clearances(bodies, space);
  });
  return space;
}

class MemoryRecord final : public Record {
 public:
  MemoryRecord(const std::vector<SpaceBody>& bodies, const std::vector<ToolSpaceSetup>& setups,
               Communicator& communicator)
      : bodies_(bodies), setups_(setups), communicator_(communicator) {}

  [[nodiscard]] Known known(ToolSpaceKey /*tool_space*/) const override { return {}; }
  [[nodiscard]] std::vector<std::string> damaged() const override { return {}; }

  void keep(ToolSpaceKey tool_space, const Configuration& found,
            const std::vector<IntermediateState>& way) override {
    found_.emplace(key_of(tool_space, found), found);
    for (const IntermediateState& state : way) {
      intermediate_states_.emplace_back(tool_space, state);
    }
  }

  void keep(ToolSpaceKey tool_space, const LevelTransition& transition) override {
    transitions_.emplace_back(tool_space, transition);
  }

  void settle(ToolSpaceKey tool_space, const ConfigurationSummary& candidate,
              std::int32_t level) override {
    auto settled = found_.extract(key_of(tool_space, candidate));
    if (level < 0) return;
    settled.mapped().level = level;
    settled.key().level = level;
    found_.insert(std::move(settled));
  }

  [[nodiscard]] Configuration load(ToolSpaceKey tool_space,
                                   const ConfigurationSummary& summary) const override {
    return found_.at(key_of(tool_space, summary));
  }

  void resume() override {}
  [[nodiscard]] bool has_moved() const override { return false; }

  [[nodiscard]] TouchSpace finish(bool /*complete*/, double bound) override {
    return publish(bound);
  }

  [[nodiscard]] TouchSpace publish(double bound) override {
    Parts parts;
    std::vector<StateKey> whole;
    for (const auto& [key, c] : found_) {
      if (c.level < 0) continue;
      parts.configurations.emplace_back(key.tool_space, c);
      if (c.usable()) whole.push_back(key);
    }
    parts.transitions = transitions_;
    parts.intermediate_states = intermediate_states_;
    return assemble(
        bodies_, setups_, std::move(parts), whole,
        [this](const StateKey& key) {
          return from_rest(find_body(bodies_, key.tool_space.body), found_.at(key));
        },
        bound, communicator_);
  }

 private:
  const std::vector<SpaceBody>& bodies_;
  std::vector<ToolSpaceSetup> setups_;
  Communicator& communicator_;
  std::map<StateKey, Configuration> found_;
  std::vector<std::pair<ToolSpaceKey, LevelTransition>> transitions_;
  std::vector<std::pair<ToolSpaceKey, IntermediateState>> intermediate_states_;
};

class FileRecord final : public Record {
 public:
  FileRecord(const fs::path& path, const std::vector<SpaceBody>& bodies,
             const std::vector<ToolSpaceSetup>& setups, double solver_tolerance, Keep keep,
             double bound, Communicator& communicator)
      : path_(path),
        bodies_(bodies),
        setups_(setups),
        keep_(keep),
        bound_(bound),
        communicator_(communicator),
        files_(path, bodies, solver_tolerance, communicator) {
    open();
  }

  [[nodiscard]] Known known(ToolSpaceKey tool_space) const override {
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

  [[nodiscard]] std::vector<IntermediateState> known_intermediate_states(
      ToolSpaceKey tool_space) const override {
    if (communicator_.rank() != 0) return {};
    return files_.own().read_intermediate_states(tool_space);
  }

  [[nodiscard]] std::vector<std::string> damaged() const override { return files_.damaged(); }

  void keep(ToolSpaceKey tool_space, const Configuration& found,
            const std::vector<IntermediateState>& way) override {
    files_.own().add(tool_space, found, way);
  }

  void keep(ToolSpaceKey tool_space, const LevelTransition& transition) override {
    files_.own().add(tool_space, transition);
  }

  void settle(ToolSpaceKey tool_space, const ConfigurationSummary& candidate,
              std::int32_t level) override {
    files_.own().settle(tool_space, candidate, level);
  }

  [[nodiscard]] Configuration load(ToolSpaceKey tool_space,
                                   const ConfigurationSummary& summary) const override {
    Configuration configuration{summary, {}, {}, {}, {}};
    if (!files_.own().read_fields(tool_space, configuration)) {
      throw InputError("A part of " + path_.string() + " was damaged while it was in use: " +
                       files_.own().left_out().front() + ". Check the disk and run again.");
    }
    return configuration;
  }

  [[nodiscard]] Keep kept(ToolSpaceKey tool_space,
                          const ConfigurationSummary& summary) const override {
    return files_.own().keep_of(tool_space, summary);
  }

  [[nodiscard]] TouchSpace publish(double bound) override { return finish(false, bound); }
  void resume() override { open(); }
  [[nodiscard]] bool has_moved() const override { return communicator_.size() > 1; }

  [[nodiscard]] TouchSpace finish(bool complete, double bound) override {
    if (complete && keep_ < Keep::all) {
      reduce_into_file(bound);
      files_.discard_others();
    } else {
      if (!has_more_than_whole_fields()) return finish_whole(complete, bound);
      files_.merge();
    }
    TouchSpace result;
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      StateSpaceFile& file = files_.own();
      if (complete) set_complete();
      file.shrink();
      file.close();
      result = make_touch_space(StateSpaceFile::open_read_only(path_), bound);
    });
    return result;
  }

 private:
  /// @throws InputError the file keeps less than is asked for, or with a larger error.
  /// @note Collective
  void open() {
    files_.open([&](StateSpaceFile& file) {
      const Keep kept = file.bases().keep();
      if (kept < keep_) {
        throw InputError(path_.string() + " keeps less of the displacements (Keep is " +
                         name_of(kept) + ") than is asked for (" + name_of(keep_) +
                         "), and what it has left out is lost. Ask for " + name_of(kept) +
                         ", or give another file name.");
      }
      require_bound(file, bound_);
      for (const ToolSpaceSetup& setup : setups_) file.add_tool_space(setup);
    });
  }

  /// @throws InputError the fields that the file keeps of these spaces have a larger error than is
  ///   asked for.
  void require_bound(const StateSpaceFile& file, double bound) const {
    for (const ToolSpaceSetup& setup : setups_) {
      for (const storage::BasisBox& box : file.bases().list(setup.key())) {
        if (box.error <= bound * (1 + kRounding)) continue;
        std::ostringstream text;
        text
            << path_.string() << " keeps the displacements of " << setup.name()
            << " with an error of " << box.error
            << " of the largest, more than is asked for (DisplacementBound is " << bound
            << "), and what it has left out is lost. Ask for an error that is not smaller, or give "
               "another file name.";
        throw InputError(text.str());
      }
    }
  }

  void set_complete() {
    for (const ToolSpaceSetup& setup : setups_) files_.own().set_complete(setup.key(), true);
  }

  /// Whether the file has reduced fields, or bodies that are not of this run.
  /// @note Collective
  [[nodiscard]] bool has_more_than_whole_fields() {
    bool has_more = false;
    agree(communicator_, [&] {
      const StateSpaceFile& file = files_.own();
      has_more = file.bases().keep() < Keep::all || file.list_bodies().size() > bodies_.size();
    });
    return any(communicator_, has_more);
  }

  /// The tool spaces in the file of rank 0, on all ranks.
  /// @note Collective
  [[nodiscard]] std::vector<ToolSpaceSetup> all_setups() {
    std::vector<ToolSpaceSetup> setups;
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      for (const ToolSpace& space : files_.own().read_tool_spaces()) setups.push_back(space.setup);
    });
    return of_first(setups, communicator_);
  }

  /// The results that the file of this rank has of some tool spaces.
  [[nodiscard]] Parts read_parts(const std::vector<ToolSpaceSetup>& setups) const {
    Parts parts;
    for (const ToolSpaceSetup& setup : setups) {
      const StateSpaceFile& file = files_.own();
      for (const Configuration& c : file.read_summaries(setup.key())) {
        ConfigurationSummary summary = c;
        summary.reached = ConfigurationSummary().reached;
        parts.configurations.emplace_back(setup.key(), summary);
      }
      for (const LevelTransition& transition : file.read_transitions(setup.key())) {
        parts.transitions.emplace_back(setup.key(), transition);
      }
      for (const IntermediateState& state : file.read_intermediate_states(setup.key())) {
        parts.intermediate_states.emplace_back(setup.key(), state);
      }
    }
    return parts;
  }

  [[nodiscard]] std::vector<StateKey> list_whole(const std::vector<ToolSpaceSetup>& setups) const {
    std::vector<StateKey> whole;
    for (const ToolSpaceSetup& setup : setups) {
      const std::vector<StateKey> of_space = files_.own().list_whole(setup.key());
      whole.insert(whole.end(), of_space.begin(), of_space.end());
    }
    return whole;
  }

  /// Reads a configuration, with its fields counted from the body at rest, as they are reduced.
  [[nodiscard]] Configuration load(const StateKey& key) const {
    ConfigurationSummary summary;
    summary.check_point = key.check_point;
    summary.level = key.level;
    return from_rest(find_body(bodies_, key.tool_space.body), load(key.tool_space, summary));
  }

  /// Finishes a file that has all fields. The tool spaces of other runs in it are included.
  /// @note Collective
  [[nodiscard]] TouchSpace finish_whole(bool complete, double bound) {
    const std::vector<ToolSpaceSetup> setups = all_setups();
    Parts parts;
    std::vector<StateKey> whole;
    agree(communicator_, [&] {
      parts = read_parts(setups);
      whole = list_whole(setups);
    });
    TouchSpace result = assemble(
        bodies_, setups, std::move(parts), whole, [this](const StateKey& key) { return load(key); },
        bound, communicator_);
    files_.merge();
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      if (complete) set_complete();
      result.left_out = files_.own().left_out();
      result.file = path_.string();
      files_.own().close();
    });
    return result;
  }

  /// Reduces the results of this run into the file of rank 0, in one transaction.
  /// @note Collective
  void reduce_into_file(double bound) {
    Parts parts;
    std::vector<StateKey> own;
    agree(communicator_, [&] {
      own = list_whole(setups_);
      if (communicator_.rank() == 0) return;
      parts = read_parts(setups_);
    });
    parts.gather_all(communicator_);
    const std::vector<ReductionTask> tasks = plan_reduction(own, bound);
    // The other ranks keep their files until rank 0 has committed the transaction.
    agree(communicator_, [&] {
      if (communicator_.rank() == 0) {
        files_.own().change_together([&] { reduce(tasks, parts); });
      } else {
        reduce(tasks, parts);
      }
    });
  }

  /// Plans how the fields of each body are reduced.
  /// @param own The states whose fields are here.
  /// @note Collective
  [[nodiscard]] std::vector<ReductionTask> plan_reduction(const std::vector<StateKey>& own,
                                                          double bound) {
    // The bases that the file already has determine what is kept of the other regions.
    Packer mine;
    agree(communicator_, [&] {
      if (communicator_.rank() == 0) {
        for (const ToolSpaceSetup& setup : setups_) {
          const auto of_space = files_.own().bases().list(setup.key());
          mine.put_list(of_space);
        }
      }
      for (const SpaceBody& body : bodies_) mine.put(num_pressures_of(body, own));
    });
    const std::vector<Bytes> all = communicator_.all_gather(mine.take());
    const StateHolders holders = find_holders(own, communicator_);
    std::vector<ReductionTask> tasks;
    agree(communicator_, [&] {
      Keep keep = keep_;
      std::vector<Unpacker> contents(all.begin(), all.end());
      std::vector<std::vector<storage::BasisBox>> boxes(setups_.size());
      for (auto& of_space : boxes) {
        of_space = contents.front().take_list<std::vector<storage::BasisBox>>();
        for (const storage::BasisBox& box : of_space) keep = box.keep;
      }
      std::map<ToolSpaceKey, std::vector<StateKey>> of_spaces;
      for (const auto& [key, holder] : holders) of_spaces[key.tool_space].push_back(key);
      for (const SpaceBody& body : bodies_) {
        ReductionTask& task = tasks.emplace_back();
        for (Unpacker& content : contents) {
          task.num_pressures =
              std::max<Eigen::Index>(task.num_pressures, content.take<std::int32_t>());
        }
        if (keep == Keep::touch) task.num_pressures = 0;
        task.keep = keep;
        task.bound = bound;
        task.points = kept_points(body.mesh(), make_surface(body.scene->body), keep);
        task.load = [this](const StateKey& key) { return load(key); };
        task.holders = holders_of(body, holders);
        for (std::size_t s = 0; s < setups_.size(); ++s) {
          if (setups_[s].body != body.number) continue;
          plan(setups_[s], boxes[s], of_spaces[setups_[s].key()], task.regions);
        }
      }
    });
    return tasks;
  }

  /// The number of pressures of a body, if a state of it is here; else 0.
  [[nodiscard]] std::int32_t num_pressures_of(const SpaceBody& body,
                                              const std::vector<StateKey>& own) const {
    const auto state = std::find_if(own.begin(), own.end(), [&](const StateKey& key) {
      return key.tool_space.body == body.number;
    });
    return state == own.end() ? 0 : static_cast<std::int32_t>(load(*state).p.size());
  }

  /// Adds the regions of a tool space to a list.
  void plan(const ToolSpaceSetup& setup, const std::vector<storage::BasisBox>& boxes,
            const std::vector<StateKey>& keys, std::vector<ReductionRegion>& regions) {
    std::vector<ReductionRegion> there;
    for (const storage::BasisBox& box : boxes) {
      ReductionRegion& region = there.emplace_back();
      region.number = box.number;
      region.box = box.box;
      if (communicator_.rank() == 0)
        region.begin = files_.own().bases().read(setup.key(), box.number);
    }
    for (ReductionRegion& region : plan_regions(setup, keys, there)) {
      regions.push_back(std::move(region));
    }
  }

  /// @param parts On rank 0: the results of the other ranks.
  /// @note Collective
  void reduce(const std::vector<ReductionTask>& tasks, const Parts& parts) {
    StateSpaceFile& file = files_.own();
    std::map<StateKey, ConfigurationSummary> found;
    agree(communicator_, [&] {
      if (communicator_.rank() != 0) return;
      for (const auto& [id, c] : parts.configurations) {
        if (!file.is_of_use(id, c)) continue;
        file.add(id, c, ReducedFields());
        found.emplace(key_of(id, c), c);
      }
      for (const auto& [id, transition] : parts.transitions) file.add(id, transition);
      for (const auto& [id, state] : parts.intermediate_states) file.add(id, state);
      for (const ToolSpaceSetup& setup : setups_) {
        for (const Configuration& c : file.read_summaries(setup.key())) {
          found.emplace(key_of(setup.key(), c), c);
        }
      }
    });
    const auto take = [&](const ReductionRegion& region, const std::vector<StateKey>& keys,
                          const PackedReduction& reduction) {
      file.bases().add(region.tool_space, region.number, reduction.basis);
      for (std::size_t i = 0; i < keys.size(); ++i) {
        file.add(region.tool_space, found.at(keys[i]), reduction.fields[i]);
      }
    };
    for (const ReductionTask& task : tasks) reduce_on_ranks(task, communicator_, take);
  }

  fs::path path_;
  const std::vector<SpaceBody>& bodies_;
  std::vector<ToolSpaceSetup> setups_;
  Keep keep_;
  double bound_;
  Communicator& communicator_;
  RankFiles files_;
};

}  // namespace

std::unique_ptr<Record> make_memory_record(const std::vector<SpaceBody>& bodies,
                                           const std::vector<ToolSpaceSetup>& setups,
                                           Communicator& communicator) {
  return std::make_unique<MemoryRecord>(bodies, setups, communicator);
}

std::unique_ptr<Record> make_file_record(const fs::path& path, const std::vector<SpaceBody>& bodies,
                                         const std::vector<ToolSpaceSetup>& setups,
                                         double solver_tolerance, Keep keep, double bound,
                                         Communicator& communicator) {
  return std::make_unique<FileRecord>(path, bodies, setups, solver_tolerance, keep, bound,
                                      communicator);
}

}  // namespace palpate
