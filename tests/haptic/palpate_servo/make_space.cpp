// SPDX-License-Identifier: BSD-3-Clause
// Makes small state spaces for tests of programs: a block of tissue with two active nodes, and the
// same block with a rigid sphere that presses its top, whole or in part, and holds one of them.
//
//   palpate_test_make_space block.palpate
//   palpate_test_make_space pressed.palpate whole | part
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

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
  if (extent.empty()) return options;
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
  if (argc < 2 || argc > 3 || (argc == 3 && extent != "whole" && extent != "part")) {
    return EXIT_FAILURE;
  }
  const test::Block block =
      test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}, 0.1, 3000, 0.35});
  try {
    PrecomputeOptions options = options_for(block, extent);
    options.file = argv[1];
    const auto communicator = make_serial_communicator();
    (void)precompute(block.scene, options, *communicator, nullptr);
    std::printf("%d %d\n", block.corner, block.middle);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
