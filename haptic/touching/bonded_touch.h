// SPDX-License-Identifier: BSD-3-Clause
// A tool that is bonded to the place of the surface where it comes in (hold.h).
#pragma once

#include <memory>
#include <utility>

#include "haptic/touching/body_touch.h"

namespace palpate {

class BondedTouch final : public BodyTouch {
 public:
  explicit BondedTouch(std::shared_ptr<const Touchable> body, Relation relation = Relation::other)
      : BodyTouch(std::move(body)), relation_(relation) {}

  bool take_over(const Touch& before) noexcept override;
  [[nodiscard]] MemoryRanges memory() const override;

 private:
  [[nodiscard]] Contact touch(const HandState& hand,
                              const TouchSettings& settings) noexcept override;

  Relation relation_;
};

}  // namespace palpate
