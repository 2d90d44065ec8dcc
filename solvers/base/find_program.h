// SPDX-License-Identifier: BSD-3-Clause
// Finds the programs that our own programs start.
#pragma once

#include <string>

namespace palpate {

/// The program that the environment variable names. If it is not set, the one beside the library or
/// program that this is linked into, or in a folder `bin` beside or above it.
/// @param variable The name of the environment variable.
/// @param how What the user may do instead if the program is missing, as the start of a sentence.
/// @throws BackendError there is no such program; the message says where it was sought.
[[nodiscard]] std::string find_program(const std::string& name, const std::string& variable,
                                       const std::string& how);

}  // namespace palpate
