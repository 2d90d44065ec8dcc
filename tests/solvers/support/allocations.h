// SPDX-License-Identifier: BSD-3-Clause
// Counts what a program allocates: functions of the system are replaced where allocations.cpp is
// linked.
#pragma once

namespace palpate::test {

/// False where the functions are not to be replaced: with another library than glibc, and under the
/// sanitizers that replace them themselves.
extern const bool kCountsAllocations;

/// Of all threads since the program has started: allocations, those of Eigen too, which are none of
/// operator new, and releases.
long num_allocations();

}  // namespace palpate::test
