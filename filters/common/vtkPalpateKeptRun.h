// SPDX-License-Identifier: BSD-3-Clause
// The run of a filter whose output is a motion. It is computed once and serves all time steps. A
// run that fails gives one error message, and the output of each time step has its mark.
#pragma once

#include <algorithm>
#include <exception>
#include <memory>
#include <string>
#include <utility>

#include "schedule/communicator.h"
#include "vtkDataObject.h"
#include "vtkPalpateFailure.h"
#include "vtkType.h"

template <class Run>
class vtkPalpateKeptRun
{
public:
  /// Computes the run anew if something has changed since the last one.
  /// @param output If the run has failed, the output has the mark of the failure afterwards.
  /// @param now The time at which the inputs or the filter were changed last.
  /// @param compute Computes a run. It may throw, and may leave the mark of an input in `output`.
  /// @returns The run; null if `compute` threw.
  /// @note Collective
  template <class Now, class Compute>
  const Run* Update(
    palpate::Communicator& communicator, vtkDataObject* output, Now&& now, Compute&& compute)
  {
    if (palpate::any(communicator, !this->IsThere || this->Time != now()))
    {
      this->IsThere = false;
      this->Last.reset();
      this->Failure.clear();
      try
      {
        palpate::agree(communicator, [&] { this->Last = compute(); });
        this->Failure = vtkPalpateFailureOf(output);
      }
      catch (const std::exception& error)
      {
        this->Keep(error.what(), now());
        throw;
      }
      this->Keep(std::move(this->Failure), now());
    }
    else if (palpate::any(communicator, !this->Failure.empty()))
    {
      vtkPalpateMarkFailed(output, this->Failure.c_str());
    }
    return this->Last.get();
  }

private:
  void Keep(std::string failure, vtkMTimeType now)
  {
    this->Failure = std::move(failure);
    this->Time = now;
    this->IsThere = true;
  }

  bool IsThere = false;
  std::unique_ptr<Run> Last;
  /// The message of a run that has failed; empty: it has not.
  std::string Failure;
  vtkMTimeType Time = 0;
};
