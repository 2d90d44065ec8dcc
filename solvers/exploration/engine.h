// SPDX-License-Identifier: BSD-3-Clause
// The engine makes, on all ranks, the transitions that the strategies ask for.
//
// Each tool space has an owner rank, which follows from a hash of its key, and the owner has the
// strategy. If the plan is spread, each check-point has an owner rank of its own, which knows of
// that check-point alone. A rank that finds a configuration keeps it in its record, tells the
// owner, and goes on depth first with the targets that follow from it. So the start still has its
// factor, and a rank has no more states in memory than the space has layers. Other transitions,
// such as one from another start after a failure, are decided by the strategy. The owner sends them
// to the rank whose record has the start. If another rank owns the start, the owner of the target
// asks that rank, which answers as soon as the start is found or given up. Transitions that wait
// are in a priority queue (transition_queue.h). A rank without tasks takes over tasks from the end
// of another rank's queue, in whole batches where it can.
//
// Any rank may steer the exploration while it runs (steering.h). The steering goes to all ranks as
// mail, so that the end of the run is found as ever. If it withdraws targets, the run ends without
// them.
//
// What an earlier run has found is on rank 0, which tells the owners. Rank 0 does so by tasks of a
// few configurations each, so that the scheduler can hold them back while messages are unread.
//
// An exploration in several rounds runs the scheduler once for each round.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "exploration/exploration_plan.h"
#include "exploration/monitor.h"
#include "exploration/precompute_report.h"
#include "exploration/record.h"
#include "exploration/state_solver.h"
#include "exploration/transfer.h"
#include "exploration/transition_queue.h"
#include "schedule/scheduler.h"

namespace palpate {

class Engine final : public Worker {
 public:
  /// All arguments must outlive the engine.
  /// @param spaces The tool spaces, ordered by their keys. Their plans may change between two
  ///   runs, see plan_anew().
  /// @param network The network of the scheduler that runs the engine.
  /// @param report The engine adds the work of this rank, and the figures of the tool spaces that
  ///   this rank owns.
  Engine(const std::vector<PlannedSpace>& spaces, StateSolver& solver, Record& record,
         const Network& network, Monitor& monitor, PrecomputeReport& report);

  /// Begins another round of a tool space, with the plan that it has now.
  void plan_anew(const ToolSpaceKey& tool_space);
  /// What was found at the check-points of a spread tool space that this rank owns, or that they
  /// were given up; candidates are among it. And what transitions between levels have reached there
  /// in earlier runs. Call these between runs.
  [[nodiscard]] const std::vector<ConfigurationSummary>& known_here(ToolSpaceKey tool_space) const {
    return owned_.at(tool_space).known;
  }
  [[nodiscard]] const std::vector<LevelTransition>& recalled_here(ToolSpaceKey tool_space) const {
    return owned_.at(tool_space).recalled;
  }

  /// Has all ranks follow a steering from now on. Call this on any rank, within a run or between
  /// two. Of two ranks that steer at the same time, all ranks follow the same one.
  void steer(Steering steering);
  /// Whether the steering has withdrawn targets that this rank would make. Call this between runs.
  [[nodiscard]] bool has_withdrawn() const { return queue_.has_withdrawn(); }
  /// Whether the tasks were dropped, since a run was stopped.
  [[nodiscard]] bool is_discarded() const { return is_discarded_; }
  /// Says, on all ranks and between runs, that the record of rank 0 now has all configurations.
  void move_records_to_first_rank();

  void start(Mail& mail) override;
  void receive(int from, const Bytes& message, Mail& mail) override;
  [[nodiscard]] bool has_work() const override;
  void work(Mail& mail) override;
  [[nodiscard]] Bytes give() override;
  void take(const Bytes& tasks, Mail& mail) override;
  void discard() override;

 private:
  using Target = TransitionTarget;
  using Batch = TransitionBatch;
  /// A configuration, and the rank whose record has it.
  struct Located {
    ConfigurationSummary summary;
    int rank = 0;
  };
  /// A question to the owner of a start, or an answer to the owner of a target.
  struct Question {
    enum class Kind : char { request, refusal, offer };
    Kind kind = Kind::request;
    Target target;
    CheckPoint start{};
    /// If the answer is a refusal: the start is beyond the force limit.
    bool beyond_limit = false;

    [[nodiscard]] friend bool is_sound(Kind kind) {
      return kind >= Kind::request && kind <= Kind::offer;
    }
    template <class Visit>
    friend void for_each_part(Question& question, Visit&& visit) {
      visit(question.kind);
      visit(question.target);
      visit(question.start);
      visit(question.beyond_limit);
    }
  };
  /// The tool space, or the part of a spread one, that this rank owns.
  struct Owned {
    std::unique_ptr<ExplorationStrategy> strategy;
    /// Rank 0 has told everything that earlier runs have found of it.
    bool has_recalled = false;
    /// Questions that came before has_recalled.
    std::vector<Question> postponed;
    /// The following four are for a spread tool space: what was found at its check-points, or that
    /// they were given up; what transitions between levels have reached in earlier runs; starts
    /// that lead nowhere, with true for those beyond the force limit; and the targets that wait for
    /// each start.
    std::vector<ConfigurationSummary> known;
    std::vector<LevelTransition> recalled;
    std::map<CheckPoint, bool> ended;
    std::map<CheckPoint, std::vector<Target>> waiting;
    /// The usable configurations, with their ranks.
    std::map<StateKey, Located> located;
    /// Failed transitions that may be tried from another start. Iterations and time are the sum
    /// over all attempts.
    std::map<CheckPoint, ConfigurationSummary> failed;
    /// The value of ExplorationStrategy::num_expected() that the report has counted already.
    std::int64_t num_expected = 0;
  };

  void recall_some(Mail& mail);
  void recall(Unpacker& content, Mail& mail);
  void tell();
  /// Sends the transitions that a strategy asks for to the ranks that have their starts, and
  /// records the targets that it has given up.
  void send_transitions(ToolSpaceKey tool_space, Mail& mail);
  /// The target of a transition, with the iterations and the time of earlier attempts.
  [[nodiscard]] static Target target_of(const Owned& owned, const Transition& transition);
  void settle(ToolSpaceKey tool_space, Owned& owned, const Settlement& settlement, Mail& mail);
  void take_in(ToolSpaceKey tool_space, const ConfigurationSummary& found, int rank, Mail& mail);
  /// Answers those that wait for a check-point of a spread tool space which was found, or given up.
  void answer_waiting(ToolSpaceKey tool_space, Owned& owned, const ConfigurationSummary& found,
                      bool is_recalled, Mail& mail);
  void ask(ToolSpaceKey tool_space, const CheckPoint& of, const Question& question, Mail& mail);
  void hear(ToolSpaceKey tool_space, const Question& question, Mail& mail);
  /// Sends the transitions that wait for a start which is known here. They are grouped by start, so
  /// that each start is factorised once.
  void send_ready(Mail& mail);
  /// Sends transitions from one start to the rank whose record has the start.
  void send(ToolSpaceKey tool_space, const Located& start, const std::vector<Target>& targets,
            Mail& mail);
  /// Sends the latest steering to the other ranks.
  void send_steering(Mail& mail);
  /// Follows a steering, if it is later than the one that is followed now.
  void hear_steering(Unpacker& content);
  /// Takes every other target out of a batch, for another rank.
  [[nodiscard]] static Batch split(Batch& batch);
  /// @param with_state Also packs the state of the start, for a rank whose record does not have it.
  void pack(Batch& batch, bool with_state, Packer& message);
  [[nodiscard]] Batch unpack(Unpacker& message) const;
  /// Take from a message the key of a tool space, the key of one that this rank owns, or a
  /// part of it, and a configuration.
  /// @throws BackendError there is none with that key, or the configuration is not of its grid.
  [[nodiscard]] ToolSpaceKey take_space(Unpacker& content) const;
  [[nodiscard]] ToolSpaceKey take_owned_space(Unpacker& content) const;
  [[nodiscard]] ConfigurationSummary take_summary(Unpacker& content, ToolSpaceKey tool_space) const;
  /// Reads the state of a batch's start, unless it was read before. If only a part of its fields
  /// was kept, the equilibrium is solved for again; if it is not found again, its outcome says so
  /// and the transitions from it fail.
  void load_state(Batch& batch);
  /// Whether load_state() would solve for the state of a batch.
  [[nodiscard]] bool needs_solve(const Batch& batch) const;
  [[nodiscard]] const PlannedSpace& space(ToolSpaceKey tool_space) const {
    return find_space(spaces_, tool_space);
  }
  [[nodiscard]] const ToolSpaceSetup& setup_of(ToolSpaceKey tool_space) const {
    return space(tool_space).setup;
  }
  [[nodiscard]] std::uint64_t owner_key(ToolSpaceKey tool_space, const CheckPoint& p) const {
    return space(tool_space).plan->owner_key(tool_space, p);
  }
  [[nodiscard]] Configuration make(const Batch& batch, const Target& target);
  /// Solves for the intermediate states on the straight line from the start to a configuration that
  /// was found. If a solve is aborted, the last state has that outcome.
  [[nodiscard]] std::vector<IntermediateState> make_way(const Batch& batch,
                                                        const ConfigurationSummary& found);

  const std::vector<PlannedSpace>& spaces_;
  int rank_;
  int num_ranks_;
  StateSolver& solver_;
  Record& record_;
  Monitor& monitor_;
  PrecomputeReport& report_;
  std::map<ToolSpaceKey, Owned> owned_;
  /// What the next run begins with: what earlier runs have found, a new round, or the tasks that
  /// are left of a run that was paused.
  enum class Begin : char { recall, plan, resume };
  Begin begin_ = Begin::recall;
  bool is_discarded_ = false;
  /// On rank 0: the tool spaces whose owners were not told yet what earlier runs have found, and
  /// what is left to tell of the first of them; null until it is read.
  std::deque<ToolSpaceKey> to_recall_;
  std::unique_ptr<Known> known_;
  /// The number of targets that were given up here without any transition.
  std::int64_t num_not_reached_ = 0;
  /// Targets that wait for a start which is known here, by start.
  std::map<std::pair<ToolSpaceKey, CheckPoint>, std::vector<Target>> ready_;
  TransitionQueue queue_;
  /// The number and the rank of the steering that is followed; the greater pair is the later one.
  std::pair<std::int64_t, int> steering_version_{0, 0};
  /// A steering that was given between two runs, for the other ranks.
  std::optional<Steering> to_send_;
  /// The batches that rank 0 makes now, since its record has their starts.
  std::vector<Batch> moved_;
  /// The batch whose transition is being made.
  std::optional<Batch> current_;
};

}  // namespace palpate
