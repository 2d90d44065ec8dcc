// SPDX-License-Identifier: BSD-3-Clause
// The communicator of a test program: all ranks it was started with.
#pragma once

#include <memory>

#include "schedule/communicator.h"

namespace palpate::test {

/// The world where the build has MPI, else one rank.
[[nodiscard]] std::unique_ptr<Communicator> make_world();

}  // namespace palpate::test
