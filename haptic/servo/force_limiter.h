// SPDX-License-Identifier: BSD-3-Clause
// The limiter: every force but zero passes it last, before the device's profile makes a report of
// it.
#pragma once

#include <cstdint>

#include "base/types.h"

namespace palpate {

/// The force that may be sent: it is no longer than `largest` and differs from `last` by no more
/// than `step`. A force that is not finite becomes zero at once.
/// @param last The force that the motors have now, N.
/// @param largest N.
/// @param step N.
/// @param limited Bits of namespace limits (tick.h), set where they hold.
/// @note Realtime-safe.
[[nodiscard]] Vec3 limit_force(const Vec3& wanted, const Vec3& last, double largest, double step,
                               std::uint32_t& limited) noexcept;

}  // namespace palpate
