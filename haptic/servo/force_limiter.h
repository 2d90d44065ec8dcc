// SPDX-License-Identifier: BSD-3-Clause
// The last step of a force before the device, on every path.
#pragma once

#include <cstdint>

#include "base/types.h"

namespace palpate {

class ForceLimiter {
 public:
  /// What may be sent of a force: finite, not above the largest, and not further from the last one
  /// than the step. What is not finite becomes zero, at once.
  /// @param largest N. @param step N.
  /// @param limited Bits of namespace limits, set where they hold.
  /// @note Realtime-safe.
  [[nodiscard]] Vec3 limit(const Vec3& wanted, double largest, double step,
                           std::uint32_t& limited) noexcept;

  /// Zero was sent.
  void reset() noexcept { last_.setZero(); }

 private:
  Vec3 last_ = Vec3::Zero();
};

}  // namespace palpate
