// SPDX-License-Identifier: BSD-3-Clause
// A tool that is bonded to the place of the surface where it comes in (hold.h), or that is a blade
// (blade.h).
#pragma once

#include <memory>
#include <utility>

#include "haptic/touching/blade.h"
#include "haptic/touching/body_touch.h"

namespace palpate {

class BondedTouch final : public BodyTouch {
 public:
  explicit BondedTouch(std::shared_ptr<const Touchable> body, Relation relation = Relation::other)
      : BodyTouch(std::move(body)), relation_(relation) {}

  bool take_over(const Touch& before) noexcept override;
  /// What is held while the tool is a blade stays held: it is not in this hand.
  void release() noexcept override;
  [[nodiscard]] MemoryRanges memory() const override;

 private:
  [[nodiscard]] Contact touch(const HandState& hand,
                              const TouchSettings& settings) noexcept override;

  /// What a tool feels that touches nothing.
  [[nodiscard]] Contact free(const SurfaceTree::Nearest& at) noexcept;
  [[nodiscard]] Contact cut(const HandState& hand, const TouchSettings& settings) noexcept;

  Relation relation_;
  bool is_blade_ = false;
  Blade blade_;
};

}  // namespace palpate
