// SPDX-License-Identifier: BSD-3-Clause
// What an answer of the servo loop costs: force, stiffness and energy at points that jump about in
// a space of 7³ check-points and in one of cells of five sizes, and the surface that is displayed.
#include <benchmark/benchmark.h>

#include <vector>

#include "interpolation/display_field.h"
#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_site.h"

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

void evaluate(benchmark::State& state, Method method, const TouchSite& site) {
  const auto interpolator = make_interpolator(method, site);
  const std::vector<Vec3> points = random_points();
  std::size_t i = 0;
  for (auto _ : state) {
    TouchResult result = interpolator->evaluate(points[i++ % points.size()]);
    benchmark::DoNotOptimize(result);
  }
}
BENCHMARK_CAPTURE(evaluate, trilinear, Method::trilinear,
                  test::analytic_site(test::exponential));
BENCHMARK_CAPTURE(evaluate, energy_hermite, Method::energy_hermite,
                  test::analytic_site(test::exponential));
BENCHMARK_CAPTURE(evaluate, trilinear_adaptive, Method::trilinear,
                  test::graded_site(test::exponential));
BENCHMARK_CAPTURE(evaluate, energy_hermite_adaptive, Method::energy_hermite,
                  test::graded_site(test::exponential));

void display(benchmark::State& state) {
  TouchSite site = test::analytic_site(test::exponential);
  const auto num_configurations = static_cast<Eigen::Index>(site.configurations.size());
  site.coefficients.setRandom(kModes, num_configurations);
  site.coefficient_gradients.setRandom(3 * kModes, num_configurations);
  const DisplayField field(site);
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
