// SPDX-License-Identifier: BSD-3-Clause
// Sets the motors of a device to zero when the program that commands them no longer does
// (haptic/guardian/guardian.h). That program starts it:
//
//   palpate-guardian <device>
//
// with its end of a socket and shared memory as guardian/descriptors.h says. The guardian ends when
// the device is unplugged, and when that program has ended: at once after a word over the socket,
// and without a word as soon as the device has taken zero. Its exit code is 0 or, where it cannot
// watch, the errno.
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "haptic/guardian/descriptors.h"
#include "haptic/guardian/host_watch.h"
#include "haptic/guardian/watch.h"

namespace palpate {
namespace {

/// The priority is above that of the servo loop, and within what haptic/README.md asks the system
/// for.
constexpr int kPriority = 90;

/// The shared memory; nullptr, with errno: there is none, or it has another version.
GuardianChannel* shared_memory() {
  struct stat status {};
  if (::fstat(guardian_descriptors::kMemory, &status) != 0) return nullptr;
  if (status.st_size != sizeof(GuardianChannel)) {
    errno = EPROTO;
    return nullptr;
  }
  void* const mapped = ::mmap(nullptr, sizeof(GuardianChannel), PROT_READ | PROT_WRITE, MAP_SHARED,
                              guardian_descriptors::kMemory, 0);
  if (mapped == MAP_FAILED) return nullptr;
  auto* const channel = static_cast<GuardianChannel*>(mapped);
  if (channel->version != GuardianChannel::kVersion) {
    errno = EPROTO;
    return nullptr;
  }
  return channel;
}

/// Takes real-time priority and locks the memory, as far as the system permits.
void be_realtime() {
  sched_param parameters{};
  parameters.sched_priority = kPriority;
  (void)::sched_setscheduler(0, SCHED_FIFO, &parameters);
  (void)::mlockall(MCL_CURRENT | MCL_FUTURE);
}

/// Waits for the host to say something, or to end.
Watch::Host wait_for_host(Duration duration) {
  pollfd line{guardian_descriptors::kLine, POLLIN, 0};
  const timespec timeout{0, static_cast<long>(duration.count())};
  if (::ppoll(&line, 1, &timeout, nullptr) <= 0) return Watch::Host::running;
  char word = 0;
  const ssize_t size = ::recv(line.fd, &word, sizeof word, 0);
  return size > 0 ? Watch::Host::finished : Watch::Host::dead;
}

enum class Written { whole, failed, device_is_gone };

Written write(int device, const Report& report) {
  const ssize_t size = ::write(device, report.data.data(), report.size);
  if (size == static_cast<ssize_t>(report.size)) return Written::whole;
  const bool is_gone = size < 0 && (errno == ENODEV || errno == ENXIO || errno == EPIPE);
  return is_gone ? Written::device_is_gone : Written::failed;
}

bool is_unplugged(int device) {
  pollfd state{device, 0, 0};
  return ::poll(&state, 1, 0) > 0 && (state.revents & (POLLERR | POLLHUP)) != 0;
}

void watch(GuardianChannel& channel, int device) {
  // This is a copy, because a fault in the host may overwrite the shared memory.
  const Report zero = channel.zero;
  MonotonicClock clock;
  Watch watch(channel);
  // The parent process is the program that has started this one.
  HostWatch host_watch(::getppid());
  Watch::Host host = Watch::Host::running;
  for (;;) {
    const Watch::Step step = watch.look(clock.now(), host);
    if (step.action == Watch::Step::Action::end) return;
    Written written = is_unplugged(device) ? Written::device_is_gone : Written::failed;
    if (step.action == Watch::Step::Action::zero) {
      written = write(device, zero);
      if (written == Written::whole) watch.zero_was_taken();
    }
    if (written == Written::device_is_gone) {
      channel.say_device_is_gone();
      return;
    }
    if (host == Watch::Host::dead)
      clock.sleep_until(clock.now() + step.wait);
    else
      host = wait_for_host(step.wait);
    if (host == Watch::Host::running && host_watch.hangs(clock.now(), channel)) {
      host = Watch::Host::hanging;
    }
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  palpate::GuardianChannel* const channel = argc == 2 ? palpate::shared_memory() : nullptr;
  if (channel == nullptr) {
    std::fprintf(stderr,
                 "palpate-guardian: Palpate starts this program when it opens a haptic "
                 "device, and both have to be of the same version.\n");
    return argc == 2 ? errno : EXIT_FAILURE;
  }
  const int device = ::open(argv[1], O_WRONLY | O_CLOEXEC);
  if (device < 0) return errno;
  (void)::chdir("/");
  palpate::be_realtime();
  palpate::watch(*channel, device);
}
