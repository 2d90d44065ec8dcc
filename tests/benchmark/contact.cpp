// SPDX-License-Identifier: BSD-3-Clause
// How near contact comes to what is known in closed form: a sphere that is pressed into a
// half-space (hertz.h), and one that slides over a flat block (sliding.h). Prints the tables of
// README.md.
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_contact hertz
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_contact sliding
#include <chrono>
#include <cstdio>
#include <exception>
#include <string>

#include "solvers/support/hertz.h"
#include "solvers/support/sliding.h"

namespace palpate::test {
namespace {

class Clock {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

double percent(double ratio) { return 100 * (ratio - 1); }

void print_hertz(const char* what, const HertzOptions& options) {
  const Clock clock;
  const HertzResult r = press_half_space(options);
  std::printf(
      "| %s | %d | %g | %g | %d | %d | %d | %+.2f | %+.2f | %+.2f | %+.2f | %.1f | %.0f |\n", what,
      options.edges, options.thickness, options.extent, options.sectors, options.divisions,
      r.num_unknowns, percent(r.force), percent(r.force_from_middle), percent(r.stiffness),
      percent(r.radius), 100 * r.pressure_error, clock.seconds());
  std::fflush(stdout);
}

void run_hertz() {
  std::puts(
      "| | edges in a | δ/d | size/a | sectors | divisions | unknowns | force, % | from the "
      "middle, % "
      "| stiffness, % | a, % | p, % of p₀ | s |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  HertzOptions options{2, 0.08, 128, 16, 4};
  for (; options.edges <= 16; options.edges *= 2) {
    print_hertz("all together", options);
    options.thickness /= 2;
    options.extent *= 2;
  }
  const HertzOptions middle{4, 0.02, 512, 16, 4};
  print_hertz("beside these", middle);
  options = middle;
  options.edges *= 2;
  print_hertz("edges", options);
  for (const double thickness : {0.16, 0.08, 0.04, 0.01}) {
    options = middle;
    options.thickness = thickness;
    print_hertz("thickness", options);
  }
  for (const double extent : {64, 128, 256, 1024, 2048}) {
    options = middle;
    options.extent = extent;
    print_hertz("size", options);
  }
  options = middle;
  options.sectors = 32;
  print_hertz("sectors", options);
  options = middle;
  options.divisions = 8;
  print_hertz("divisions", options);
}

void run_sliding() {
  std::puts(
      "| edges, mm | mesh | steps | unknowns | lateral force, % | jump of k, % | roughness, % | s "
      "|\n"
      "|---|---|---|---|---|---|---|---|");
  for (const double edge : {0.02, 0.01, 0.005}) {
    for (int seed = 1; seed <= (edge < 0.01 ? 1 : 3); ++seed) {
      const Clock clock;
      // Two edges long.
      const SlidingOptions options{edge, static_cast<int>(2 * edge / kSlidingStep), seed};
      const SlidingResult r = slide(options);
      std::printf("| %g | %d | %d | %d | %.2f | %.2f | %.3f | %.0f |\n", 1e3 * edge, seed,
                  options.steps, r.num_unknowns, 100 * r.lateral, 100 * r.stiffness_jump,
                  100 * r.roughness, clock.seconds());
      std::fflush(stdout);
    }
  }
}

int run(const std::string& what) {
  if (what == "hertz") {
    run_hertz();
  } else if (what == "sliding") {
    run_sliding();
  } else {
    std::fputs("Usage: palpate_benchmark_contact hertz|sliding\n", stderr);
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace palpate::test

int main(int argc, char** argv) {
  try {
    return palpate::test::run(argc == 2 ? argv[1] : "");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
