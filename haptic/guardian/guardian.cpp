// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/guardian/guardian.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <system_error>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/find_program.h"
#include "haptic/guardian/descriptors.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr const char* kName = "palpate-guardian";

std::string message(int error) { return std::generic_category().message(error); }

[[noreturn]] void fail(const std::string& what, int error) {
  throw BackendError("The guardian of the motors cannot be started: " + what + ": " +
                     message(error) + ".");
}

/// A file descriptor that is closed at the end, and in programs that this one starts.
class Descriptor {
 public:
  /// @param descriptor The descriptor, or −1 with errno where opening has failed.
  Descriptor(int descriptor, const char* what) : value_(descriptor) {
    if (value_ < 0) fail(what, errno);
    // The descriptor must not have a number that the guardian will use: one would overwrite
    // another.
    if (value_ > guardian_descriptors::kLast) return;
    const int other = ::fcntl(value_, F_DUPFD_CLOEXEC, guardian_descriptors::kLast + 1);
    const int error = errno;
    ::close(value_);
    if (other < 0) fail(what, error);
    value_ = other;
  }
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const { return value_; }
  [[nodiscard]] int release() { return std::exchange(value_, -1); }

 private:
  int value_;
};

/// The attributes and actions of posix_spawn(), freed at the end.
struct SpawnSettings {
  SpawnSettings() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
  }
  ~SpawnSettings() {
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
};

}  // namespace

Guardian::Guardian(const std::string& device, const Report& zero, Duration deadline) {
  const std::string program =
      find_program(kName, "PALPATE_GUARDIAN", "Put it there from Palpate's folder `bin`");
  const Descriptor memory(::memfd_create(kName, MFD_CLOEXEC | MFD_ALLOW_SEALING), "Shared memory");
  // With these seals neither process can take the memory away from the other.
  if (::ftruncate(memory.get(), sizeof(GuardianChannel)) != 0 ||
      ::fcntl(memory.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
    fail("Shared memory", errno);
  }
  void* const mapped =
      ::mmap(nullptr, sizeof(GuardianChannel), PROT_READ | PROT_WRITE, MAP_SHARED, memory.get(), 0);
  if (mapped == MAP_FAILED) fail("Shared memory", errno);
  channel_ = new (mapped) GuardianChannel(zero);
  // The loop must not wait for a page of this memory. Where locking is not permitted, the guardian
  // works all the same.
  (void)::mlock(mapped, sizeof(GuardianChannel));
  try {
    start(program, device, memory.get());
    wait_until_it_watches(device, deadline);
    host_signals_.emplace(*channel_);
  } catch (...) {
    release();
    throw;
  }
}

Guardian::~Guardian() {
  // Sends a word, and then closes the line. Without the word the guardian sets the motors to zero.
  constexpr char kWord = 0;
  if (channel_->resting()) (void)::send(line_, &kWord, sizeof kWord, MSG_NOSIGNAL);
  release();
}

void Guardian::start(const std::string& program, const std::string& device, int memory) {
  using namespace guardian_descriptors;
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail("A socket", errno);
  Descriptor ours(ends[0], "A socket");
  const Descriptor its(ends[1], "A socket");

  SpawnSettings settings;
  posix_spawn_file_actions_t* const actions = &settings.actions;
  posix_spawn_file_actions_adddup2(actions, its.get(), kLine);
  posix_spawn_file_actions_adddup2(actions, memory, kMemory);
  // The guardian must not hold a terminal or a pipe of this program open, and whatever a library
  // prints there must not go to a descriptor that the device might have.
  posix_spawn_file_actions_addopen(actions, STDERR_FILENO, "/dev/null", O_RDWR, 0);
  posix_spawn_file_actions_addclosefrom_np(actions, kLast + 1);
  posix_spawnattr_t* const attributes = &settings.attributes;
  posix_spawnattr_setflags(attributes,
                           POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  sigset_t all;
  sigfillset(&all);
  posix_spawnattr_setsigmask(attributes, &all);
  posix_spawnattr_setsigdefault(attributes, &all);

  char* const arguments[] = {const_cast<char*>(program.c_str()), const_cast<char*>(device.c_str()),
                             nullptr};
  const int error =
      ::posix_spawn(&process_, program.c_str(), actions, attributes, arguments, environ);
  if (error != 0) {
    process_ = -1;
    fail(program, error);
  }
  line_ = ours.release();
}

void Guardian::wait_until_it_watches(const std::string& device, Duration deadline) {
  MonotonicClock clock;
  for (const Time begin = clock.now(); !channel_->guarded(clock.now());) {
    int status = 0;
    if (ended(status)) {
      fail("It cannot use " + device,
           status >= 0 && WIFEXITED(status) ? WEXITSTATUS(status) : ECHILD);
    }
    if (clock.now() - begin > deadline) {
      fail("It does not get hold of " + device, ETIMEDOUT);
    }
    std::this_thread::sleep_for(1ms);
  }
}

bool Guardian::ended(int& status) {
  if (process_ < 0) return true;
  const pid_t result = ::waitpid(process_, &status, WNOHANG);
  if (result == 0 || (result < 0 && errno == EINTR)) return false;
  if (result < 0) status = -1;  // somebody else in this process has waited for it
  process_ = -1;
  return true;
}

void Guardian::host_lives() noexcept {
  channel_->host_beat(MonotonicClock().now(), ::gettid());
  HostSignals::stay_in_front();
}

void Guardian::release() noexcept {
  host_signals_.reset();
  if (line_ >= 0) ::close(line_);
  // The guardian ends by itself. One that hangs in the device's driver is not waited for; the
  // system reaps it when this process has ended.
  constexpr int kTries = 500;
  int status = 0;
  for (int i = 0; i < kTries && !ended(status); ++i) std::this_thread::sleep_for(1ms);
  ::munmap(channel_, sizeof(GuardianChannel));
}

std::string Guardian::problem() const {
  if (channel_->host() == HostState::crashed) {
    return "The motors stay off: this program has crashed. Start it anew.";
  }
  if (channel_->host() == HostState::ending) {
    return "The motors stay off: this program was asked to end, by Ctrl+C or another signal. If it "
           "is to go on, open the device again.";
  }
  if (channel_->guarded(MonotonicClock().now()) || channel_->device_is_gone()) return {};
  return "The motors stay off: their guardian, the program palpate-guardian, has ended or does not "
         "run. Open the device again.";
}

}  // namespace palpate
