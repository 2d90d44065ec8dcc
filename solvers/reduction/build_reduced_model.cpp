// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/build_reduced_model.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include <Eigen/Geometry>

#include "assembly/external_energy.h"
#include "assembly/mass.h"
#include "base/error.h"
#include "base/quantity.h"
#include "dynamics/dynamic_solver.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction_list.h"
#include "mesh/resolved_length.h"
#include "reduced/reduced_body.h"
#include "reduction/hyper_reduction.h"
#include "reduction/random_path.h"
#include "reduction/reduced_basis.h"
#include "reduction/training.h"

namespace palpate {
namespace {

/// The shares of the modes for equilibria with one tool moved, and for those with all tools moved.
constexpr double kOneToolShare = 0.2;
constexpr double kAllToolsShare = 0.07;
/// The number of equilibria in a part of the training, so large that the start of each part, the
/// equilibrium at rest, takes a small share of its time.
constexpr Eigen::Index kPlacesOfPart = 26;
/// The numbers of steps from one state to the next, in motion of the whole body and of the reduced
/// one.
constexpr int kStepsOfState = 4;
constexpr int kStepsOfReducedState = 10;
/// DynamicsOptions::equilibrium.tolerance in training: no mode is more accurate.
constexpr double kMotionTolerance = 1e-6;
/// The number of places for the reduced model, per place for the whole body.
constexpr int kReducedPlaces = 10;
/// The least range of a coordinate, as a share of the largest: one that moves less has no part in
/// the force.
constexpr double kLeastRange = 0.03;

/// The largest numbers of steps of the whole body, of rows of the paths' tables, and of taps on a
/// path: more would not end in a useful time, or fill the memory.
constexpr double kMostSteps = 1e7;
constexpr double kMostRows = 1e7;
constexpr double kMostTaps = 1e5;
/// The largest displacement of a tool in training, and of a point of the body from its place at
/// rest, in sizes of the body.
constexpr double kMostReach = 10;
constexpr double kMostDisplacement = 100;
/// The shortest duration of a path, in periods of the bandwidth: a shorter one stays within the
/// ramp at its beginning.
constexpr double kLeastPeriods = 0.01;

void require(bool good, const char* name, double value, const char* what) {
  if (good) return;
  std::ostringstream text;
  text << "The option " << name << " of the reduced model is " << value << "; " << what;
  throw InputError(text.str());
}

/// @param names The options that determine the number.
/// @param what What is counted.
void require_at_most(double most, double number, const char* names, const char* what) {
  if (number <= most) return;
  std::ostringstream text;
  text << "The options " << names << " of the reduced model make " << number << ' ' << what
       << "; there may be " << most << ". Make the steps longer, or the rest less.";
  throw InputError(text.str());
}

void check_materials(const Scene& scene, const std::vector<Rheology>& rheologies) {
  for (const Material& material : scene.organ.materials) {
    if (material.formulation == Formulation::displacement) continue;
    throw InputError("The material " + to_string(material.law) + " with Poisson's ratio " +
                     quantity(poissons_ratio(material)) +
                     " has a pressure of its own, which a reduced model has not. Choose a "
                     "compressible law with a ratio of at most 0.45.");
  }
  if (rheologies.size() != scene.organ.materials.size()) {
    throw InputError("There are " + std::to_string(rheologies.size()) + " rheologies for " +
                     std::to_string(scene.organ.materials.size()) +
                     " materials. Give one for each.");
  }
  for (const Rheology& rheology : rheologies) validate(rheology);
}

/// A pressure that follows the surface, and contact, would add an energy that the model has not.
void check_loads(const Scene& scene) {
  if (scene.has_contact()) {
    throw InputError(
        "A reduced model does not know that parts of the body touch each other: its error would "
        "not be what it tells. Take Solve Dynamics or Precompute State Space, or leave Contact of "
        "Set Boundary at None.");
  }
  if (scene.body.applied_pressure.empty()) return;
  throw InputError(
      "A reduced model bears no AppliedPressure, which follows the surface: its error would not be "
      "what it tells. Take Solve Dynamics or Precompute State Space, or give the surface an "
      "AppliedTraction instead, whose direction stays the same.");
}

/// Bᵀ A B for a basis B.
/// @param times The function A x.
template <class Times>
Eigen::MatrixXd in_basis(const Eigen::MatrixXd& basis, const Times& times) {
  Eigen::MatrixXd of_basis(basis.rows(), basis.cols());
  for (Eigen::Index c = 0; c < basis.cols(); ++c) {
    of_basis.col(c) = times(NodalVector(basis.col(c))).head(basis.rows());
  }
  return basis.transpose() * of_basis;
}

/// The solves for the whole body in training, with the tools at each of some places.
class Training {
 public:
  Training(const Scene& scene, const std::vector<Rheology>& rheologies,
           const std::vector<std::vector<BondedPatch>>& places, const ReductionOptions& options)
      : scene_(scene), rheologies_(rheologies), options_(options), places_(places.size()) {
    for (std::size_t place = 0; place < places.size(); ++place) {
      for (const BondedPatch& tool : places[place]) places_[place].add(tool);
      add_parts(place, static_cast<int>(places[place].size()));
    }
  }
  // The parts have pointers to this object.
  Training(const Training&) = delete;
  Training& operator=(const Training&) = delete;

  /// @param groups On rank 0 the states of each place.
  /// @returns False: the training was aborted.
  /// @note Collective
  [[nodiscard]] bool run(const TrainingRun& run, std::vector<TrainingGroups>& groups) const {
    std::vector<TrainingStates> states;
    if (!train(parts_, run, options_.equilibrium.abort_requested, states)) return false;
    groups.resize(places_.size());
    for (std::size_t p = 0; p < states.size(); ++p) {
      const std::string& name = parts_[p].name;
      TrainingGroups& of_place = groups[place_of_part_[p]];
      TrainingStates& group = name.compare(0, 7, "OneTool") == 0    ? of_place.one_tool
                              : name.compare(0, 8, "AllTools") == 0 ? of_place.all_tools
                                                                    : of_place.moving;
      group.append(states[p]);
      states[p] = {};
    }
    return true;
  }

 private:
  void add_parts(std::size_t place, int num_tools) {
    add_equilibria("OneTool", place, num_tools, one_tool_places(num_tools, options_.reach));
    if (num_tools > 1) {
      add_equilibria("AllTools", place, num_tools,
                     random_places(num_tools, options_.reach, options_.all_tools_states,
                                   options_.seed + place));
    }
    if (has_density(rheologies_)) add_motion(place, num_tools);
  }

  void add_equilibria(const std::string& name, std::size_t place, int num_tools,
                      const Eigen::MatrixXd& displacements) {
    for (Eigen::Index first = 0; first < displacements.cols(); first += kPlacesOfPart) {
      const Eigen::MatrixXd of_part =
          displacements.middleCols(first, std::min(kPlacesOfPart, displacements.cols() - first));
      add(name, place, num_tools, [this, place, of_part] {
        report("Equilibria", place);
        EquilibriumSolver solver(with_gravity(scene_, rheologies_, options_.gravity),
                                 options_.equilibrium);
        require_rest(solver);
        solver.set_interaction(places_[place]);
        return find_equilibria(solver, of_part);
      });
    }
  }

  void add_motion(std::size_t place, int num_tools) {
    const int first = static_cast<int>(place) * options_.training_paths;
    for (const ToolPath& path : training_paths(options_, num_tools, first)) {
      add("Motion", place, num_tools, [this, place, path] {
        report("Motion", place);
        return move_in_training(scene_, rheologies_, places_[place], {path}, options_);
      });
    }
  }

  void add(const std::string& name, std::size_t place, int num_tools,
           std::function<TrainingStates()> compute) {
    parts_.push_back({name + std::to_string(parts_.size()), Index{3} * num_tools,
                      3 * Eigen::Index{scene_.body.mesh.num_points()},
                      kMostDisplacement * size_of(scene_.body.mesh), std::move(compute)});
    place_of_part_.push_back(place);
  }

  void report(const std::string& what, std::size_t place) const {
    if (!options_.report) return;
    options_.report(places_.size() == 1 ? what
                                        : what + ", place " + std::to_string(place + 1) + " of " +
                                              std::to_string(places_.size()));
  }

  const Scene& scene_;
  const std::vector<Rheology>& rheologies_;
  const ReductionOptions& options_;
  /// The tools at each place.
  std::vector<InteractionList> places_;
  std::vector<TrainingPart> parts_;
  std::vector<std::size_t> place_of_part_;
};

class Builder {
 public:
  Builder(const Scene& scene, const std::vector<Rheology>& rheologies,
          const std::vector<BondedPatch>& tools, const ReductionOptions& options)
      : scene_(scene),
        rheologies_(rheologies),
        options_(options),
        num_tools_(static_cast<int>(tools.size())),
        solver_(with_gravity(scene, rheologies, options.gravity), options.equilibrium),
        points_(scene_, find_rest()),
        springs_(springs_of(scene_.body, solver_.assembly())),
        stiffness_(solver_.assembly(), points_.rest(), springs_ ? &*springs_ : nullptr),
        modes_(stiffness_, 3 * Eigen::Index{scene_.body.mesh.num_points()}) {
    for (const BondedPatch& tool : tools) tools_.add(tool);
    solver_.set_interaction(tools_);
  }

  BuiltModel build(const TrainingGroups& groups) {
    const Equilibrium rest = solver_.rest();
    tool_responses_ = rest.v;
    tool_stiffness_ = rest.stiffness;
    make_modes(groups);
    const Eigen::Index n = modes_.modes().cols();
    result_.basis.resize(rest.u.size(), n + tool_responses_.cols());
    result_.basis << modes_.modes(), tool_responses_;
    hold_directions(scene_.body, result_.basis);
    result_.rest = points_.rest();
    Eigen::MatrixXd states(result_.basis.cols(), states_.tools.cols());
    states << modes_.coordinates(beside_tools(states_)), states_.tools;
    choose_points(states);
    const Eigen::MatrixXd more = reduced_states();
    Eigen::MatrixXd all(states.rows(), states.cols() + more.cols());
    all << states, more;
    choose_points(all);
    result_.num_states = static_cast<int>(all.cols());
    result_.num_left_out += states_.num_left_out;
    return std::move(result_);
  }

 private:
  void report(const std::string& what) const {
    if (options_.report) options_.report(what);
  }

  /// Finds u_r.
  [[nodiscard]] NodalVector find_rest() {
    const Equilibrium& rest = solver_.settled();
    if (rest.outcome != Outcome::converged) throw InputError(rest.summary.message);
    return rest.u;
  }

  /// u − u_r − L d.
  [[nodiscard]] Eigen::MatrixXd beside_tools(const TrainingStates& states) const {
    Eigen::MatrixXd beside = states.u - tool_responses_ * states.tools;
    if (points_.rest().size() > 0) beside.colwise() -= points_.rest();
    return beside;
  }

  void make_modes(const TrainingGroups& groups) {
    report("Modes");
    // If a group is missing, the others share its modes.
    const double one_share = kOneToolShare;
    const double all_share = num_tools_ > 1 ? kAllToolsShare : 0;
    const double motion_share =
        groups.moving.tools.cols() > 0 ? 1 - kOneToolShare - kAllToolsShare : 0;
    const double whole = one_share + all_share + motion_share;
    const auto until = [&](double share) {
      return static_cast<Eigen::Index>(std::lround(options_.modes * share / whole));
    };
    const auto add = [&](const TrainingStates& group, double share) {
      const Eigen::Index before = modes_.modes().cols();
      if (group.tools.cols() > 0) modes_.add(beside_tools(group), until(share) - before);
      states_.append(group);
      return static_cast<Index>(modes_.modes().cols() - before);
    };
    result_.one_tool_modes = add(groups.one_tool, one_share);
    result_.all_tools_modes = add(groups.all_tools, one_share + all_share);
    result_.motion_modes = add(groups.moving, whole);
  }

  void choose_points(const Eigen::MatrixXd& states) {
    report("Points for " + std::to_string(states.cols()) + " states");
    choose_model_points(scene_, rheologies_, points_, tool_stiffness_, states, options_, result_);
  }

  /// States of the present reduced model: equilibria, and motion on the training paths.
  [[nodiscard]] Eigen::MatrixXd reduced_states() const {
    report("States of the reduced model");
    std::vector<Eigen::VectorXd> states;
    ReducedModel still = result_.model;
    still.mass.setZero();
    still.rheologies.assign(still.rheologies.size(), Rheology());
    ReducedBody at_rest(still, {});
    const Eigen::MatrixXd places = random_places(
        num_tools_, options_.reach, kReducedPlaces * options_.all_tools_states, options_.seed + 1);
    for (Eigen::Index c = 0; c < places.cols(); ++c) {
      at_rest.rest();
      const Eigen::VectorXd place = places.col(c);
      if (at_rest.step(place.data()).outcome == ReducedOutcome::converged) {
        states.push_back(at_rest.coordinates());
      }
    }
    if (result_.model.has_inertia()) {
      ReducedBodyOptions options;
      options.time_step = options_.time_step;
      for (const ToolPath& path : training_paths(options_, num_tools_)) {
        ReducedBody moving(result_.model, options);
        const int num_steps = static_cast<int>(path.end() / options.time_step);
        for (int step = 1; step <= num_steps; ++step) {
          const Eigen::VectorXd place = path.at(step * options.time_step);
          const ReducedState& state = moving.step(place.data());
          if (step % kStepsOfReducedState == 0 && state.outcome == ReducedOutcome::converged) {
            states.push_back(moving.coordinates());
          }
        }
      }
    }
    Eigen::MatrixXd all(result_.basis.cols(), static_cast<Eigen::Index>(states.size()));
    for (Eigen::Index c = 0; c < all.cols(); ++c) all.col(c) = states[c];
    return all;
  }

  const Scene& scene_;
  const std::vector<Rheology>& rheologies_;
  const ReductionOptions& options_;
  int num_tools_;
  InteractionList tools_;
  EquilibriumSolver solver_;
  BodyPoints points_;
  std::optional<PointMatrix> springs_;
  RestStiffness stiffness_;
  ModeBuilder modes_;
  Eigen::MatrixXd tool_responses_;
  Eigen::MatrixXd tool_stiffness_;
  TrainingStates states_;
  BuiltModel result_;
};

}  // namespace

void validate(const ReductionOptions& options) {
  require(options.modes >= 1, "Modes", options.modes, "it must be at least 1.");
  require(options.place_modes >= 1, "PlaceModes", options.place_modes, "it must be at least 1.");
  require(options.tolerance > 0 && options.tolerance < 1, "Tolerance", options.tolerance,
          "it must be between 0 and 1.");
  require(options.max_points >= 1, "MaximumPoints", options.max_points, "it must be at least 1.");
  require(options.training_paths >= 1, "TrainingPaths", options.training_paths,
          "it must be at least 1.");
  require(options.reach > 0 && std::isfinite(options.reach), "Reach", options.reach,
          "it must be a length in m above 0.");
  require(options.path_duration > 0 && std::isfinite(options.path_duration), "PathDuration",
          options.path_duration, "it must be a number of seconds above 0.");
  require(options.bandwidth > 0 && std::isfinite(options.bandwidth), "Bandwidth", options.bandwidth,
          "it must be a frequency in Hz above 0.");
  require(options.taps >= 0 && std::isfinite(options.taps), "Taps", options.taps,
          "it must be a number in a second that is not negative.");
  require(options.shortest_tap > 0 && std::isfinite(options.shortest_tap), "ShortestTap",
          options.shortest_tap, "it must be a number of seconds above 0.");
  require(options.time_step > 0 && std::isfinite(options.time_step), "TimeStep", options.time_step,
          "it must be a number of seconds above 0.");
  require(options.all_tools_states >= 1, "AllToolsStates", options.all_tools_states,
          "it must be at least 1.");
  require(options.path_duration >= options.time_step, "PathDuration", options.path_duration,
          "it must be at least TimeStep.");
  require(options.shortest_tap <= options.path_duration, "ShortestTap", options.shortest_tap,
          "it must be at most PathDuration.");
  require(options.path_duration * options.bandwidth >= kLeastPeriods, "Bandwidth",
          options.bandwidth, "a path of PathDuration must have a hundredth of a period at least.");
  check_steps(options, options.training_paths, "TrainingPaths, PathDuration and TimeStep");
  require_at_most(kMostRows, options.training_paths * num_rows(path_options(options, 1)),
                  "TrainingPaths, PathDuration and ShortestTap", "rows of the paths' tables");
  require_at_most(kMostTaps, options.taps * options.path_duration, "PathDuration and Taps", "taps");
  validate(options.equilibrium);
}

void check_steps(const ReductionOptions& options, int paths, const char* names) {
  require_at_most(kMostSteps, paths * (options.path_duration / options.time_step), names, "steps");
}

ReducedModel make_reduced_model(const Scene& scene, const std::vector<Rheology>& rheologies,
                                const Eigen::MatrixXd& basis, const Eigen::MatrixXd& tool_stiffness,
                                const std::vector<Index>& points, const Eigen::VectorXd& weights,
                                const Eigen::MatrixXd& states, const NodalVector& rest) {
  ReducedModel model;
  model.num_tool_coordinates = static_cast<Index>(tool_stiffness.rows());
  model.num_modes = static_cast<Index>(basis.cols()) - model.num_tool_coordinates;
  model.materials = scene.organ.materials;
  model.rheologies = rheologies;
  model.points = BodyPoints(scene, rest).reduce(basis, points, weights).points;
  model.tool_stiffness = 0.5 * (tool_stiffness + tool_stiffness.transpose());
  model.mass.setZero(basis.cols(), basis.cols());
  if (has_density(rheologies)) {
    std::vector<double> densities;
    for (const Rheology& rheology : rheologies) densities.push_back(rheology.density);
    const MassMatrix mass(scene.body, densities, Assembly(scene));
    model.mass = in_basis(basis, [&](const auto& field) { return mass.times(field); });
  }
  if (!scene.body.support_stiffness.empty()) {
    const Assembly assembly(scene);
    const std::optional<PointMatrix> springs = springs_of(scene.body, assembly);
    model.support_stiffness =
        in_basis(basis, [&](const auto& field) { return springs->times(field); });
  }
  const Eigen::VectorXd ranges = states.cwiseAbs().rowwise().maxCoeff();
  // A body of the linear law has no modes, and Eigen cannot take the largest coefficient of an
  // empty vector.
  const auto at_least = [](const Eigen::VectorXd& range) -> Eigen::VectorXd {
    if (range.size() == 0) return range;
    return range.cwiseMax(kLeastRange * range.maxCoeff());
  };
  model.trained_modes = at_least(ranges.head(model.num_modes));
  model.trained_tools = at_least(ranges.tail(model.num_tool_coordinates));
  validate(model);
  return model;
}

void choose_model_points(const Scene& scene, const std::vector<Rheology>& rheologies,
                         const BodyPoints& points, const Eigen::MatrixXd& tool_stiffness,
                         const Eigen::MatrixXd& states, const ReductionOptions& options,
                         BuiltModel& built) {
  HyperReductionOptions of_points;
  of_points.tolerance = options.tolerance;
  of_points.max_points = options.max_points;
  of_points.seed = options.seed;
  const HyperReduction chosen =
      hyper_reduce(points, scene.organ.materials, built.basis, tool_stiffness, states, of_points);
  built.points = chosen.points;
  built.residual = chosen.residual;
  built.within_tolerance = chosen.converged;
  built.num_left_out = chosen.num_left_out;
  built.model = make_reduced_model(scene, rheologies, built.basis, tool_stiffness, chosen.points,
                                   chosen.weights, states, points.rest());
}

TrainingStates move_in_training(const Scene& scene, const std::vector<Rheology>& rheologies,
                                const Interaction& tools, const std::vector<ToolPath>& paths,
                                const ReductionOptions& options) {
  DynamicsOptions of_motion;
  of_motion.time_step = options.time_step;
  of_motion.gravity = options.gravity;
  of_motion.equilibrium = options.equilibrium;
  of_motion.equilibrium.tolerance = kMotionTolerance;
  DynamicSolver solver(scene, rheologies, tools, of_motion);
  return move_body(solver, paths, kStepsOfState);
}

RandomPathOptions path_options(const ReductionOptions& options, int num_tools) {
  RandomPathOptions path;
  path.num_tools = num_tools;
  path.duration = options.path_duration;
  path.reach = options.reach;
  path.bandwidth = options.bandwidth;
  path.taps = options.taps;
  path.shortest_tap = options.shortest_tap;
  return path;
}

std::vector<ToolPath> training_paths(const ReductionOptions& options, int num_tools, int first) {
  const RandomPathOptions path = path_options(options, num_tools);
  std::vector<ToolPath> paths;
  for (int i = first; i < first + options.training_paths; ++i) {
    paths.push_back(random_path(path, options.seed + 1000 + static_cast<std::uint64_t>(i)));
  }
  return paths;
}

void check_reduction(const Scene& scene, const std::vector<Rheology>& rheologies,
                     const ReductionOptions& options) {
  validate(options);
  check_materials(scene, rheologies);
  check_loads(scene);
  check_resolved(scene.body.mesh, "The option Reach", options.reach);
  require(options.reach <= kMostReach * size_of(scene.body.mesh), "Reach", options.reach,
          "it must be at most ten times the size of the body, in m.");
  if (options.gravity.isZero(0)) return;
  Scene under_gravity = with_gravity(scene, rheologies, options.gravity);
  check(under_gravity);
}

bool train_with_tools(const Scene& scene, const std::vector<Rheology>& rheologies,
                      const std::vector<std::vector<BondedPatch>>& places,
                      const ReductionOptions& options, const TrainingRun& run,
                      std::vector<TrainingGroups>& groups) {
  return Training(scene, rheologies, places, options).run(run, groups);
}

BuiltModel build_reduced_model(const Scene& scene, const std::vector<Rheology>& rheologies,
                               const std::vector<BondedPatch>& tools,
                               const ReductionOptions& options) {
  const auto alone = make_serial_communicator();
  return build_reduced_model(scene, rheologies, tools, options, {*alone, nullptr, {}});
}

BuiltModel build_reduced_model(const Scene& scene, const std::vector<Rheology>& rheologies,
                               const std::vector<BondedPatch>& tools,
                               const ReductionOptions& options, const TrainingRun& run) {
  BuiltModel built;
  agree(run.communicator, [&] {
    validate(options);
    if (tools.empty()) {
      throw InputError("A reduced model needs a tool. Give at least one bonded patch.");
    }
    Scene checked = scene;
    check(checked);
    check_reduction(checked, rheologies, options);
    std::vector<TrainingGroups> groups;
    built.aborted = !train_with_tools(checked, rheologies, {tools}, options, run, groups);
    if (built.aborted || run.communicator.rank() != 0) return;
    try {
      built = Builder(checked, rheologies, tools, options).build(groups.front());
    } catch (const InputError&) {
      // If the solve at rest was aborted, there is no model.
      const auto& abort_requested = options.equilibrium.abort_requested;
      if (!abort_requested || !abort_requested()) throw;
      built.aborted = true;
    }
  });
  return built;
}

}  // namespace palpate
