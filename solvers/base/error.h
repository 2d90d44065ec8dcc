// SPDX-License-Identifier: BSD-3-Clause
// Exceptions. Non-convergence is not one of them: it is a result, see base/outcome.h.
#pragma once

#include <stdexcept>
#include <string>

namespace palpate {

/// What the user gave cannot be used: the message says what is wrong, where, and what to do.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The environment failed: a file that cannot be written, a library out of memory.
class BackendError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace palpate
