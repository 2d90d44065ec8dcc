// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/guardian/watch.h"

#include <algorithm>
#include <utility>

namespace palpate {

Watch::Step Watch::look(Time now, Host host) noexcept {
  using Action = Step::Action;
  channel_.look(now);
  if (host == Host::finished) return {Action::end, Duration(0)};
  const bool is_dead = host == Host::dead;
  channel_.say_host_hangs(host == Host::hanging);
  const bool must_rest = is_dead || channel_.host() != HostState::living;
  if (is_dead && !std::exchange(host_was_dead_, true)) num_taken_ = 0;
  if (is_dead && num_taken_ >= kLastZeros) return {Action::end, Duration(0)};
  if (!channel_.tripped()) {
    if (!must_rest) {
      tripped_at_.reset();
      const Duration left = channel_.until_loop_is_silent(now);
      if (left.count() > 0) {
        return {Action::none, std::min<Duration>(left, GuardianChannel::kLook)};
      }
    }
    channel_.trip();
  }
  if (!tripped_at_) tripped_at_ = now;
  return {Action::zero, now - *tripped_at_ < kNew ? kZeroPeriod : kSlowZeroPeriod};
}

}  // namespace palpate
