// SPDX-License-Identifier: BSD-3-Clause
// How near contact comes to what is known in closed form: a sphere that is pressed into a
// half-space (hertz.h) or, by default, into a layer of tissue (bonded_layer.h), one that slides
// over a flat block (sliding.h), and one that is moved aside with friction (mindlin.h) or bonded
// (bonded_disc.h). Prints the tables of README.md.
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_contact hertz
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_contact layer
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_contact sliding
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_contact friction
#include <chrono>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "haptic/support/mindlin.h"
#include "interaction/rigid_tool.h"
#include "solvers/support/bonded_disc.h"
#include "solvers/support/bonded_layer.h"
#include "solvers/support/half_space.h"
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

const std::vector<double> kDepths{0.02, 0.05, 0.1, 0.2, 0.3};

/// As the filters press, with a layer of this thickness, m; 0: the one that is calibrated.
std::vector<LayerPress> press_layer_with(const BondedLayer& layer, const Scene& scene,
                                         double thickness) {
  RigidTool tool;
  tool.radius = layer.radius;
  tool.law.thickness = thickness;
  const ContactLaw law = with_defaults(tool, scene).law;
  return press_layer(
      layer, scene,
      std::make_shared<const ContactSurface>(scene.body, kSpacingOfThickness * law.thickness), law,
      kDepths);
}

void print_layer(BondedLayer layer) {
  const Scene scene = make_bonded_layer(layer);
  const std::vector<LayerPress> calibrated = press_layer_with(layer, scene, 0);
  const std::vector<LayerPress> thick =
      press_layer_with(layer, scene, kThicknessOfRadius * layer.radius);
  const auto hard = [&](const Scene& body) {
    return press_layer(layer, body, hard_surface(body), hard_law(layer), kDepths);
  };
  const std::vector<LayerPress> same = hard(scene);
  layer.edges *= 2;
  const std::vector<LayerPress> fine = hard(make_bonded_layer(layer));
  for (std::size_t i = 0; i < kDepths.size(); ++i) {
    const auto error = [&](double force) { return percent(force / fine[i].force); };
    const auto told = [&](const LayerPress& press) {
      return 100 * press.layer_force / fine[i].force;
    };
    std::printf("| %g | %s | %g | %.5f | %+.1f | %+.1f | %+.1f | %+.1f | %+.0f | %+.0f |\n",
                1e3 * layer.radius, to_string(layer.law).c_str(), kDepths[i], fine[i].force,
                error(same[i].force), error(closed_form(layer, kDepths[i])),
                error(calibrated[i].force), told(calibrated[i]), error(thick[i].force),
                told(thick[i]));
  }
  std::fflush(stdout);
}

void run_layer() {
  std::puts(
      "| R, mm | law | depth, R | hard, N | half as fine, % | closed form, % | by default, % | "
      "of which is told, % | 0.2 R thick, % | of which is told, % |\n"
      "|---|---|---|---|---|---|---|---|---|---|");
  for (const double radius : {0.005, 0.01, 0.02}) {
    for (const Law law : {Law::linear, Law::neo_hookean}) {
      BondedLayer layer;
      layer.radius = radius;
      layer.law = law;
      print_layer(layer);
    }
  }
}

void print_sliding(double thickness) {
  for (const double edge : {0.02, 0.01, 0.005}) {
    for (int seed = 1; seed <= (edge < 0.01 ? 1 : 3); ++seed) {
      const Clock clock;
      // Two edges long.
      const SlidingOptions options{edge, static_cast<int>(2 * edge / kSlidingStep), seed,
                                   thickness};
      const SlidingResult r = slide(options);
      std::printf("| %g | %g | %d | %d | %d | %.2f | %.2f | %.3f | %.0f |\n", 1e3 * thickness,
                  1e3 * edge, seed, options.steps, r.num_unknowns, 100 * r.lateral,
                  100 * r.stiffness_jump, 100 * r.roughness, clock.seconds());
      std::fflush(stdout);
    }
  }
}

/// 0: the layer is calibrated.
void run_sliding() {
  std::puts(
      "| δ, mm | edges, mm | mesh | steps | unknowns | lateral force, % | jump of k, % | "
      "roughness, % | s |\n"
      "|---|---|---|---|---|---|---|---|---|");
  for (const double thickness : {0.0, 0.002}) print_sliding(thickness);
}

constexpr double kPoissonsRatios[] = {0.3, 0.4, 0.45, 0.49};

/// The contact without friction that Friction is told in both of its tables.
HertzResult press(double poissons_ratio) {
  HertzOptions options{8, 0.02, 512, 16, 4};
  options.poissons_ratio = poissons_ratio;
  return press_half_space(options);
}

/// Returns k_t of Friction over that of the half-space, for each of Poisson's ratios.
std::vector<double> run_yielding() {
  std::puts(
      "| ν | μ | P, % | k_n, % | k_t, % | Q where it slips, % | largest error of Q, % of μP |\n"
      "|---|---|---|---|---|---|---|");
  std::vector<double> stiffness;
  for (const double nu : kPoissonsRatios) {
    const HertzResult contact = press(nu);
    stiffness.push_back(move_aside(contact, nu, 1).stiffness);
    for (const double coefficient : {0.2, 0.5}) {
      const FrictionResult r = move_aside(contact, nu, coefficient);
      std::printf("| %g | %g | %+.2f | %+.2f | %+.1f | %+.2f | %.1f |\n", nu, coefficient,
                  percent(contact.force), percent(contact.stiffness), percent(r.stiffness),
                  percent(r.slipping), 100 * r.error);
      std::fflush(stdout);
    }
  }
  return stiffness;
}

BondedDiscResult print_bonded(const char* what, const BondedDiscOptions& options) {
  const Clock clock;
  const BondedDiscResult r = move_bonded_disc(options);
  std::printf("| %s | %g | %d | %g | %d | %d | %+.2f | %+.2f | %.0f | |\n", what,
              options.poissons_ratio, options.edges, options.extent, options.sectors,
              r.num_unknowns, percent(r.into), percent(r.along), clock.seconds());
  std::fflush(stdout);
  return r;
}

/// @param stiffness As run_yielding() returns it.
void run_bonded(const std::vector<double>& stiffness) {
  std::puts(
      "| | ν | edges in a | size/a | sectors | unknowns | into, % | along, % | s | Friction / "
      "along, % |\n"
      "|---|---|---|---|---|---|---|---|---|---|");
  const BondedDiscOptions middle{0.4, 4, 512, 16};
  BondedDiscOptions options = middle;
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    options.poissons_ratio = kPoissonsRatios[i];
    BondedDiscResult coarse;
    BondedDiscResult fine;
    for (options.edges = 2; options.edges <= 16; options.edges *= 2) {
      coarse = fine;
      fine = print_bonded("edges", options);
    }
    const BondedDiscResult r = extrapolate(coarse, fine);
    std::printf("| extrapolated | %g | ∞ | %g | %d | | %+.2f | %+.2f | | %+.1f |\n",
                options.poissons_ratio, options.extent, options.sectors, percent(r.into),
                percent(r.along), percent(stiffness[i] / r.along));
  }
  for (const double extent : {64, 128, 256, 1024}) {
    options = middle;
    options.extent = extent;
    (void)print_bonded("size", options);
  }
  options = middle;
  options.sectors = 32;
  (void)print_bonded("sectors", options);
}

int run(const std::string& what) {
  if (what == "hertz") {
    run_hertz();
  } else if (what == "layer") {
    run_layer();
  } else if (what == "sliding") {
    run_sliding();
  } else if (what == "friction") {
    const std::vector<double> stiffness = run_yielding();
    std::puts("");
    run_bonded(stiffness);
  } else {
    std::fputs("Usage: palpate_benchmark_contact hertz|layer|sliding|friction\n", stderr);
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
