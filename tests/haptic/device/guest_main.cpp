// SPDX-License-Identifier: BSD-3-Clause
// The program of the virtual machine: as /init it makes the system ready, plays the board, and
// starts itself again as the host's program that touches with it; then it switches the machine off.
#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <utility>
#include <vector>

#include "haptic/device/board.h"
#include "haptic/device/check.h"
#include "haptic/device/host.h"
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

/// A board goes through a script, and its host's program leaves at the end of it.
void run(std::vector<palpate::test::Stroke> script) {
  palpate::test::Log log(kRecords);
  palpate::test::Host host;
  palpate::test::Board(log, host, std::move(script)).run();
  log.add("ended %d", host.wait());
  log.write();
}

/// From the kernel's command line.
int number_of_trials() {
  const char* number = std::getenv("trials");
  return number != nullptr ? std::atoi(number) : 0;
}

void be_the_machine() {
  make_ready();
  be_hardware();
  run(palpate::test::script());
  {
    palpate::test::Log log(kRecords);
    log.add("trials");
    log.write();
  }
  run(palpate::test::trials(number_of_trials()));
}

void be_the_host() {
  palpate::test::Log log(kRecords);
  palpate::test::touch_with_the_board(log);
  log.write();
}

}  // namespace

int main(int argc, char** argv) {
  const bool is_host = argc > 1 && std::strcmp(argv[1], palpate::test::Host::kArgument) == 0;
  try {
    if (is_host)
      be_the_host();
    else
      be_the_machine();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", is_host ? "host" : "init", error.what());
  }
  if (is_host) return 0;
  sync();
  reboot(RB_POWER_OFF);
}
