// SPDX-License-Identifier: BSD-3-Clause
// The run of a filter whose first output is a motion, the body at the time that is asked for, and
// whose second one is a table of all steps. It is computed once and serves all time steps. A run
// that fails gives one error message, and the output of each time step has its mark.
#pragma once

#include <algorithm>
#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "schedule/communicator.h"
#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFrameTimes.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

/// @tparam Run What is kept. Its Body is null on ranks that show nothing.
template <class Run>
class vtkPalpateKeptRun
{
public:
  enum OutputPort
  {
    MotionPort,
    HistoryPort,
    NumberOfOutputs
  };

  static int FillOutputPortInformation(int port, vtkInformation* info)
  {
    info->Set(
      vtkDataObject::DATA_TYPE_NAME(), port == MotionPort ? "vtkUnstructuredGrid" : "vtkTable");
    return 1;
  }

  /// @param times The times of the frames, s.
  static int RequestInformation(
    const std::vector<double>& times, vtkInformationVector* outputVector)
  {
    vtkPalpateSetTimes(times, outputVector->GetInformationObject(MotionPort));
    // The table is that of the whole run at each of them.
    vtkPalpateSetTimes({}, outputVector->GetInformationObject(HistoryPort));
    return 1;
  }

  /// Computes the run anew if something has changed since the last one, and shows it.
  /// @param compute Makes a run of a communicator and the first output. It may throw, and may leave
  ///   the mark of an input in that output.
  /// @param show Fills both outputs with a run at a time.
  /// @returns The error code of the filter.
  /// @note Collective
  template <class Compute, class Show>
  [[nodiscard]] unsigned long RequestData(vtkAlgorithm* filter, vtkInformation* request,
    vtkInformationVector** inputVector, vtkInformationVector* outputVector, Compute&& compute,
    Show&& show)
  {
    auto* output = vtkUnstructuredGrid::GetData(outputVector, MotionPort);
    auto* history = vtkTable::GetData(outputVector, HistoryPort);
    const double time = vtkPalpateAskedTime(request, outputVector);
    const vtkMTimeType inputTime =
      vtkPalpateInputTime(inputVector, filter->GetNumberOfInputPorts());
    return vtkPalpateProduce(filter, output, vtkMultiProcessController::GetGlobalController(),
      [&](palpate::Communicator& communicator)
      {
        const auto now = [&] { return std::max(inputTime, filter->GetMTime()); };
        const auto computeAnew = [&]
        {
          // A request that has ended an earlier run is not meant for this one, and nobody else
          // resets it.
          filter->SetAbortExecute(0);
          return compute(communicator, output);
        };
        const Run* run = this->Update(communicator, output, now, computeAnew);
        if (run && run->Body)
        {
          show(*run, time, output, history);
        }
      });
  }

private:
  /// @param now The time at which the inputs or the filter were changed last.
  /// @returns The run; null if `compute` threw.
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
