// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/device/host.h"

#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "haptic/device/check.h"

namespace palpate::test {

Host::~Host() {
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

void Host::signal(int signal, bool to_group) {
  check(kill(to_group ? -process_ : process_, signal) == 0, "kill");
}

void Host::restart() {
  wait();
  start();
}

int Host::wait() {
  int status = 0;
  check(waitpid(process_, &status, 0) == process_, "waitpid");
  process_ = -1;
  return status;
}

void Host::start() {
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // Not what the board has as hardware.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSCHEDULER);
  posix_spawnattr_setschedpolicy(&attributes, SCHED_OTHER);
  const sched_param priority{};
  posix_spawnattr_setschedparam(&attributes, &priority);
  char program[] = "/proc/self/exe";
  char* const arguments[] = {program, const_cast<char*>(kArgument), nullptr};
  errno = posix_spawn(&process_, program, nullptr, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  check(errno == 0, "posix_spawn");
}

}  // namespace palpate::test
