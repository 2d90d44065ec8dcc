// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/guardian/host_signals.h"

#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <mutex>
#include <string>

#include "base/error.h"

namespace palpate {
namespace {

/// The number of devices that are open at a time, at the most.
constexpr std::size_t kMostChannels = 32;

// A handler has nobody to ask: what it uses is here.
std::array<std::atomic<GuardianChannel*>, kMostChannels> channels{};
/// What was there before, of each signal; written while the handler is not in front.
std::array<struct sigaction, kHostSignals.size()> before{};
/// How often the handler was called since it was put there, of each signal.
std::array<std::atomic<int>, kHostSignals.size()> calls{};
/// Whose signal it is: a process that was forked from this one has the channels, too.
std::atomic<pid_t> host{0};
static_assert(std::atomic<GuardianChannel*>::is_always_lock_free);

std::mutex& mutex() {
  static std::mutex of_installing;
  return of_installing;
}

void tell(HostState state) {
  for (const auto& place : channels) {
    GuardianChannel* const channel = place.load(std::memory_order_acquire);
    if (channel != nullptr) channel->say_host_fails(state);
  }
}

// No lock, no allocation, and only calls that POSIX permits in a handler.
void handle(int signal, siginfo_t* info, void*) {
  for (std::size_t i = 0; i < kHostSignals.size(); ++i) {
    if (kHostSignals[i].signal != signal) continue;
    if (::getpid() == host.load(std::memory_order_relaxed)) tell(kHostSignals[i].state);
    // A handler that was put in front of this one may call it in its turn: once is enough.
    struct sigaction none {};
    none.sa_handler = SIG_DFL;
    const bool is_first = calls[i].fetch_add(1, std::memory_order_relaxed) == 0;
    (void)::sigaction(signal, is_first ? &before[i] : &none, nullptr);
  }
  // It is blocked here, and comes when this returns, with the same information: also where that
  // would not run into the fault again, as in abort().
  (void)::syscall(SYS_rt_tgsigqueueinfo, ::getpid(), ::syscall(SYS_gettid), signal, info);
}

}  // namespace

HostSignals::HostSignals(GuardianChannel& channel) : channel_(channel) {
  host = ::getpid();
  for (auto& place : channels) {
    GuardianChannel* none = nullptr;
    if (place.compare_exchange_strong(none, &channel)) {
      stay_in_front();
      return;
    }
  }
  throw BackendError("More than " + std::to_string(kMostChannels) +
                     " haptic devices are open at a time. Close some.");
}

HostSignals::~HostSignals() {
  for (auto& place : channels) {
    GuardianChannel* own = &channel_;
    if (place.compare_exchange_strong(own, nullptr)) return;
  }
}

void HostSignals::stay_in_front() noexcept {
  const std::lock_guard lock(mutex());
  for (std::size_t i = 0; i < kHostSignals.size(); ++i) {
    struct sigaction there {};
    if (::sigaction(kHostSignals[i].signal, nullptr, &there) != 0) continue;
    const bool is_there = (there.sa_flags & SA_SIGINFO) != 0 && there.sa_sigaction == &handle;
    // What a program ignores neither crashes nor ends it: a hangup under nohup.
    if (is_there || there.sa_handler == SIG_IGN) continue;
    before[i] = there;
    calls[i] = 0;
    struct sigaction ours {};
    ours.sa_sigaction = &handle;
    // On the stack that the thread has for it, where it has one: its own may have overflowed.
    ours.sa_flags = SA_SIGINFO | SA_ONSTACK;
    sigemptyset(&ours.sa_mask);
    (void)::sigaction(kHostSignals[i].signal, &ours, nullptr);
  }
}

}  // namespace palpate
