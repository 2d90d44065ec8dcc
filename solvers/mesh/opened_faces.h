// SPDX-License-Identifier: BSD-3-Clause
// Which faces of the cells of a body open as it is cut.
#pragma once

#include <array>
#include <cstdint>

namespace palpate {

/// The stage from which on the face opposite to each corner of a cell is open; 0: it never is.
using OpenedFaces = std::array<std::int32_t, 4>;

/// Whether a face of a cell opens at all, and whether it is open at a stage.
[[nodiscard]] constexpr bool opens(std::int32_t opens_at) { return opens_at > 0; }
[[nodiscard]] constexpr bool is_open(std::int32_t opens_at, std::int32_t stage) {
  return opens_at > 0 && opens_at <= stage;
}

}  // namespace palpate
