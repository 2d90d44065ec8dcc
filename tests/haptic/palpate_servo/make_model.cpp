// SPDX-License-Identifier: BSD-3-Clause
// Makes a file with small reduced models for tests of programs: a block of tissue with two tools,
// and where it is asked for a state space of the same block, or gravity.
//
//   palpate_test_make_model models.palpate <number of models> [space | gravity]
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "exploration/precompute.h"
#include "interaction/bonded_patch.h"
#include "reduction/kept_model.h"
#include "solvers/support/block.h"

namespace palpate {
namespace {

void make(const std::string& path, int num_models, const std::string& what) {
  const test::Block block =
      test::make_block(Law::neo_hookean, {ElementOrder::linear, {2, 1, 1}, 0.1, 3000, 0.35});
  ReductionTools tools;
  const BondedPatches patches(block.scene.body, 0);
  for (const Index node : {block.corner, block.middle}) {
    tools.nodes.push_back(node);
    tools.patches.push_back(patches.around(node));
  }
  Rheology rheology;
  rheology.density = 1000;
  rheology.viscous_time = 0.02;
  ReductionOptions options;
  options.reach = 0.01;
  if (what == "gravity") options.gravity.z() = -9.81;
  options.training_paths = 2;
  options.path_duration = 0.1;
  options.all_tools_states = 4;
  MeasureOptions measure;
  measure.equilibria = 1;
  const auto communicator = make_serial_communicator();
  for (int number = 0; number < num_models; ++number) {
    options.modes = 4 + 2 * number;
    (void)build_kept_model(block.scene, {rheology}, tools, options, measure, path, *communicator);
  }
  if (what == "space") {
    PrecomputeOptions of_space;
    of_space.active_nodes = {block.corner, block.middle};
    of_space.half_width = 0.01;
    of_space.resolution = 3;
    of_space.file = path;
    (void)precompute(block.scene, of_space, *communicator, nullptr);
  }
  std::printf("%d %d\n", block.corner, block.middle);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) return EXIT_FAILURE;
  const std::string what = argc == 4 ? argv[3] : "";
  if (argc == 4 && what != "space" && what != "gravity") return EXIT_FAILURE;
  try {
    palpate::make(argv[1], std::atoi(argv[2]), what);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
