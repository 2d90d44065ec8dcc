// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/motion_kind.h"

#include <string>
#include <utility>

#include "base/error.h"
#include "interaction/kind_list.h"

namespace palpate {
namespace {

class TranslatedKind final : public MotionKind {
 public:
  TranslatedKind() = default;
  [[nodiscard]] ToolMotion number() const override { return ToolMotion::translated; }
  [[nodiscard]] PoseMapPtr make(const std::vector<double>& numbers) const override {
    if (numbers.empty()) return translated_pose();
    throw InputError("A tool that is translated has " + std::to_string(numbers.size()) +
                     " numbers for its motion, which has none. The file was damaged.");
  }
};

KindList<MotionKind>& kinds_of_motions() {
  static KindList<MotionKind> all("a motion of a tool", "A rigid tool has the unknown motion",
                                  std::make_unique<const TranslatedKind>());
  return all;
}

}  // namespace

const MotionKind& motion_kind(ToolMotion number) { return kinds_of_motions().get(number); }

void add_motion_kind(std::unique_ptr<const MotionKind> kind) {
  kinds_of_motions().add(std::move(kind));
}

}  // namespace palpate
