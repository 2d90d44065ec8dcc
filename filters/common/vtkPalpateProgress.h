// SPDX-License-Identifier: BSD-3-Clause
// The progress that a long run reports to the user: that of the filter, and a line on the terminal
// now and then.
#pragma once

#include <functional>
#include <string>

#include "PalpateCommonModule.h"
#include "exploration/precompute.h"

class vtkAlgorithm;

/// A function that reports the filter's progress now and then, and returns whether an abort was
/// asked for. ParaView handles its events, an abort among them, when it receives progress.
/// @param share Gives the finished share of the work. It is called only when progress is reported.
PALPATECOMMON_EXPORT std::function<bool()> vtkPalpateAbortRequested(
  vtkAlgorithm* filter, std::function<double()> share);

/// A function that reports the filter's progress, and returns false once an abort was asked for.
/// @param rank Rank 0 writes the lines.
/// @param logInterval The time between two lines, s; 0: there are none.
/// @param what The name of the filter, and that of the things which it counts: 'Precompute State
///   Space', 'configurations'.
PALPATECOMMON_EXPORT palpate::Progress vtkPalpateProgress(vtkAlgorithm* filter, int rank,
  double logInterval, const std::string& what, const std::string& things);
