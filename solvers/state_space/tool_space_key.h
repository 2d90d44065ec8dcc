// SPDX-License-Identifier: BSD-3-Clause
// The numbers by which a body and a tool space are known.
#pragma once

#include <cstdint>
#include <tuple>

namespace palpate {

/// The number of a body, which is one discretisation of an organ, within a file.
using BodyId = std::int64_t;
inline constexpr BodyId kFirstBody = 1;

/// The number of a tool space within its body: the active node, if it has one.
using ToolSpaceId = std::int64_t;
/// The number that a rigid tool's space is given.
inline constexpr ToolSpaceId kContactToolSpace = -1;

/// The key of a tool space in a state space.
struct ToolSpaceKey {
  ToolSpaceId id = 0;
  BodyId body = kFirstBody;
};

[[nodiscard]] inline bool operator<(const ToolSpaceKey& a, const ToolSpaceKey& b) {
  return std::tie(a.body, a.id) < std::tie(b.body, b.id);
}
[[nodiscard]] inline bool operator==(const ToolSpaceKey& a, const ToolSpaceKey& b) {
  return a.body == b.body && a.id == b.id;
}

}  // namespace palpate
