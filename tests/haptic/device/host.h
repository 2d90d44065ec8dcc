// SPDX-License-Identifier: BSD-3-Clause
// The program of the person at the board as a child of this one, which can kill, stop and start it.
#pragma once

#include <sys/types.h>

namespace palpate::test {

class Host {
 public:
  /// The argument that tells this program to be the host's.
  static constexpr const char* kArgument = "touch";

  Host() { start(); }
  /// Kills.
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  /// @param to_group As a terminal sends it.
  void signal(int signal, bool to_group = false);
  /// A new one, in the place of one that has ended.
  void restart();
  /// @return As waitpid() gives it.
  int wait();

 private:
  void start();

  pid_t process_ = -1;
};

}  // namespace palpate::test
