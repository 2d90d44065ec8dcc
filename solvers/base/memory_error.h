// SPDX-License-Identifier: BSD-3-Clause
// The error that there is not enough memory. std::bad_alloc says neither what the memory was for
// nor how much there is, so the caller that knows the purpose catches it and throws a MemoryError.
#pragma once

#include <cstddef>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

#include "base/error.h"

namespace palpate {

class MemoryError : public BackendError {
 public:
  using BackendError::BackendError;
};

/// Long enough for what describe_memory() says.
inline constexpr std::size_t kMemoryTextBytes = 600;

/// Writes into `text` that there is not enough memory for `purpose` (null: it is not known), what
/// this process has had and may have, and what to do. Allocates nothing.
void describe_memory(const char* purpose, char (&text)[kMemoryTextBytes]) noexcept;

/// The text of describe_memory() as a string.
[[nodiscard]] std::string not_enough_memory(const char* purpose);

/// Checks that this much memory can be had, before a call of a library that would end the process,
/// or never return, without it. Allocates nothing lasting.
/// @throws MemoryError it cannot be had.
void require_memory(std::size_t bytes, const char* purpose);

/// Calls `body()`.
/// @param purpose What the body does, to follow "There is not enough memory": "to solve for a
///   body". Null where it is not known.
/// @throws MemoryError the body has thrown std::bad_alloc.
template <class Body>
decltype(auto) with_memory(const char* purpose, Body&& body) {
  try {
    return std::forward<Body>(body)();
  } catch (const std::bad_alloc&) {
    throw MemoryError(not_enough_memory(purpose));
  }
}

}  // namespace palpate
