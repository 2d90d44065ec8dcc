// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/guardian/crash_signals.h"

#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <mutex>
#include <string>

#include "base/error.h"

namespace palpate {
namespace {

constexpr std::array kSignals = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL};

/// The number of devices that are open at a time, at the most.
constexpr std::size_t kMostChannels = 32;

// A handler has nobody to ask: what it uses is here.
std::array<std::atomic<GuardianChannel*>, kMostChannels> channels{};
/// What was there before, of each signal; written while the handler is not in front.
std::array<struct sigaction, kSignals.size()> before{};
/// How often the handler was called since it was put there, of each signal.
std::array<std::atomic<int>, kSignals.size()> calls{};
/// Whose crash it is: a process that was forked from this one has the channels, too.
std::atomic<pid_t> host{0};
static_assert(std::atomic<GuardianChannel*>::is_always_lock_free);

std::mutex& mutex() {
  static std::mutex of_installing;
  return of_installing;
}

// No lock, no allocation, and only calls that POSIX permits in a handler.
void handle(int signal, siginfo_t* info, void*) {
  const bool is_host = ::getpid() == host.load(std::memory_order_relaxed);
  for (const auto& place : channels) {
    GuardianChannel* const channel = place.load(std::memory_order_acquire);
    if (is_host && channel != nullptr) {
      channel->say_host_crashed();
    }
  }
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    if (kSignals[i] != signal) continue;
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

CrashSignals::CrashSignals(GuardianChannel& channel) : channel_(channel) {
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

CrashSignals::~CrashSignals() {
  for (auto& place : channels) {
    GuardianChannel* own = &channel_;
    if (place.compare_exchange_strong(own, nullptr)) return;
  }
}

void CrashSignals::stay_in_front() noexcept {
  const std::lock_guard lock(mutex());
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    struct sigaction there {};
    if (::sigaction(kSignals[i], nullptr, &there) != 0) continue;
    const bool is_there = (there.sa_flags & SA_SIGINFO) != 0 && there.sa_sigaction == &handle;
    // What a program ignores is no crash of it.
    if (is_there || there.sa_handler == SIG_IGN) continue;
    before[i] = there;
    calls[i] = 0;
    struct sigaction ours {};
    ours.sa_sigaction = &handle;
    // On the stack that the thread has for it, where it has one: its own may have overflowed.
    ours.sa_flags = SA_SIGINFO | SA_ONSTACK;
    sigemptyset(&ours.sa_mask);
    (void)::sigaction(kSignals[i], &ours, nullptr);
  }
}

}  // namespace palpate
