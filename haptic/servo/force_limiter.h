// SPDX-License-Identifier: BSD-3-Clause
// The last step of a force before the device, on every path.
#pragma once

#include <cstdint>

#include "base/types.h"

namespace palpate {

/// What may be sent of a force: finite, not longer than the largest, and not further from the last
/// one than the step. What is not finite becomes zero, at once.
/// @param last What the motors have, N.
/// @param largest N. @param step N.
/// @param limited Bits of namespace limits (tick.h), set where they hold.
/// @note Realtime-safe.
[[nodiscard]] Vec3 limit_force(const Vec3& wanted, const Vec3& last, double largest, double step,
                               std::uint32_t& limited) noexcept;

}  // namespace palpate
