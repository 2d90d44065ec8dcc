// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/realtime/realtime_thread.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace palpate {
namespace {

constexpr const char* kHowToPermit =
    " Give the user 'rtprio 95' and 'memlock unlimited' in /etc/security/limits.conf, and log in "
    "again; or run without, where other work may delay the loop.";

/// The loop and the driver need less than this below the frame of the thread's function, bytes.
constexpr std::uintptr_t kStack = 256 << 10;

}  // namespace

SignalsBlocked::SignalsBlocked() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before_);
}

SignalsBlocked::~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

std::string take_realtime_priority(int priority, const std::string& what) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int failed = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (failed == 0) return {};
  return what + " has no real-time priority: " + std::strerror(failed) + "." + kHowToPermit;
}

MemoryRange own_stack() {
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return {};
  void* lowest = nullptr;
  std::size_t size = 0;
  pthread_attr_getstack(&attributes, &lowest, &size);
  pthread_attr_destroy(&attributes);
  const auto here = reinterpret_cast<std::uintptr_t>(&attributes);
  const auto begin = std::max(reinterpret_cast<std::uintptr_t>(lowest), here - kStack);
  const std::uintptr_t end = reinterpret_cast<std::uintptr_t>(lowest) + size;
  return {reinterpret_cast<const void*>(begin), end - begin};
}

}  // namespace palpate
