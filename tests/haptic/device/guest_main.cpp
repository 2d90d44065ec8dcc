// SPDX-License-Identifier: BSD-3-Clause
// The only program of the virtual machine: as /init it makes the system ready, plays the board, and
// runs the program that touches with it beside; then it switches the machine off.
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "haptic/device/board.h"
#include "haptic/device/check.h"
#include "haptic/device/log.h"
#include "haptic/device/user.h"

namespace {

constexpr const char* kRecords = "/dev/ttyS1";

using palpate::test::check;

void make_ready() {
  check(mount("devtmpfs", "/dev", "devtmpfs", 0, nullptr) == 0, "/dev");
  check(mount("proc", "/proc", "proc", 0, nullptr) == 0, "/proc");
  check(mount("sysfs", "/sys", "sysfs", 0, nullptr) == 0, "/sys");
  for (const char* module : {"/hid.ko", "/hid-generic.ko", "/uhid.ko"}) {
    const int file = open(module, O_RDONLY | O_CLOEXEC);
    check(file >= 0 && syscall(SYS_finit_module, file, "", 0) == 0, module);
    close(file);
  }
  // As a user has it who was given the limits that the servo loop asks for.
  const rlimit none{RLIM_INFINITY, RLIM_INFINITY};
  check(setrlimit(RLIMIT_MEMLOCK, &none) == 0, "setrlimit");
}

/// Above the servo loop: a board does not wait for the host.
void be_hardware() {
  sched_param priority{};
  priority.sched_priority = 95;
  check(sched_setscheduler(0, SCHED_FIFO, &priority) == 0, "sched_setscheduler");
  check(mlockall(MCL_CURRENT | MCL_FUTURE) == 0, "mlockall");
}

void run() {
  make_ready();
  const pid_t user = fork();
  check(user >= 0, "fork");
  palpate::test::Log log(kRecords);
  if (user == 0) {
    palpate::test::touch_with_the_board(log);
    log.write();
    std::exit(0);
  }
  be_hardware();
  palpate::test::Board(log, user).run();
  // It was told to end.
  sleep(1);
  kill(user, SIGKILL);
  int status = 0;
  check(waitpid(user, &status, 0) == user, "waitpid");
  log.add("ended %d", status);
  log.write();
}

}  // namespace

int main() {
  try {
    run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "init: %s\n", error.what());
  }
  sync();
  reboot(RB_POWER_OFF);
}
