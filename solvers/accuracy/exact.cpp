// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy/exact.h"

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "accuracy/draw.h"
#include "base/error.h"
#include "equilibrium/tangent_solver.h"
#include "exploration/body_solvers.h"
#include "exploration/monitor.h"
#include "exploration/rank_files.h"
#include "exploration/settle.h"
#include "exploration/transfer.h"

namespace palpate {
namespace {

/// The largest number of points with one anchor that make a task.
constexpr std::size_t kTaskSize = 16;

/// The solvers of bodies that a rank keeps: tasks of one tool space follow each other.
constexpr std::size_t kMostSolvers = 2;

/// If a press and a slide lead to forces that differ by more than this share, they lead to
/// different branches. On one branch the solver's tolerance leaves a difference a thousand times
/// smaller.
constexpr double kSameBranch = 1e-3;

/// Points that one rank solves one after the other: a walk, or some points with the same anchor.
struct Task {
  std::int32_t tool_space = 0;
  /// Indices into the list of the tool space's points.
  std::vector<std::int32_t> points;
};

void put(const Task& task, Packer& message) {
  message.put(task.tool_space);
  message.put_list(task.points);
}

/// @param points Those of all tool spaces, of which the task names some.
Task take_task(Unpacker& content, const std::vector<std::vector<TestPoint>>& points) {
  const auto tool_space = content.take<std::int32_t>();
  Unpacker::require(tool_space >= 0 && static_cast<std::size_t>(tool_space) < points.size());
  Task task{tool_space, content.take_list<std::vector<std::int32_t>>()};
  const auto size = points[static_cast<std::size_t>(tool_space)].size();
  Unpacker::require(std::all_of(task.points.begin(), task.points.end(), [&](std::int32_t point) {
    return point >= 0 && static_cast<std::size_t>(point) < size;
  }));
  return task;
}

/// The tasks of a tool space, for points that are not known; a walk is always solved as a whole.
/// @param known The known points in their order.
std::vector<Task> make_tasks(std::int32_t tool_space, const std::vector<TestPoint>& points,
                             const std::vector<TestPoint>& known, const ToolSpaceSetup& setup) {
  using Key = std::array<double, 3>;
  std::map<Key, std::vector<std::int32_t>> of_anchor;
  std::map<std::int32_t, std::vector<std::int32_t>> of_walk;
  std::set<std::int32_t> incomplete;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TestPoint& point = points[i];
    const auto place = static_cast<std::int32_t>(i);
    const bool is_known = std::binary_search(known.begin(), known.end(), point);
    if (point.kind == TestKind::walk) {
      of_walk[point.number / kWalkLength].push_back(place);
      if (!is_known) incomplete.insert(point.number / kWalkLength);
    } else if (!is_known) {
      // Places of a tool that presses have no anchor.
      const Vec3 anchor =
          setup.presses() ? Vec3::Zero().eval() : anchor_of(point.t, setup.grid.half_width);
      of_anchor[{anchor[0], anchor[1], anchor[2]}].push_back(place);
    }
  }
  std::vector<Task> tasks;
  for (const std::int32_t walk : incomplete) tasks.push_back({tool_space, of_walk.at(walk)});
  for (const auto& [anchor, places] : of_anchor) {
    for (std::size_t first = 0; first < places.size(); first += kTaskSize) {
      const auto begin = places.begin() + static_cast<std::ptrdiff_t>(first);
      const auto left = static_cast<std::ptrdiff_t>(std::min(kTaskSize, places.size() - first));
      tasks.push_back({tool_space, {begin, begin + left}});
    }
  }
  return tasks;
}

/// Solves the tasks of one rank.
class Solver final : public Worker {
 public:
  using Keep = std::function<void(std::int32_t tool_space, const TestPoint& point)>;

  /// @param points The points of all tool spaces.
  /// @param num_known The number of all points that are known.
  /// @param first The body whose surface is shown.
  Solver(const SpaceBody& first, const std::vector<ToolSpaceSetup>& setups,
         const std::vector<std::vector<TestPoint>>& points, std::int64_t num_known,
         StateSolver& states, Monitor& monitor, Keep keep)
      : setups_(setups),
        points_(points),
        num_known_(num_known),
        states_(states),
        monitor_(monitor),
        keep_(std::move(keep)) {
    const TetMesh& mesh = first.mesh();
    const Surface surface = make_surface(first.scene->body);
    for (const Index p : sample_points(surface)) {
      samples_.push_back(surface.mesh_points[p]);
      at_rest_.push_back(place_at_rest(mesh, first.at_rest, samples_.back()) -
                         mesh.points[samples_.back()]);
    }
    for (const auto& of_tool_space : points)
      num_all_ += static_cast<std::int64_t>(of_tool_space.size());
  }

  /// The tasks of this rank.
  std::deque<Task> tasks;
  std::int64_t num_solved = 0;

  void start(Mail& mail) override { monitor_.set_mail(&mail); }

  void receive(int from, const Bytes& message, Mail& /*mail*/) override {
    Unpacker content(message);
    monitor_.hear(from, content);
  }

  [[nodiscard]] bool has_work() const override { return !tasks.empty(); }

  void work(Mail& mail) override {
    tell(mail);
    const Task task = tasks.front();
    tasks.pop_front();
    const bool is_solved = setup_of(task).presses() ? press(task, mail) : move(task, mail);
    if (!is_solved) mail.stop();
  }

  [[nodiscard]] Bytes give() override {
    Packer share;
    for (std::size_t half = tasks.size() / 2; half > 0; --half) {
      put(tasks.back(), share);
      tasks.pop_back();
    }
    return share.take();
  }

  void take(const Bytes& share, Mail& /*mail*/) override {
    for (Unpacker content(share); !content.at_end();) tasks.push_back(take_task(content, points_));
  }

  void discard() override { tasks.clear(); }

 private:
  [[nodiscard]] const ToolSpaceSetup& setup_of(const Task& task) const {
    return setups_[static_cast<std::size_t>(task.tool_space)];
  }
  [[nodiscard]] TestPoint point_of(const Task& task, std::int32_t place) const {
    return points_[static_cast<std::size_t>(task.tool_space)][static_cast<std::size_t>(place)];
  }

  /// Solves a task of an active node.
  /// @returns false: it was aborted.
  bool move(const Task& task, Mail& mail) {
    const ToolSpaceSetup& setup = setup_of(task);
    if (held_ != task.tool_space) {
      rest_ = states_.begin(setup, Vec3::Zero(), Tangent::factorised);
      held_ = task.tool_space;
    }
    const TestPoint first = point_of(task, task.points.front());
    const bool walks = first.kind == TestKind::walk;
    Equilibrium start = rest_;
    if (!walks) {
      const Vec3 anchor = anchor_of(first.t, setup.grid.half_width);
      if (!anchor.isZero()) start = states_.solve(setup, anchor, rest_, Tangent::factorised);
      if (start.outcome == Outcome::aborted) return false;
      if (!is_regular(start)) start = rest_;
    }
    // Once a walk has crossed a fold, all its later points are marked.
    Flags on_the_way = 0;
    for (const std::int32_t i : task.points) {
      TestPoint point = point_of(task, i);
      Equilibrium found = states_.solve(setup, point.t, start, Tangent::iterated);
      if (!walks && !is_regular(found) && found.outcome != Outcome::aborted) {
        const double seconds = found.summary.seconds;
        found = states_.solve(setup, point.t, rest_, Tangent::iterated);
        found.summary.seconds += seconds;
      }
      if (found.outcome == Outcome::aborted) return false;
      take(setup, found, point);
      if (walks && found.outcome == Outcome::converged) {
        on_the_way |= found.flags & flags::near_fold;
        point.flags |= on_the_way;
        start = std::move(found);
      }
      keep(task, point, mail);
    }
    return true;
  }

  /// Solves a task of a rigid tool.
  /// @returns false: it was aborted.
  bool press(const Task& task, Mail& mail) {
    const ToolSpaceSetup& setup = setup_of(task);
    std::optional<Equilibrium> before;
    for (const std::int32_t i : task.points) {
      TestPoint point = point_of(task, i);
      Equilibrium found = states_.begin(setup, point.t, Tangent::iterated);
      if (before && found.outcome != Outcome::aborted) {
        Equilibrium slid = states_.solve(setup, point.t, *before, Tangent::iterated);
        if (!is_same_branch(slid, found)) slid.flags |= flags::near_fold;
        slid.summary.seconds += found.summary.seconds;
        found = std::move(slid);
      }
      if (found.outcome == Outcome::aborted) return false;
      take(setup, found, point);
      keep(task, point, mail);
      if (point.kind == TestKind::walk && found.outcome == Outcome::converged) {
        before = std::move(found);
      }
    }
    return true;
  }

  [[nodiscard]] static bool is_same_branch(const Equilibrium& slid, const Equilibrium& pressed) {
    return pressed.outcome == Outcome::converged &&
           (slid.reaction - pressed.reaction).norm() <= kSameBranch * pressed.reaction.norm();
  }

  void keep(const Task& task, const TestPoint& point, Mail& mail) {
    keep_(task.tool_space, point);
    ++num_solved;
    tell(mail);
  }

  [[nodiscard]] static bool is_regular(const Equilibrium& found) {
    TestPoint point;
    point.outcome = found.outcome;
    point.flags = found.flags;
    return point.regular();
  }

  void take(const ToolSpaceSetup& setup, const Equilibrium& found, TestPoint& point) const {
    point.outcome = found.outcome;
    point.flags = found.flags;
    point.seconds = found.summary.seconds;
    if (found.outcome != Outcome::converged) return;
    point.energy = found.energy;
    point.force = found.reaction;
    point.stiffness = found.stiffness;
    if (setup.body != kFirstBody) return;
    point.displacement.resize(3 * static_cast<Eigen::Index>(samples_.size()));
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      point.displacement.segment<3>(3 * static_cast<Eigen::Index>(s)) =
          (found.u.segment<3>(3 * Eigen::Index{samples_[s]}) - at_rest_[s]).cast<float>();
    }
  }

  void tell(Mail& mail) {
    const bool first = mail.rank() == 0;
    monitor_.tell(
        {num_solved + (first ? num_known_ : 0), first ? num_known_ : 0, first ? num_all_ : 0});
  }

  const std::vector<ToolSpaceSetup>& setups_;
  const std::vector<std::vector<TestPoint>>& points_;
  const std::int64_t num_known_;
  std::int64_t num_all_ = 0;
  StateSolver& states_;
  Monitor& monitor_;
  Keep keep_;
  /// Points of the mesh.
  std::vector<Index> samples_;
  /// Their displacement at rest, m.
  std::vector<Vec3> at_rest_;
  std::int32_t held_ = -1;
  Equilibrium rest_;
};

/// The points of each tool space, not solved.
std::vector<std::vector<TestPoint>> draw(const std::vector<SpaceBody>& bodies,
                                         const std::vector<ToolSpaceSetup>& setups,
                                         const ExactOptions& options, BodySolvers& solvers) {
  std::vector<std::vector<TestPoint>> points;
  for (const ToolSpaceSetup& setup : setups) {
    const SpaceBody& body = find_body(bodies, setup.body);
    if (const auto clearance = solvers.tools(setup.body).clearance(setup.interaction)) {
      const auto holds = [&](const Vec3& q) {
        return !options.holds || options.holds(setup.key(), q);
      };
      points.push_back(draw_contact_points(setup, options.seed, options.test_points,
                                           SurfacePlaces(body.scene->body, body.at_rest),
                                           *clearance, holds));
    } else {
      points.push_back(draw_test_points(test_set_of(setup, options.seed), options.test_points));
    }
  }
  return points;
}

/// Keeps test points in the file of this rank, or in memory.
class TestRecord {
 public:
  TestRecord(const std::vector<SpaceBody>& bodies, const std::vector<ToolSpaceSetup>& setups,
             const ExactOptions& options, Communicator& communicator)
      : setups_(setups), seed_(options.seed), communicator_(communicator) {
    if (options.file.empty()) return;
    files_.emplace(options.file, bodies, options.equilibrium.tolerance, communicator);
    files_->open([](StateSpaceFile&) {});
  }

  /// The points of earlier runs, by tool space, on rank 0; empty elsewhere.
  [[nodiscard]] std::vector<std::vector<TestPoint>> known() {
    std::vector<std::vector<TestPoint>> all(setups_.size());
    agree(communicator_, [&] {
      if (communicator_.rank() != 0 || !files_) return;
      for (std::size_t s = 0; s < setups_.size(); ++s) {
        all[s] = files_->own().test_points().read(test_set_of(setups_[s], seed_));
      }
    });
    return all;
  }

  void keep(std::int32_t tool_space, const TestPoint& point) {
    if (files_) {
      files_->own().test_points().add(
          test_set_of(setups_[static_cast<std::size_t>(tool_space)], seed_), point);
    } else {
      found_.emplace_back(tool_space, point);
    }
  }

  /// All points, by tool space and in order, on rank 0; empty elsewhere.
  /// @note Collective
  [[nodiscard]] std::vector<std::vector<TestPoint>> finish() {
    if (files_) {
      files_->merge();
      std::vector<std::vector<TestPoint>> all = known();
      agree(communicator_, [&] {
        if (communicator_.rank() == 0) files_->own().close();
      });
      return all;
    }
    gather(found_, communicator_);
    std::vector<std::vector<TestPoint>> all(setups_.size());
    for (auto& [tool_space, point] : found_) {
      all[static_cast<std::size_t>(tool_space)].push_back(std::move(point));
    }
    for (auto& points : all) std::sort(points.begin(), points.end());
    return all;
  }

 private:
  const std::vector<ToolSpaceSetup>& setups_;
  std::int64_t seed_;
  Communicator& communicator_;
  std::optional<RankFiles> files_;
  /// Points with the index of their tool space; empty if there are files.
  std::vector<std::pair<std::int32_t, TestPoint>> found_;
};

}  // namespace

void validate(const ExactOptions& options) {
  if (options.test_points < 1) {
    throw InputError("The number of test points is " + std::to_string(options.test_points) +
                     "; there must be at least 1 for each active node.");
  }
  validate(options.equilibrium);
}

ExactResult solve_test_points(const std::vector<std::shared_ptr<const Scene>>& scenes,
                              const std::vector<ToolSpaceSetup>& setups,
                              const ExactOptions& options, Communicator& communicator,
                              const Progress& progress) {
  Monitor monitor(progress, communicator.network());
  const int threads = num_threads(communicator, options.equilibrium.threads);
  std::vector<SpaceBody> bodies;
  for (const auto& scene : scenes) {
    bodies.push_back({kFirstBody + static_cast<BodyId>(bodies.size()), scene,
                      options.file.empty() ? std::string() : hash(*scene), SettledBody{}});
  }
  const auto make = [&](const SpaceBody& body) {
    EquilibriumOptions of_solver = options.equilibrium;
    of_solver.follow_folds = false;
    of_solver.kept_factors = std::max(of_solver.kept_factors, 3);
    of_solver.abort_requested = [&monitor] { return !monitor.go_on(); };
    of_solver.threads = threads;
    return std::make_unique<EquilibriumSolver>(*body.scene, of_solver,
                                               choose_tangent_solver(*body.scene, threads));
  };
  BodySolvers solvers(bodies, make, false, kMostSolvers);
  // Check everything that can be wrong before a file is touched.
  agree(communicator, [&] {
    validate(options);
    for (const ToolSpaceSetup& setup : setups) (void)solvers.equilibria(setup.body);
  });
  for (SpaceBody& body : bodies) {
    if (!body.scene->has_load()) continue;
    body.at_rest = settle(*body.scene, solvers.equilibria(body.number), options.file, communicator);
  }
  std::vector<std::vector<TestPoint>> drawn;
  agree(communicator, [&] {
    for (const ToolSpaceSetup& setup : setups) {
      (void)solvers.tools(setup.body).make(setup.interaction);
    }
    if (communicator.rank() == 0) drawn = draw(bodies, setups, options, solvers);
  });
  const std::vector<std::vector<TestPoint>> points = of_first(drawn, communicator);
  TestRecord record(bodies, setups, options, communicator);

  ExactResult result;
  Packer to_solve;
  const std::vector<std::vector<TestPoint>> found_before = record.known();
  for (std::size_t s = 0; s < found_before.size(); ++s) {
    if (communicator.rank() != 0) continue;
    result.num_reused += static_cast<std::int64_t>(points[s].size());
    for (const Task& task :
         make_tasks(static_cast<std::int32_t>(s), points[s], found_before[s], setups[s])) {
      put(task, to_solve);
      result.num_reused -= static_cast<std::int64_t>(task.points.size());
    }
  }
  const std::vector<Bytes> tasks = communicator.all_gather(to_solve.take());
  Solver worker(
      bodies.front(), setups, points, result.num_reused, solvers, monitor,
      [&](std::int32_t tool_space, const TestPoint& point) { record.keep(tool_space, point); });
  int next = 0;
  for (Unpacker content(tasks.front()); !content.at_end(); ++next) {
    Task task = take_task(content, points);
    if (next % communicator.size() == communicator.rank()) {
      worker.tasks.push_back(std::move(task));
    }
  }
  result.complete = run(worker, communicator);
  monitor.set_mail(nullptr);

  std::vector<std::int64_t> solved{worker.num_solved};
  gather(solved, communicator);
  result.num_solved = std::accumulate(solved.begin(), solved.end(), std::int64_t{0});
  result.points = record.finish();
  // A file may have more points than were asked for.
  for (std::size_t s = 0; s < result.points.size(); ++s) {
    auto& of_tool_space = result.points[s];
    of_tool_space.erase(std::remove_if(of_tool_space.begin(), of_tool_space.end(),
                                       [&](const TestPoint& point) {
                                         return !std::binary_search(points[s].begin(),
                                                                    points[s].end(), point);
                                       }),
                        of_tool_space.end());
  }
  return result;
}

}  // namespace palpate
