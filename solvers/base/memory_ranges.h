// SPDX-License-Identifier: BSD-3-Clause
// The memory that an object holds, as ranges: to sum up its size, or to lock it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace palpate {

struct MemoryRange {
  const void* begin = nullptr;
  std::size_t bytes = 0;
};

using MemoryRanges = std::vector<MemoryRange>;

/// Adds the memory of a vector, without what its elements point to.
template <class T, class Allocator>
void add_memory(const std::vector<T, Allocator>& values, MemoryRanges& ranges) {
  if (!values.empty()) ranges.push_back({values.data(), values.size() * sizeof(T)});
}

/// Adds the memory of a matrix or vector of dynamic size.
template <class Derived>
void add_memory(const Eigen::PlainObjectBase<Derived>& values, MemoryRanges& ranges) {
  if (values.size() == 0) return;
  ranges.push_back(
      {values.data(), static_cast<std::size_t>(values.size()) * sizeof(*values.data())});
}

/// The size of all ranges together.
[[nodiscard]] inline std::size_t total_bytes(const MemoryRanges& ranges) {
  std::size_t bytes = 0;
  for (const MemoryRange& range : ranges) bytes += range.bytes;
  return bytes;
}

}  // namespace palpate
