// SPDX-License-Identifier: BSD-3-Clause
// The communicator of a test program: all ranks it was started with.
#pragma once

#include <memory>

#include "schedule/communicator.h"

namespace palpate::test {

/// The world where the build has MPI, else one rank.
[[nodiscard]] std::unique_ptr<Communicator> make_world();

/// Whether a test whose subject is not the ranks would only repeat here what its run on one rank
/// shows: others show that any number of ranks finds the same to the bit.
[[nodiscard]] inline bool is_repetition(const Communicator& world) { return world.size() > 1; }

}  // namespace palpate::test
