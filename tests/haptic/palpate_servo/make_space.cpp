// SPDX-License-Identifier: BSD-3-Clause
// Makes a small state space for test_palpate_servo.py: a block of tissue with two active nodes.
//
//   palpate_test_make_space block.palpate
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "exploration/precompute.h"
#include "solvers/support/block.h"

int main(int argc, char** argv) {
  using namespace palpate;
  if (argc != 2) return EXIT_FAILURE;
  const test::Block block =
      test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}, 0.1, 3000, 0.35});
  PrecomputeOptions options;
  options.active_nodes = {block.corner, block.middle};
  options.half_width = 0.01;
  options.resolution = 3;
  options.file = argv[1];
  try {
    const auto communicator = make_serial_communicator();
    (void)precompute(block.scene, options, *communicator, nullptr);
    std::printf("%d %d\n", block.corner, block.middle);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
