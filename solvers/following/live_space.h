// SPDX-License-Identifier: BSD-3-Clause
// A space that is explored around a hand, for those who show it meanwhile. Only its explorer can
// read its file, so the fields come from here. Several threads may ask at the same time.
#pragma once

#include <cstdint>
#include <memory>

#include "fields/field_source.h"
#include "interpolation/tool_force.h"
#include "state_space/space_body.h"
#include "state_space/touch_space.h"

namespace palpate {

class LiveSpace {
 public:
  virtual ~LiveSpace() = default;

  /// What was found so far.
  struct State {
    /// It changes when something is found.
    std::int64_t number = 0;
    std::shared_ptr<const TouchToolSpace> tool_space;
    /// The force on the rigid tool, by this tool space alone.
    std::shared_ptr<const ToolForce> force;
  };
  [[nodiscard]] virtual State newest() = 0;
  [[nodiscard]] virtual const SpaceBody& body() const = 0;
  [[nodiscard]] virtual FieldSource& fields() = 0;
  /// Ends the exploration, so that others may have the file. @throws BackendError not all that was
  /// found can be kept.
  virtual void end() = 0;
};

}  // namespace palpate
