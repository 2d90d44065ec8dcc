// SPDX-License-Identifier: BSD-3-Clause
// What a call says is wrong with its input.
#pragma once

#include <string>

#include "base/error.h"

namespace palpate::test {

/// The message of the InputError that a call throws; empty: it throws none.
template <class Call>
[[nodiscard]] std::string message_of(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace palpate::test
