// SPDX-License-Identifier: BSD-3-Clause
// The system did what it was asked for, or the test ends.
#pragma once

#include <cerrno>
#include <system_error>

namespace palpate::test {

/// @throws std::system_error with errno.
inline void check(bool fine, const char* what) {
  if (!fine) throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace palpate::test
