// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateProgress.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <sstream>
#include <utility>

#include "vtkAlgorithm.h"

namespace
{
/// The least time between two reports of progress, s, since ParaView handles its events each time.
constexpr double ProgressInterval = 0.1;

std::string ToText(const palpate::ProgressState& state, const std::string& things)
{
  std::ostringstream text;
  text << state.num_done << " of " << state.num_expected << ' ' << things;
  if (state.seconds_left >= 0)
  {
    const bool minutes = state.seconds_left >= 90;
    text << ", " << std::lround(minutes ? state.seconds_left / 60 : state.seconds_left)
         << (minutes ? " min" : " s") << " left";
  }
  return text.str();
}
}

std::function<bool()> vtkPalpateAbortRequested(vtkAlgorithm* filter, std::function<double()> share)
{
  using Clock = std::chrono::steady_clock;
  return [filter, share = std::move(share), last = Clock::time_point()]() mutable
  {
    const Clock::time_point now = Clock::now();
    if (std::chrono::duration<double>(now - last).count() >= ProgressInterval)
    {
      last = now;
      filter->UpdateProgress(share());
    }
    return filter->GetAbortExecute() != 0;
  };
}

palpate::Progress vtkPalpateProgress(vtkAlgorithm* filter, int rank, double logInterval,
  const std::string& what, const std::string& things)
{
  using Clock = std::chrono::steady_clock;
  return [=, last = Clock::time_point(), logged = 0.0](const palpate::ProgressState& state) mutable
  {
    const Clock::time_point now = Clock::now();
    if (std::chrono::duration<double>(now - last).count() >= ProgressInterval)
    {
      last = now;
      const std::string text = ToText(state, things);
      filter->SetProgressText(text.c_str());
      filter->UpdateProgress(std::min(1.0, state.share()));
      if (rank == 0 && logInterval > 0 && state.seconds - logged >= logInterval)
      {
        logged = state.seconds;
        std::cerr << what << ": " << text << std::endl;
      }
    }
    return filter->GetAbortExecute() == 0;
  };
}
