// SPDX-License-Identifier: BSD-3-Clause
// What a long run tells the user: the progress of the filter, and a line on the terminal now and
// then.
#pragma once

#include <functional>
#include <string>

#include "PalpateCommonModule.h"
#include "exploration/precompute.h"

class vtkAlgorithm;

/// Tells the filter's progress now and then, and answers whether its abort was asked for: ParaView
/// handles its events, an abort among them, when it hears of progress.
/// @param share Of the work that is done; it is asked when it is told.
PALPATECOMMON_EXPORT std::function<bool()> vtkPalpateAbortRequested(
  vtkAlgorithm* filter, std::function<double()> share);

/// Tells the filter's progress; answers false once its abort was asked for.
/// @param rank Rank 0 writes the lines. @param logInterval Between them, s; 0: none.
/// @param what Is run, and the things that it counts: 'Precompute State Space', 'configurations'.
PALPATECOMMON_EXPORT palpate::Progress vtkPalpateProgress(vtkAlgorithm* filter, int rank,
  double logInterval, const std::string& what, const std::string& things);
