// SPDX-License-Identifier: BSD-3-Clause
// The limiter: the last step of a force before the device, on every path.
#pragma once

#include <cstdint>

#include "base/types.h"

namespace palpate {

/// The part of a force that may be sent: it is not longer than the largest, and not further from
/// the last one than the step. A force that is not finite becomes zero at once.
/// @param last The force that the motors have, N.
/// @param largest N.
/// @param step N.
/// @param limited Bits of namespace limits (tick.h), set where they hold.
/// @note Realtime-safe.
[[nodiscard]] Vec3 limit_force(const Vec3& wanted, const Vec3& last, double largest, double step,
                               std::uint32_t& limited) noexcept;

}  // namespace palpate
