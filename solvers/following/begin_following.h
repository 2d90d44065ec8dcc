// SPDX-License-Identifier: BSD-3-Clause
// What there is of a space before it is explored around a hand.
#pragma once

#include <functional>
#include <memory>

#include "exploration/precompute_options.h"
#include "state_space/space_body.h"
#include "state_space/touch_space.h"

namespace palpate {

struct BegunSpace {
  SpaceBody body;
  TouchSpace space;
};

/// Opens the space, and makes its file. It has what the file has already, and one configuration at
/// least: if the file has none, that which comes first where the exploration is to begin
/// (ShellOptions::begin_at).
/// @param abort_requested Called within a solve; true ends it.
/// @throws InputError as FollowSession and Explorer do; no configuration can be reached.
/// @throws BackendError nothing can be kept, or it was aborted.
[[nodiscard]] BegunSpace begin_following(std::shared_ptr<const Scene> scene,
                                         const PrecomputeOptions& options,
                                         const std::function<bool()>& abort_requested = {});

}  // namespace palpate
