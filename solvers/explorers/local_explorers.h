// SPDX-License-Identifier: BSD-3-Clause
// Explorers on this machine: a process for each core that is free for it, at low priority. They end
// with the program that has started them.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/clock.h"

namespace palpate {

class LocalExplorers {
 public:
  /// How far they step back behind other programs by default.
  static constexpr int kNiceness = 15;

  /// @param program The path of palpate-explore.
  /// @param number How many; 0 or less: one less than there are cores, but at least one.
  /// @param endpoint Where the hub listens.
  /// @param niceness From 0, that of this program, to 19.
  /// @throws BackendError the program cannot be started.
  LocalExplorers(const std::filesystem::path& program, int number,
                 const std::filesystem::path& keys, const std::string& endpoint,
                 int niceness = kNiceness);
  ~LocalExplorers();
  LocalExplorers(const LocalExplorers&) = delete;
  LocalExplorers& operator=(const LocalExplorers&) = delete;

  /// Starts those anew that have ended, each some times at most and not at once.
  /// @returns The number that run.
  int watch();

 private:
  struct Process {
    /// 0: it has ended.
    pid_t id = 0;
    int num_starts = 0;
    SteadyClock::time_point started{};
  };

  void start(Process& process);
  void stop_all();

  std::vector<std::string> arguments_;
  std::vector<Process> processes_;
};

}  // namespace palpate
