// SPDX-License-Identifier: BSD-3-Clause
#include "explorers/local_explorers.h"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/error.h"
#include "threads/usable_cores.h"

namespace palpate {
namespace {

/// One that ends as often as this is left alone, and one is not started anew before this time, s.
constexpr int kMostRestarts = 100;
constexpr double kBetweenStarts = 0.5;

}  // namespace

LocalExplorers::LocalExplorers(const std::filesystem::path& program, int number,
                               const std::filesystem::path& keys, const std::string& endpoint,
                               int niceness)
    : arguments_{program.string(),
                 "--keys",
                 keys.string(),
                 "--connect",
                 endpoint,
                 "--parent",
                 std::to_string(getpid()),
                 "--nice",
                 std::to_string(niceness)} {
  if (number <= 0) number = std::max(1, num_usable_cores() - 1);
  processes_.resize(static_cast<std::size_t>(number));
  try {
    for (Process& process : processes_) start(process);
  } catch (...) {
    stop_all();
    throw;
  }
}

LocalExplorers::~LocalExplorers() { stop_all(); }

void LocalExplorers::stop_all() {
  for (const Process& process : processes_) {
    if (process.id > 0) kill(process.id, SIGKILL);
  }
  for (Process& process : processes_) {
    if (process.id > 0) waitpid(std::exchange(process.id, 0), nullptr, 0);
  }
}

int LocalExplorers::watch() {
  int running = 0;
  for (Process& process : processes_) {
    if (process.id > 0 && waitpid(process.id, nullptr, WNOHANG) != 0) process.id = 0;
    const bool may_start =
        process.num_starts < kMostRestarts && seconds_since(process.started) > kBetweenStarts;
    if (process.id == 0 && may_start) start(process);
    running += process.id > 0 ? 1 : 0;
  }
  return running;
}

void LocalExplorers::start(Process& process) {
  std::vector<char*> arguments;
  for (std::string& argument : arguments_) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  ++process.num_starts;
  process.started = SteadyClock::now();
  const int error =
      posix_spawn(&process.id, arguments[0], nullptr, nullptr, arguments.data(), environ);
  if (error == 0) return;
  process.id = 0;
  throw BackendError("The explorer " + arguments_[0] +
                     " cannot be started: " + std::strerror(error) + '.');
}

}  // namespace palpate
