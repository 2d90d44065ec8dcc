// SPDX-License-Identifier: BSD-3-Clause
// What the guardian's program finds open when it starts.
#pragma once

namespace palpate::guardian_descriptors {

/// The socket that joins it with the host.
inline constexpr int kLine = 0;
/// The memory of a GuardianChannel.
inline constexpr int kMemory = 1;
/// After the standard error there is nothing.
inline constexpr int kLast = 2;

}  // namespace palpate::guardian_descriptors
