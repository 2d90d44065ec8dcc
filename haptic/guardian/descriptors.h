// SPDX-License-Identifier: BSD-3-Clause
// The file descriptors that are open when the guardian's program starts.
#pragma once

namespace palpate::guardian_descriptors {

/// The socket that joins the program with its host.
inline constexpr int kLine = 0;
/// The memory of a GuardianChannel.
inline constexpr int kMemory = 1;
/// The last of them, the standard error.
inline constexpr int kLast = 2;

}  // namespace palpate::guardian_descriptors
