// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/guardian/host_watch.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "haptic/guardian/host_signals.h"

namespace palpate {
namespace {

constexpr std::uint64_t watched_signals() {
  std::uint64_t bits = 0;
  for (const HostSignal& watched : kHostSignals) bits |= std::uint64_t{1} << (watched.signal - 1);
  return bits;
}

/// The file is shorter than this, bytes.
constexpr std::size_t kSize = 8192;

/// @return The beginning of the value in the line with this name; nullptr: there is no such line.
const char* value_of(const std::string& text, const std::string& name) {
  const std::size_t line = text.find('\n' + name + ":\t");
  return line == std::string::npos ? nullptr : text.c_str() + line + name.size() + 3;
}

std::string read_status(pid_t process, std::int32_t thread) {
  const std::string path =
      "/proc/" + std::to_string(process) + "/task/" + std::to_string(thread) + "/status";
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  std::array<char, kSize> text{};
  const ssize_t size = ::read(file, text.data(), text.size());
  ::close(file);
  return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
}

}  // namespace

std::optional<ThreadStatus> parse_thread_status(const std::string& text) {
  const char* const state = value_of(text, "State");
  const char* const blocked = value_of(text, "SigBlk");
  const char* const voluntary = value_of(text, "voluntary_ctxt_switches");
  const char* const other = value_of(text, "nonvoluntary_ctxt_switches");
  if (state == nullptr || blocked == nullptr || voluntary == nullptr || other == nullptr) return {};
  ThreadStatus status;
  status.runs = *state == 'R';
  status.blocked = std::strtoull(blocked, nullptr, 16) & watched_signals();
  status.switches = std::strtoull(voluntary, nullptr, 10) + std::strtoull(other, nullptr, 10);
  return status;
}

bool HostWatch::hangs(Time now, const GuardianChannel& channel) {
  if (asked_at_ && now - *asked_at_ < kPeriod) return hangs_;
  asked_at_ = now;
  const std::int32_t said = channel.host_thread();
  const std::int32_t thread = said != 0 ? said : host_;
  const auto status = parse_thread_status(read_status(host_, thread));
  if (!status) return hangs_ = false;
  return hangs_ = hangs(now, thread, *status,
                        said != 0 ? std::optional(channel.host_lived()) : std::nullopt);
}

bool HostWatch::hangs(Time now, std::int32_t thread, const ThreadStatus& status,
                      std::optional<Time> host_lived) {
  if (std::exchange(thread_, thread) != thread) {
    blocked_ = status.blocked;
    ran_at_ = now;
  }
  // A signal that is blocked now but was not always counts. The program that starts the guardian
  // has blocked all signals for a moment, and may be seen so at the first look.
  blocked_ &= status.blocked;
  const bool has_run = std::exchange(switches_, status.switches) != status.switches;
  if (status.runs || has_run) ran_at_ = now;
  if ((status.blocked & ~blocked_) == 0) {
    handles_since_.reset();
  } else if (!handles_since_) {
    handles_since_ = now;
  }
  const bool is_silent = host_lived && now - std::max(ran_at_, *host_lived) > kSilence;
  return is_silent || (handles_since_ && now - *handles_since_ > kHandling);
}

}  // namespace palpate
