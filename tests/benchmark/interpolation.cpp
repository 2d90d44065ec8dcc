// SPDX-License-Identifier: BSD-3-Clause
// What an answer of the servo loop costs: force, stiffness and energy at points that jump about in
// a space of 7³ check-points, of these with five intermediate states on the way to each, in one of
// cells of five sizes, and in the sparse one of a rigid tool around a whole body; the error
// estimate of that; and the surface that is displayed. The floor of the triquintic is what it
// cannot do without: 8 × 27 values are read, and the sums take 3 · 216 + 6 · 36 + 10 · 6
// multiply-adds.
//
//   palpate_benchmark_interpolation --benchmark_repetitions=9
//     --benchmark_enable_random_interleaving=true --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>

#include <algorithm>
#include <random>
#include <vector>

#include "base/simd.h"
#include "interpolation/clearance.h"
#include "interpolation/display_field.h"
#include "interpolation/error_estimate.h"
#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/contact_space.h"

namespace palpate {
namespace {

constexpr int kModes = 40;
constexpr int kSurfaceDofs = 2400;

std::vector<Vec3> random_points() {
  test::RandomPoints random;
  std::vector<Vec3> points(4096);
  for (Vec3& t : points) t = random();
  return points;
}

/// A hand at 12 mm/s, once a ms: from one random place to the next in steps of 12 µm.
std::vector<Vec3> walk() {
  const double step = 1e-3 * test::kHalfWidth;
  test::RandomPoints random;
  std::vector<Vec3> points{random()};
  while (points.size() < (1 << 16)) {
    const Vec3 goal = random();
    while ((goal - points.back()).norm() > step) {
      points.push_back(points.back() + step * (goal - points.back()).normalized());
    }
  }
  return points;
}

/// 7³ check-points.
TouchToolSpace uniform() { return test::analytic_space(test::exponential); }

TouchToolSpace with_third_derivatives() {
  TouchToolSpace tool_space = uniform();
  test::add_third_derivatives(tool_space, test::exponential_third);
  return tool_space;
}

/// Five on the way to each check-point from its neighbour towards rest: 2053 centres.
TouchToolSpace with_intermediate_states() {
  TouchToolSpace tool_space = uniform();
  const double spacing = tool_space.setup.grid.spacing();
  for (const ConfigurationSummary& c : tool_space.configurations) {
    Vec3 step;
    for (int k = 0; k < 3; ++k) {
      step[k] = spacing * ((c.check_point[k] > 0) - (c.check_point[k] < 0));
    }
    if (step.isZero(0)) continue;
    for (int number = 1; number <= 5; ++number) {
      IntermediateState state;
      state.target = c.check_point;
      state.number = number;
      state.t = c.t + (number / 6.0 - 1) * step;
      const test::Sample sample = test::exponential(state.t);
      state.energy = sample.energy;
      state.force = sample.force;
      state.outcome = Outcome::converged;
      tool_space.intermediate_states.push_back(state);
    }
  }
  return tool_space;
}

void evaluate(benchmark::State& state, Method method, const TouchToolSpace& tool_space,
              const std::vector<Vec3>& points = random_points()) {
  const auto interpolator = make_interpolator(method, tool_space);
  std::size_t i = 0;
  for (auto _ : state) {
    TouchResult result = interpolator->evaluate(points[i]);
    benchmark::DoNotOptimize(result);
    // A division would take a tenth of the time.
    if (++i == points.size()) i = 0;
  }
  state.counters["samples"] = static_cast<double>(interpolator->num_samples());
  state.counters["bytes"] = static_cast<double>(interpolator->bytes());
}
BENCHMARK_CAPTURE(evaluate, linear, Method::linear, uniform());
BENCHMARK_CAPTURE(evaluate, trilinear, Method::trilinear, uniform());
BENCHMARK_CAPTURE(evaluate, tricubic, Method::tricubic, uniform());
BENCHMARK_CAPTURE(evaluate, energy_hermite, Method::energy_hermite, uniform());
BENCHMARK_CAPTURE(evaluate, energy_hermite_third, Method::energy_hermite, with_third_derivatives());
BENCHMARK_CAPTURE(evaluate, trilinear_walk, Method::trilinear, uniform(), walk());
BENCHMARK_CAPTURE(evaluate, energy_hermite_walk, Method::energy_hermite, with_third_derivatives(),
                  walk());
BENCHMARK_CAPTURE(evaluate, rbf_linear, Method::rbf_linear, uniform());
BENCHMARK_CAPTURE(evaluate, rbf_linear_intermediate, Method::rbf_linear,
                  with_intermediate_states());
BENCHMARK_CAPTURE(evaluate, rbf_cubic, Method::rbf_cubic, uniform());
BENCHMARK_CAPTURE(evaluate, rbf_cubic_intermediate, Method::rbf_cubic, with_intermediate_states());
BENCHMARK_CAPTURE(evaluate, trilinear_adaptive, Method::trilinear,
                  test::graded_space(test::exponential));
BENCHMARK_CAPTURE(evaluate, energy_hermite_adaptive, Method::energy_hermite,
                  test::graded_space(test::exponential));

const Vec3 kHalfAxes(0.05, 0.035, 0.03);

/// An ellipsoid of 100 × 70 × 60 mm, with cells of 8 mm that are halved to an error of some 0.1 %
/// of the largest force: 23 000 configurations.
const TouchToolSpace& whole_body() {
  static const TouchToolSpace whole = [] {
    const test::ContactExample contact = test::ellipsoid(Vec3(0.001, 0.0007, -0.0003), kHalfAxes);
    Grid grid;
    grid.sparse = true;
    grid.half_width = 0.064;
    grid.resolution = 257;
    grid.coarsest = 8;
    TouchToolSpace tool_space = test::contact_space(contact, grid, 0.008);
    const double tolerance = 0.03;
    for (std::vector<Cell> cells{{}}; !cells.empty();) {
      for (ConfigurationSummary& c : tool_space.configurations) {
        if (contact.depth(c.t).value > 0.008) c.flags = flags::beyond_force_limit;
      }
      cells = cells_to_split(grid, tool_space.configurations, tolerance, 1, tool_space.clearance);
      if (!cells.empty()) test::split(tool_space, contact, cells);
    }
    return tool_space;
  }();
  return whole;
}

/// In the shell in which the tool touches, up to 8 mm deep.
Vec3 random_place_in_shell(test::RandomPoints& random) {
  while (true) {
    const Vec3 q = random();
    const double level = q.cwiseQuotient(kHalfAxes).norm();
    if (level > 0.75 && level < 1.02) return q;
  }
}

std::vector<Vec3> random_places_in_shell() {
  test::RandomPoints random(0.06);
  std::vector<Vec3> points(4096);
  for (Vec3& t : points) t = random_place_in_shell(random);
  return points;
}

/// A hand at 50 mm/s, once a ms: over the surface from one place to the next, in and out of
/// contact.
std::vector<Vec3> walk_around() {
  test::RandomPoints random(0.06);
  std::vector<Vec3> points{random_place_in_shell(random)};
  while (points.size() < (1 << 16)) {
    const Vec3 goal = random_place_in_shell(random);
    const Vec3 start = points.back();
    const double length = (goal - start).norm();
    const double of_start = start.cwiseQuotient(kHalfAxes).norm();
    const double of_goal = goal.cwiseQuotient(kHalfAxes).norm();
    for (double way = 5e-5; way < length; way += 5e-5) {
      const double s = way / length;
      const Vec3 straight = start + s * (goal - start);
      const double level = straight.cwiseQuotient(kHalfAxes).norm();
      if (level < 0.1) break;  // through the middle there is no way over the surface
      points.push_back(((1 - s) * of_start + s * of_goal) / level * straight);
    }
  }
  return points;
}
BENCHMARK_CAPTURE(evaluate, energy_hermite_whole_body, Method::energy_hermite, whole_body(),
                  random_places_in_shell());
BENCHMARK_CAPTURE(evaluate, energy_hermite_whole_body_walk, Method::energy_hermite, whole_body(),
                  walk_around());

/// What a round of refinement takes to know what to split.
void estimate(benchmark::State& state) {
  const TouchToolSpace& tool_space = whole_body();
  for (auto _ : state) {
    benchmark::DoNotOptimize(cells_to_split(tool_space.setup.grid, tool_space.configurations, 0.03,
                                            1, tool_space.clearance));
  }
  state.counters["configurations"] = static_cast<double>(tool_space.configurations.size());
}
BENCHMARK(estimate)->Unit(benchmark::kMillisecond);

/// What a body takes that the space grows under: a chunk of 50 configurations near a hand, into the
/// space that has all others, beside making the interpolator of all anew.
/// @param grows Whether the interpolator grows.
void take_chunk(benchmark::State& state, bool grows) {
  TouchToolSpace tool_space = whole_body();
  tool_space.clearance = remembering(tool_space.clearance);
  std::vector<ConfigurationSummary>& all = tool_space.configurations;
  const Vec3 hand(0.03, 0.02, 0.02);
  std::nth_element(all.begin(), all.begin() + 50, all.end(), [&](const auto& a, const auto& b) {
    return (a.t - hand).squaredNorm() < (b.t - hand).squaredNorm();
  });
  std::vector<CheckPoint> changed;
  for (int i = 0; i < 50; ++i) changed.push_back(all[static_cast<std::size_t>(i)].check_point);
  const std::vector<ConfigurationSummary> chunk(all.begin(), all.begin() + 50);
  all.erase(all.begin(), all.begin() + 50);
  std::sort(all.begin(), all.end());
  const auto first = make_interpolator(Method::energy_hermite, tool_space);
  // One that has grown before knows what it needs to grow.
  const auto before = first->grown(tool_space, {});
  all.insert(all.end(), chunk.begin(), chunk.end());
  std::sort(all.begin(), all.end());
  for (auto _ : state) {
    benchmark::DoNotOptimize(make_interpolator(Method::energy_hermite, tool_space, {},
                                               grows ? before.get() : nullptr, changed));
  }
  state.counters["configurations"] = static_cast<double>(all.size());
}
BENCHMARK_CAPTURE(take_chunk, anew, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(take_chunk, grown, true)->Unit(benchmark::kMillisecond);

/// The system of the radial functions; the rest of the set-up is small.
void set_up(benchmark::State& state, Method method) {
  const TouchToolSpace tool_space = with_intermediate_states();
  for (auto _ : state) benchmark::DoNotOptimize(make_interpolator(method, tool_space));
}
BENCHMARK_CAPTURE(set_up, rbf_cubic_intermediate, Method::rbf_cubic)
    ->Unit(benchmark::kSecond)
    ->Iterations(1);

#ifdef PALPATE_X86_SIMD
/// Reads numbers in groups of four that stand together, each `times` in a multiply-add.
/// @param num In groups.
template <int times>
[[gnu::always_inline]] inline Four read_and_add(const double* data, int num,
                                                const double* weights) {
  Four sums[times] = {};
  for (int i = 0; i < num; ++i) {
    Four v;
    load(data + 4 * i, v);
#pragma GCC unroll 16
    for (int k = 0; k < times; ++k) sums[k] += weights[k] * v;
  }
  Four sum{};
  for (const Four& of_k : sums) sum += of_k;
  return sum;
}

/// Of a leaf of 7³ check-points: eight times 27 numbers; 54 groups with (648 + 216 + 60) / 216 ≈ 4
/// multiply-adds each.
[[gnu::target("avx2,fma")]] void floor_of_hermite(benchmark::State& state) {
  const std::vector<double> data(343 * 28, 1.0);
  const std::vector<double> weights(4, 0.5);
  std::mt19937 random(1);
  std::vector<int> leaves(4096);
  for (int& leaf : leaves) {
    leaf = static_cast<int>(49 * (random() % 6) + 7 * (random() % 6) + random() % 6);
  }
  std::size_t i = 0;
  for (auto _ : state) {
    const int leaf = leaves[i++ % leaves.size()];
    Four sum{};
    for (int corner = 0; corner < 8; ++corner) {
      const int node = leaf + 49 * (corner >> 2) + 7 * ((corner >> 1) & 1) + (corner & 1);
      sum += read_and_add<4>(data.data() + 28 * node, 7, weights.data());
    }
    benchmark::DoNotOptimize(sum);
  }
}

void floor_energy_hermite(benchmark::State& state) {
  if (best_instruction_set() == InstructionSet::baseline) {
    state.SkipWithError("There is no AVX2.");
  } else {
    floor_of_hermite(state);
  }
}
BENCHMARK(floor_energy_hermite);
#endif

void display(benchmark::State& state) {
  TouchToolSpace tool_space = test::analytic_space(test::exponential);
  const auto num_configurations = static_cast<Eigen::Index>(tool_space.configurations.size());
  tool_space.coefficients.setRandom(kModes, num_configurations);
  tool_space.coefficient_gradients.setRandom(3 * kModes, num_configurations);
  const DisplayField field(tool_space);
  const Eigen::MatrixXf modes = Eigen::MatrixXf::Random(kSurfaceDofs, kModes);
  const std::vector<Vec3> points = random_points();
  std::vector<float> coefficients(kModes);
  std::vector<float> displacement(kSurfaceDofs);
  std::size_t i = 0;
  for (auto _ : state) {
    field.coefficients(points[i++ % points.size()], coefficients.data());
    apply_modes(modes, coefficients.data(), displacement.data());
    benchmark::DoNotOptimize(displacement.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(display);

}  // namespace
}  // namespace palpate

BENCHMARK_MAIN();
