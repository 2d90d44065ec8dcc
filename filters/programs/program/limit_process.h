// SPDX-License-Identifier: BSD-3-Clause
// The first step of the programs that a filter starts.
#pragma once

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

/// Makes sure that the program does not outlive the one that started it, leaves no core file, and
/// does not take memory that the rest of the machine needs.
inline void LimitProcess()
{
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core = { 0, 0 };
  setrlimit(RLIMIT_CORE, &no_core);
  constexpr double share = 0.8;
  const double memory =
    static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  rlimit inherited;
  getrlimit(RLIMIT_AS, &inherited);
  const auto most = std::min(static_cast<rlim_t>(share * memory), inherited.rlim_cur);
  const rlimit address_space = { most, most };
  setrlimit(RLIMIT_AS, &address_space);
}
