// SPDX-License-Identifier: BSD-3-Clause
// Where the programs are that ours start.
#pragma once

#include <string>

namespace palpate {

/// The program that the environment variable names; where it names none, the one that lies beside
/// the library or program that this is linked into, or in a folder `bin` beside or above that.
/// @param variable Of the environment. @param how What else to do where there is none.
/// @throws BackendError there is none; the message says where it was looked for.
[[nodiscard]] std::string find_program(const std::string& name, const std::string& variable,
                                       const std::string& how);

}  // namespace palpate
