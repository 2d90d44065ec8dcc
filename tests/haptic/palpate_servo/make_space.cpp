// SPDX-License-Identifier: BSD-3-Clause
// Makes small state spaces for tests of programs: a block of tissue with two active nodes, and the
// same block with a rigid sphere that presses its top, whole or in part, and holds one of them.
//
//   palpate_test_make_space block.palpate
//   palpate_test_make_space pressed.palpate whole | part
//
// With "bodies", the block has a second, finer mesh with an active node of its own, whose number is
// printed last.
//
//   palpate_test_make_space both.palpate bodies
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "exploration/precompute.h"
#include "solvers/support/block.h"

namespace palpate {
namespace {

/// @param extent Empty: there is no sphere.
PrecomputeOptions options_for(const test::Block& block, const std::string& extent) {
  PrecomputeOptions options;
  options.active_nodes = {block.corner, block.middle};
  options.half_width = 0.01;
  options.resolution = 3;
  if (extent.empty() || extent == "bodies") return options;
  options.contact.emplace();
  options.contact->tool.radius = 0.012;
  options.contact->spacing = 0.005;
  options.contact->shell.depth = 0.006;
  const double from = extent == "part" ? 0.05 : 0.02;
  options.contact->shell.region = [from](const Vec3& place) {
    return place.z() > 0.045 && place.x() > from;
  };
  return options;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  using namespace palpate;
  const std::string extent = argc == 3 ? argv[2] : "";
  if (argc < 2 || argc > 3 ||
      (argc == 3 && extent != "whole" && extent != "part" && extent != "bodies")) {
    return EXIT_FAILURE;
  }
  const test::Block block =
      test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}, 0.1, 3000, 0.35});
  try {
    PrecomputeOptions options = options_for(block, extent);
    options.file = argv[1];
    const auto communicator = make_serial_communicator();
    std::vector<BodyOfRun> bodies{
        {std::make_shared<const Scene>(block.scene), options.active_nodes}};
    std::printf("%d %d", block.corner, block.middle);
    if (extent == "bodies") {
      options.keep = Keep::all;
      const test::Block finer =
          test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {4, 2, 2}, 0.1, 3000, 0.35});
      bodies.push_back({std::make_shared<const Scene>(finer.scene), {finer.middle}});
      std::printf(" %d", finer.middle);
    }
    std::printf("\n");
    (void)precompute(bodies, options, *communicator, nullptr);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
