// SPDX-License-Identifier: BSD-3-Clause
// Error asked for, error reached, configurations, seconds and megabytes: spaces that refine
// themselves to a tolerance, beside uniform grids, of the scene and the first active node of a
// .palpate file, which any short run of PrecomputeStateSpace makes (seed_problem.py --file).
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_tolerance liver.palpate 0.012 2000 5% 1% 0.2% 5 7 9
//
// The arguments are the file, the half-width of the box in m, the number of random points at which
// the equilibrium is solved for exactly, each from rest, and the spaces: a tolerance in per cent,
// or the check-points along an axis of a uniform grid. The exact solutions are kept beside the
// file, as a .csv that is named after the scene, the tip and the box: the next run goes on from
// them. Prints a Markdown table:
//
//   configurations, s   solved for, and processor time of the exploration
//   mean, 99 %, largest of the error of the force, as a share of the largest force, where the space
//                       says `inside` and the way from rest is regular: it converges, without a
//                       fold, to a state that is stable and not inverted
//   marked              points where the space does not say `inside`: how many, and the largest
//                       error among those with a regular way from rest
//   irregular           points where it does, though the way from rest is not regular, and what it
//                       ends in may lie on another branch: how many, and the largest error
//   jump                largest jump of the force at random points of the faces between leaves of
//                       different size, as a share of the largest force
//   MB                  of what is carried for touching, in memory
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "interaction/bonded_patch.h"
#include "interpolation/interpolator.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

constexpr int kFacePoints = 100'000;

struct Exact {
  Vec3 t;
  Vec3 force = Vec3::Zero();
  Outcome outcome = Outcome::not_converged;
  Flags flags = 0;

  [[nodiscard]] bool converged() const { return outcome == Outcome::converged; }
  /// On the branch that is reached from rest, without inverted elements.
  [[nodiscard]] bool regular() const { return converged() && flags == 0; }
};

/// Solutions at random points of the box, always the same: those of the file, then new ones, which
/// are added to it.
std::vector<Exact> solve_exactly(const Scene& scene, const ToolSpaceSetup& tool_space,
                                 double half_width, int num, const std::string& path) {
  std::mt19937_64 random(2008);
  std::uniform_real_distribution<double> uniform(-half_width, half_width);
  std::vector<Exact> all(static_cast<std::size_t>(num));
  for (Exact& exact : all) exact.t = {uniform(random), uniform(random), uniform(random)};

  std::size_t known = 0;
  std::ifstream in(path);
  std::string row;
  for (std::getline(in, row); known < all.size() && std::getline(in, row); ++known) {
    std::replace(row.begin(), row.end(), ',', ' ');
    std::istringstream values(row);
    int outcome = 0;
    Exact& exact = all[known];
    Vec3& h = exact.force;
    if (!(values >> h[0] >> h[1] >> h[2] >> outcome >> exact.flags)) break;  // a run was killed
    exact.outcome = static_cast<Outcome>(outcome);
  }
  if (known == all.size()) return all;

  in.close();
  std::ofstream out(path);
  out.precision(17);
  out << "force_x,force_y,force_z,outcome,flags\n";
  const auto write = [&](const Exact& exact) {
    out << exact.force[0] << ',' << exact.force[1] << ',' << exact.force[2] << ','
        << static_cast<int>(exact.outcome) << ',' << exact.flags << std::endl;
  };
  for (std::size_t i = 0; i < known; ++i) write(all[i]);
  EquilibriumSolver solver(scene, {});
  solver.set_interaction(BondedPatches(scene.body, tool_space.interaction.tip_radius)
                             .around(tool_space.interaction.active_node));
  const Equilibrium rest = solver.rest();
  for (; known < all.size(); ++known) {
    Exact& exact = all[known];
    const Equilibrium found = solver.solve(exact.t, rest);
    exact.outcome = found.outcome;
    exact.flags = found.flags;
    if (exact.converged()) exact.force = found.reaction;
    write(exact);
  }
  return all;
}

/// The largest jump of the force, N, at random points of the faces between leaves of different
/// size: from one side of the face to the other, as far apart as rounding allows.
double largest_jump(const TouchToolSpace& tool_space, const Interpolator& interpolator) {
  struct Face {
    Vec3 first;
    double side;
    int axis;
  };
  const CheckPointGrid grid(tool_space);
  const auto reach = static_cast<double>(grid.reach());
  std::vector<Face> faces;
  for (std::size_t l = 0; l < grid.tree().leaves().size(); ++l) {
    const Cell& cell = grid.tree().leaves()[l].cell;
    const Vec3 first(cell.first[0], cell.first[1], cell.first[2]);
    for (int face = 0; face < 6; ++face) {
      Vec3 middle = first.array() + reach + 0.5 * cell.side;
      const int axis = face / 2;
      middle[axis] += (face % 2 == 0 ? -0.75 : 0.75) * cell.side;
      if (middle[axis] < 0 || middle[axis] > 2 * reach) continue;
      const std::int32_t other = grid.tree().locate(middle).leaf;
      const bool larger = grid.leaf(other).cell.side > cell.side;
      if (!larger || !grid.is_complete(other) || !grid.is_complete(static_cast<std::int32_t>(l))) {
        continue;
      }
      faces.push_back({first, static_cast<double>(cell.side), axis});
      if (face % 2 != 0) faces.back().first[axis] += cell.side;
    }
  }
  if (faces.empty()) return 0;
  std::mt19937_64 random(2008);
  std::uniform_int_distribution<std::size_t> any_face(0, faces.size() - 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double apart =
      4 * std::numeric_limits<double>::epsilon() * tool_space.setup.grid.half_width;
  double largest = 0;
  for (int i = 0; i < kFacePoints; ++i) {
    const Face& face = faces[any_face(random)];
    Vec3 t = face.first;
    for (int k = 0; k < 3; ++k) t[k] += k == face.axis ? 0 : face.side * uniform(random);
    t *= grid.spacing();
    const Vec3 step = apart * Vec3::Unit(face.axis);
    largest = std::max(
        largest,
        (interpolator.evaluate(t + step).force - interpolator.evaluate(t - step).force).norm());
  }
  return largest;
}

/// Of what a touch space holds.
double megabytes(const TouchSpace& space) {
  double bytes = 0;
  for (const TouchToolSpace& tool_space : space.tool_spaces) {
    bytes += static_cast<double>(sizeof(float)) *
                 static_cast<double>(tool_space.modes.size() + tool_space.coefficients.size() +
                                     tool_space.coefficient_gradients.size()) +
             static_cast<double>(sizeof(ConfigurationSummary) * tool_space.configurations.size());
  }
  return 1e-6 * bytes;
}

void print_row(const std::string& name, const Scene& scene, const PrecomputeOptions& options,
               const std::vector<Exact>& all) {
  const auto communicator = make_serial_communicator();
  const std::clock_t start = std::clock();
  const PrecomputeResult result = precompute(scene, options, *communicator, nullptr);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const TouchToolSpace& tool_space = result.space.tool_spaces.front();
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  double largest_force = 0;
  for (const ConfigurationSummary& c : tool_space.configurations) {
    if (c.leads_on()) largest_force = std::max(largest_force, c.force.norm());
  }
  std::vector<double> errors;
  int num_marked = 0;
  int num_irregular = 0;
  double worst_marked = 0;
  double worst_irregular = 0;
  double sum = 0;
  for (const Exact& exact : all) {
    const TouchResult touched = interpolator->evaluate(exact.t);
    const double error = 100 * (touched.force - exact.force).norm() / largest_force;
    if (touched.support != Support::inside) {
      ++num_marked;
      if (exact.regular()) worst_marked = std::max(worst_marked, error);
    } else if (exact.regular()) {
      errors.push_back(error);
      sum += error;
    } else {
      ++num_irregular;
      if (exact.converged()) worst_irregular = std::max(worst_irregular, error);
    }
  }
  std::sort(errors.begin(), errors.end());
  const auto num = static_cast<double>(all.size());
  std::printf("| %s | %zu | %.1f ", name.c_str(), tool_space.configurations.size(), seconds);
  if (errors.empty()) {
    std::printf("| | | ");
  } else {
    std::printf("| %.2g | %.2g | %.2g ", sum / static_cast<double>(errors.size()),
                errors[errors.size() * 99 / 100], errors.back());
  }
  std::printf("| %.1f | %.2g | %.1f | %.2g | %.1e | %.2f |\n", 100 * num_marked / num, worst_marked,
              100 * num_irregular / num, worst_irregular,
              largest_jump(tool_space, *interpolator) / largest_force, megabytes(result.space));
  std::fflush(stdout);
}

int main_of(const std::vector<std::string>& arguments) {
  if (arguments.size() < 3) {
    throw InputError(
        "Give a .palpate file, a half-width in m, a number of points, and spaces such "
        "as 1% or 7.");
  }
  const StateSpaceFile file = StateSpaceFile::open_read_only(arguments[0]);
  const Scene scene = file.read_scene();
  const ToolSpaceSetup tool_space = file.read_tool_spaces().front().setup;
  PrecomputeOptions options;
  options.active_nodes = {tool_space.interaction.active_node};
  options.tip_radius = tool_space.interaction.tip_radius;
  options.half_width = std::stod(arguments[1]);
  options.equilibrium.tolerance = 1e-9;
  options.equilibrium.single_precision = true;
  std::ostringstream path;
  path << arguments[0] << '_' << file.scene_hash().substr(0, 8) << '_'
       << tool_space.interaction.tip_radius << '_' << options.half_width << ".csv";
  const std::vector<Exact> exact =
      solve_exactly(scene, tool_space, options.half_width, std::stoi(arguments[2]), path.str());
  const auto num_regular =
      std::count_if(exact.begin(), exact.end(), [](const Exact& e) { return e.regular(); });
  std::printf("%zu points, from rest regular to %td\n\n", exact.size(), num_regular);
  std::printf(
      "| space | configurations | s | error: mean %% | 99 %% | largest %% | marked %% | "
      "error there %% | irregular %% | error there %% | jump | MB |\n"
      "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  for (std::size_t i = 3; i < arguments.size(); ++i) {
    const bool is_uniform = arguments[i].back() != '%';
    options.tolerance = is_uniform ? 0 : 0.01 * std::stod(arguments[i]);
    options.resolution = is_uniform ? std::stoi(arguments[i]) : 5;
    print_row(is_uniform ? "uniform, " + arguments[i] + "³" : arguments[i], scene, options, exact);
  }
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::main_of({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
