// SPDX-License-Identifier: BSD-3-Clause
// Makes the transitions that the strategies ask for, on all ranks.
//
// The strategy of a tool space is at its owner, a rank that follows from a hash; where the plan is
// spread, each check-point has an owner, which knows of that one alone. A rank that finds a
// configuration keeps it in its record, tells the owner, and goes on depth first with what follows:
// so a start still has its factor, and a rank has no more states in memory than it is layers deep.
// What the strategy decides in addition, such as another start for a step that failed, the owner
// sends to the rank whose record has the start; where another rank owns the start, through that
// one, which answers when the start is found or given up. What is due waits in the order of the
// plan, the nearest to where the exploration begins first. A rank without tasks takes over some of
// another's, those that it would make last: whole batches.
//
// What an earlier run has left is on rank 0, which tells the owners. That is a task for each few
// configurations, so that the scheduler holds it back while mail lies unread.
//
// An exploration in several rounds is a run of the scheduler for each of them.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "exploration/exploration_plan.h"
#include "exploration/monitor.h"
#include "exploration/record.h"
#include "exploration/state_solver.h"
#include "exploration/transfer.h"
#include "schedule/scheduler.h"

namespace palpate {

class Engine final : public Worker {
 public:
  /// All arguments must outlive the engine.
  /// @param spaces They are in the order of their numbers. Before another run their plans may be
  ///   others, see plan_anew().
  /// @param network The network of the scheduler that runs the engine.
  /// @param report The engine adds what the tasks of this rank and the tool spaces that it owns
  /// have done.
  Engine(const std::vector<PlannedSpace>& spaces, StateSolver& solver, Record& record,
         const Network& network, Monitor& monitor, PrecomputeReport& report);

  /// Begins another round, by the plans that the spaces have now.
  void plan_anew();
  /// What is known of the check-points of a spread tool space that this rank owns: what was found,
  /// and what was given up. It may be asked for between runs.
  [[nodiscard]] const std::vector<ConfigurationSummary>& known_here(ToolSpaceId tool_space) const {
    return owned_.at(tool_space).known;
  }

  void start(Mail& mail) override;
  void receive(int from, const Bytes& message, Mail& mail) override;
  [[nodiscard]] bool has_work() const override;
  void work(Mail& mail) override;
  [[nodiscard]] Bytes give() override;
  void take(const Bytes& tasks, Mail& mail) override;
  void discard() override;

 private:
  struct Target {
    CheckPoint check_point{};
    /// The level of what is found: 0, or that of a candidate.
    std::int32_t level = 0;
    /// What earlier attempts, which failed, have taken.
    std::int32_t iterations = 0;
    double seconds = 0;
  };
  /// Transitions from one start.
  struct Batch {
    ToolSpaceId tool_space = 0;
    /// The start; not usable for the rest position, which has none.
    ConfigurationSummary start;
    /// The state of the start; null until it is needed, and where there is no start.
    std::shared_ptr<const Equilibrium> state;
    std::deque<Target> targets;
    [[nodiscard]] bool has_start() const { return start.usable(); }
  };
  /// A configuration, and the rank whose record has it.
  struct Held {
    ConfigurationSummary summary;
    int rank = 0;
  };
  /// What the owner of a start is asked for, and what it answers.
  struct Question {
    enum class Kind : char { want, refused, offer };
    Kind kind = Kind::want;
    Target target;
    CheckPoint start{};
    /// The answer is no since the start is beyond the force limit.
    bool beyond_limit = false;
  };
  /// A tool space that this rank owns, or a part of one.
  struct Owned {
    std::unique_ptr<ExplorationStrategy> strategy;
    /// All that earlier runs have left of it was told.
    bool has_recalled = false;
    /// What was asked before.
    std::vector<Question> postponed;
    /// Of a spread one: what is known of its check-points; those from which nothing is reached, and
    /// whether since they are beyond the force limit; and by start what waits for it.
    std::vector<ConfigurationSummary> known;
    std::map<CheckPoint, bool> ended;
    std::map<CheckPoint, std::vector<Target>> waiting;
    /// All usable configurations.
    std::map<StateKey, Held> held;
    /// Failed transitions that may be tried from another start; their figures are those of all
    /// attempts together.
    std::map<CheckPoint, ConfigurationSummary> failed;
    /// What ExplorationStrategy::num_expected() gave when it was last called.
    std::int64_t num_expected = 0;
  };

  void recall_some(Mail& mail);
  void recall(Unpacker& content, Mail& mail);
  void tell();
  void hand_out(ToolSpaceId tool_space, Mail& mail);
  /// What a transition seeks, with what earlier attempts have taken.
  [[nodiscard]] static Target target_of(const Owned& owned, const Transition& transition);
  void settle(ToolSpaceId tool_space, Owned& owned, const Settlement& settlement, Mail& mail);
  void take_in(ToolSpaceId tool_space, const ConfigurationSummary& found, int rank, Mail& mail);
  /// Where a check-point of a spread tool space was found or given up.
  void conclude(ToolSpaceId tool_space, Owned& owned, const ConfigurationSummary& found,
                bool is_recalled, Mail& mail);
  void ask(ToolSpaceId tool_space, const CheckPoint& of, const Question& question, Mail& mail);
  void hear(ToolSpaceId tool_space, const Question& question, Mail& mail);
  /// Sends what is wanted from starts that are known, a batch for each start.
  void send_wanted(Mail& mail);
  /// Has transitions from a start made by the rank that has it.
  void send(ToolSpaceId tool_space, const Held& start, const std::vector<Target>& targets,
            Mail& mail);
  /// Has a batch made when it is its turn; of those that are as far as another, after it.
  void enqueue(Batch&& batch);
  /// Takes out the batch that is made next.
  [[nodiscard]] Batch take_next();
  /// The batch that is made last of all.
  [[nodiscard]] Batch& last();
  [[nodiscard]] Batch take_last();
  /// Takes every other target out of a batch, for another rank.
  [[nodiscard]] static Batch split(Batch& batch);
  /// @param with_state Whether the state of the start is put in too: for a rank whose record does
  ///   not have it.
  void pack(Batch& batch, bool with_state, Packer& message);
  [[nodiscard]] static Batch unpack(Unpacker& message);
  /// Reads the state of a batch's start, unless it is there. Where no more than a part of it was
  /// kept, it is solved for again; one that is not found again leads nowhere.
  void load_state(Batch& batch);
  [[nodiscard]] const PlannedSpace& space(ToolSpaceId tool_space) const;
  [[nodiscard]] const ToolSpaceSetup& setup_of(ToolSpaceId tool_space) const {
    return space(tool_space).setup;
  }
  [[nodiscard]] std::uint64_t owner_key(ToolSpaceId tool_space, const CheckPoint& p) const {
    return space(tool_space).plan->owner_key(tool_space, p);
  }
  [[nodiscard]] Configuration make(const Batch& batch, const Target& target);
  /// Solves for the intermediate states on the straight way to a configuration that was found.
  /// Where that is aborted, the last one has that outcome.
  [[nodiscard]] std::vector<IntermediateState> make_way(const Batch& batch,
                                                        const ConfigurationSummary& found);

  const std::vector<PlannedSpace>& spaces_;
  int rank_;
  int num_ranks_;
  StateSolver& solver_;
  Record& record_;
  Monitor& monitor_;
  PrecomputeReport& report_;
  std::map<ToolSpaceId, Owned> owned_;
  bool is_first_round_ = true;
  /// On rank 0: the tool spaces whose owners wait for what is known of them, and what is left to
  /// tell of the first of these, null until it is read.
  std::deque<ToolSpaceId> to_recall_;
  std::unique_ptr<Known> known_;
  /// The targets that were given up here without any transition.
  std::int64_t num_not_reached_ = 0;
  /// What is wanted from starts that are known here, by start: it is sent together, so that a start
  /// is factorised once.
  std::map<std::pair<ToolSpaceId, CheckPoint>, std::vector<Target>> wanted_;
  /// What is due, by the distance from where the exploration begins.
  std::multimap<double, Batch> due_;
  /// Batches that are made before these, depth first: the last one is next.
  std::deque<Batch> begun_;
  /// The batch whose transition is being made.
  std::optional<Batch> current_;
};

}  // namespace palpate
