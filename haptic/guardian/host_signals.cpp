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

/// The largest number of devices that are open at a time.
constexpr std::size_t kMostChannels = 32;

// A signal handler gets no object, so that all it uses is in static storage.
std::array<std::atomic<GuardianChannel*>, kMostChannels> channels{};
/// The action that was there before, for each signal. It is written only while this handler is not
/// in front.
std::array<struct sigaction, kHostSignals.size()> before{};
/// The number of calls since the handler was put in front, for each signal.
std::array<std::atomic<int>, kHostSignals.size()> calls{};
/// The process that the channels belong to: a process that was forked from this one has them too,
/// and must not write to them.
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

// This takes no lock, allocates nothing, and makes only calls that POSIX permits in a handler.
void handle(int signal, siginfo_t* info, void*) {
  for (std::size_t i = 0; i < kHostSignals.size(); ++i) {
    if (kHostSignals[i].signal != signal) continue;
    if (::getpid() == host.load(std::memory_order_relaxed)) tell(kHostSignals[i].state);
    // Another handler, put in front of this one, may call this one again. The earlier action is
    // restored only the first time; from then on the action is the default one.
    struct sigaction none {};
    none.sa_handler = SIG_DFL;
    const bool is_first = calls[i].fetch_add(1, std::memory_order_relaxed) == 0;
    (void)::sigaction(signal, is_first ? &before[i] : &none, nullptr);
  }
  // The signal is blocked here and arrives when this returns, with the same information. It is sent
  // because the program need not run into the fault again by itself, as with abort().
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
    // A signal that the program ignores neither crashes nor ends it, such as a hangup under nohup.
    if (is_there || there.sa_handler == SIG_IGN) continue;
    before[i] = there;
    calls[i] = 0;
    struct sigaction ours {};
    ours.sa_sigaction = &handle;
    // The handler runs on the thread's alternate stack, where it has one: its own may have
    // overflowed.
    ours.sa_flags = SA_SIGINFO | SA_ONSTACK;
    sigemptyset(&ours.sa_mask);
    (void)::sigaction(kHostSignals[i].signal, &ours, nullptr);
  }
}

}  // namespace palpate
