// SPDX-License-Identifier: BSD-3-Clause
// What is said where there is not enough memory. std::bad_alloc says neither what the memory was
// for nor how much there is, so whoever knows what it was for catches it and throws a MemoryError.
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

/// The same as a string.
[[nodiscard]] std::string not_enough_memory(const char* purpose);

/// Finds out whether so much memory can be had, before a library asks for it that ends the process
/// where it cannot, or never ends. Takes none.
/// @throws MemoryError it cannot.
void require_memory(std::size_t bytes, const char* purpose);

/// Calls `body()`.
/// @param purpose What the body does, after "There is not enough memory": "to solve for a body";
/// null: it is not known.
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
