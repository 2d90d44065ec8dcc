// SPDX-License-Identifier: BSD-3-Clause
// What is interpolated between the stages of a cut, beside solves at stages that the interpolation
// does not know, and what two stages release beside the domain integral.
//
//   palpate_benchmark_tear stages.palpate --node 131 [--tip 0.012] [--x 0.006] [--y -0.019] [--z 0]
//     [--reach 0.015] [--steps 20]
//
// The file has the stages of a plane cut whose fronts are close to each other. A bonded tip of that
// radius around the node is moved there, m. Prints the tables of README.md: the energy release rate
// of steps by both ways; the error in force and energy at the stages that are left out where every
// second, fourth or eighth one is known; and a body that tears all the way there beside one that is
// interpolated.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <vector>

#include "arguments.h"
#include "cutting/opened_scene.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interpolation/torn_energy.h"
#include "solvers/support/domain_integral.h"
#include "storage/state_space_file.h"
#include "tearing/tearing_body.h"

namespace palpate {
namespace {

/// The bodies at all stages, and a tool on each.
class Stages {
 public:
  Stages(Scene closed, Index node, double tip)
      : closed_(std::move(closed)), node_(node), tip_(tip) {
    for (std::size_t j = 0; j < areas().size(); ++j) {
      scenes_.push_back(
          std::make_unique<Scene>(open_scene(closed_, static_cast<std::int32_t>(j)).scene));
      tools_.push_back(make_tool(*scenes_.back()));
      solvers_.push_back(make_solver(*scenes_.back()));
      solvers_.back().set_interaction(*tools_.back());
      states_.push_back(solvers_.back().rest());
    }
  }

  [[nodiscard]] std::unique_ptr<Interaction> make_tool(const Scene& scene) const {
    return BondedPatches(scene.body, tip_).around_each({node_}).clone();
  }
  [[nodiscard]] static EquilibriumSolver make_solver(const Scene& scene) {
    EquilibriumOptions options;
    options.kept_factors = 2;
    return EquilibriumSolver(scene, options);
  }

  void move(const Vec3& to) {
    for (std::size_t j = 0; j < states_.size(); ++j) {
      states_[j] = solvers_[j].solve(to, states_[j]);
      if (states_[j].outcome != Outcome::converged) {
        std::printf("stage %zu: %s\n", j, states_[j].summary.message.c_str());
      }
    }
  }

  [[nodiscard]] const Scene& closed() const { return closed_; }
  [[nodiscard]] const Scene& scene(int stage) const { return *scenes_[stage]; }
  [[nodiscard]] const Equilibrium& state(int stage) const { return states_[stage]; }
  [[nodiscard]] const std::vector<double>& areas() const { return closed_.body.cut.areas; }
  [[nodiscard]] int last() const { return static_cast<int>(areas().size()) - 1; }

 private:
  Scene closed_;
  Index node_;
  double tip_;
  std::vector<std::unique_ptr<Scene>> scenes_;
  std::vector<std::unique_ptr<Interaction>> tools_;
  std::vector<EquilibriumSolver> solvers_;
  std::vector<Equilibrium> states_;
};

/// Every so manieth stage, and the last one.
class Known {
 public:
  Known(const Stages& stages, int step) : stages_(stages), energy_(chosen(stages, step)) {}

  [[nodiscard]] TornResult at(double area) const {
    return energy_.evaluate(area, [&](int k) { return result(k); });
  }
  [[nodiscard]] double tear(double area, double toughness) const {
    return energy_.tear(area, toughness, energy_.whole_area(), [&](int k) { return result(k); });
  }
  [[nodiscard]] bool has(int stage) const {
    return std::find(numbers_.begin(), numbers_.end(), stage) != numbers_.end();
  }

 private:
  std::vector<double> chosen(const Stages& stages, int step) {
    std::vector<double> areas;
    for (int j = 0; j < stages.last(); j += step) numbers_.push_back(j);
    numbers_.push_back(stages.last());
    for (const int j : numbers_) areas.push_back(stages.areas()[j]);
    return areas;
  }
  [[nodiscard]] TouchResult result(int k) const {
    const Equilibrium& state = stages_.state(numbers_[k]);
    TouchResult result;
    result.force = state.reaction;
    result.stiffness = state.stiffness;
    result.energy = state.energy;
    return result;
  }

  const Stages& stages_;
  std::vector<int> numbers_;
  TornEnergy energy_;
};

void print_release(const Stages& stages, double reach) {
  std::puts(
      "| stage | area, cm² | Π, mJ | G of two steps | domain integral, reach, half of it | off, % "
      "|\n"
      "|---|---|---|---|---|---|");
  std::vector<double> rates, narrow;
  for (int j = 0; j <= stages.last(); ++j) {
    const test::CutFront front =
        test::find_front(stages.closed().body.mesh, stages.closed().body.cut.faces, j);
    const bool has_front = !front.edges.empty() && j > 0;
    rates.push_back(has_front ? test::release_rate(stages.scene(j), stages.state(j).u, front, reach)
                              : NAN);
    narrow.push_back(
        has_front ? test::release_rate(stages.scene(j), stages.state(j).u, front, 0.5 * reach)
                  : NAN);
  }
  for (int j = 0; j <= stages.last(); ++j) {
    std::printf("| %d | %.2f | %.4f ", j, 1e4 * stages.areas()[j], 1e3 * stages.state(j).energy);
    if (j < 2 || j + 1 >= stages.last()) {
      std::puts("| | | |");
      continue;
    }
    const double below = stages.areas()[j] - stages.areas()[j - 1];
    const double above = stages.areas()[j + 1] - stages.areas()[j];
    const double of_steps =
        (stages.state(j - 1).energy - stages.state(j + 1).energy) / (below + above);
    // The mean of a parabola through the three rates, whose steps may differ.
    const double mean = (rates[j - 1] * below + rates[j + 1] * above + rates[j] * (below + above)) /
                        (2 * (below + above));
    std::printf("| %.4f | %.4f, %.4f | %+.2f |\n", of_steps, rates[j], narrow[j],
                100 * (mean / of_steps - 1));
  }
}

void print_between(const Stages& stages) {
  std::puts(
      "| stages known | h off at most, % of the largest | in the mean | Π off at most, % |\n"
      "|---|---|---|---|");
  double largest = 0;
  for (int j = 0; j <= stages.last(); ++j) {
    largest = std::max(largest, stages.state(j).reaction.norm());
  }
  for (const int step : {2, 4, 8}) {
    const Known known(stages, step);
    double most = 0, sum = 0, energy = 0;
    int count = 0;
    for (int j = 0; j <= stages.last(); ++j) {
      if (known.has(j)) continue;
      const TornResult found = known.at(stages.areas()[j]);
      const double off = (found.touch.force - stages.state(j).reaction).norm() / largest;
      most = std::max(most, off);
      sum += off;
      energy = std::max(energy, std::abs(found.touch.energy / stages.state(j).energy - 1));
      ++count;
    }
    std::printf("| every %d. | %.3f | %.3f | %.3f |\n", step, 100 * most, 100 * sum / count,
                100 * energy);
  }
}

/// A body with a notch that tears on its way, directly and interpolated.
void print_tear(Stages& stages, const Vec3& to, int steps, double share) {
  constexpr int kNotch = 4;
  const Vec3 begin = share * to;
  stages.move(begin);
  const double toughness = (stages.state(kNotch).energy - stages.state(kNotch + 1).energy) /
                           (stages.areas()[kNotch + 1] - stages.areas()[kNotch]);
  TearingBody body(
      stages.scene(kNotch), toughness, Vec3::Zero(),
      [&](const Scene& scene) { return stages.make_tool(scene); }, Stages::make_solver);
  std::printf("G_c %.4g J/m²\n", toughness);
  std::puts(
      "| way | direct: torn, cm² | h | every 2.: torn | h off, % | every 4.: torn | h off, % |\n"
      "|---|---|---|---|---|---|---|");
  double torn[2] = {stages.areas()[kNotch], stages.areas()[kNotch]};
  double largest = 0;
  for (int i = 1; i <= steps; ++i) {
    const Vec3 place = i * to / steps;
    stages.move(place);
    body.move(place);
    largest = std::max(largest, body.state().reaction.norm());
    std::printf("| %.2f | %.3f | %.4f ", 1.0 * i / steps, 1e4 * body.scene().body.cut.area(),
                body.state().reaction.norm());
    for (int k = 0; k < 2; ++k) {
      const Known known(stages, k == 0 ? 2 : 4);
      torn[k] = known.tear(torn[k], toughness);
      std::printf("| %.3f | %.2f ", 1e4 * torn[k],
                  100 * (known.at(torn[k]).touch.force - body.state().reaction).norm() / largest);
    }
    std::puts("|");
  }
}

void run(const Arguments& arguments) {
  const StateSpaceFile file = StateSpaceFile::open_read_only(arguments.scene);
  Scene closed = file.read_scene(file.list_bodies().back());
  Stages stages(std::move(closed), static_cast<Index>(arguments["node"]), arguments["tip"]);
  const Vec3 to(arguments["x"], arguments["y"], arguments["z"]);
  std::printf("%d cells, %d stages\n", stages.closed().body.mesh.num_cells(), stages.last());
  stages.move(to);
  print_release(stages, arguments["reach"]);
  print_between(stages);
  print_tear(stages, to, static_cast<int>(arguments["steps"]), arguments["onset"]);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    palpate::run(palpate::Arguments(argc, argv,
                                    {{"node", 0},
                                     {"tip", 0.012},
                                     {"x", 0.006},
                                     {"y", -0.019},
                                     {"z", 0},
                                     {"reach", 0.015},
                                     {"steps", 20},
                                     {"onset", 0.4}}));
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s\n", problem.what());
    return 1;
  }
  return 0;
}
