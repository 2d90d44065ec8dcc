// SPDX-License-Identifier: BSD-3-Clause
// One cause, one error message: a filter that fails empties its output and leaves a mark in it, a
// field array with the message. A filter of ours that meets the mark passes it on in silence, where
// it would otherwise complain that its input has no cells. A key in the information of the array,
// not its name, tells the mark from an array of the user. The key goes through stock filters and
// between processes, as the array does.
//
// A script sees a failure in the error code of the filter (vtkAlgorithm::GetErrorCode, the property
// ErrorCode), also a failure that the filter passes on.
#pragma once

#include <functional>
#include <string>

#include "PalpateCommonModule.h"

namespace palpate
{
class Communicator;
}
class vtkDataObject;
class vtkMultiProcessController;
class vtkObject;

/// Empties `output` and leaves the mark in it.
PALPATECOMMON_EXPORT void vtkPalpateMarkFailed(vtkDataObject* output, const char* message);

/// The message of the mark that the data has; empty if it has none.
[[nodiscard]] PALPATECOMMON_EXPORT std::string vtkPalpateFailureOf(vtkDataObject* data);

/// If `input` has the mark: empties `output`, passes the mark on and returns true.
PALPATECOMMON_EXPORT bool vtkPalpatePassFailure(vtkDataObject* input, vtkDataObject* output);

/// The frame of RequestData: calls `body()`. An exception becomes the mark in `output` and one
/// error message of `self` (null: no message). The message is that of rank 0, or if rank 0 has
/// none, those of the ranks that have one. If one rank fails, the output of every rank has the
/// mark.
/// @param controller The ranks; null: one.
/// @returns The error code, the same on every rank, for vtkAlgorithm::ErrorCode. (SetErrorCode
///   would modify the filter, so that it runs again at the next render.) RequestData itself returns
///   1, for the reason given at vtkPalpateGuard.
/// @note Collective, so `body` must come to its end on every rank.
[[nodiscard]] PALPATECOMMON_EXPORT unsigned long vtkPalpateProduce(vtkObject* self,
  vtkDataObject* output, vtkMultiProcessController* controller,
  const std::function<void()>& body) noexcept;

/// Does the same for a body with collective operations of the communicator. It may throw on one
/// rank between two of them, see palpate::agree().
[[nodiscard]] PALPATECOMMON_EXPORT unsigned long vtkPalpateProduce(vtkObject* self,
  vtkDataObject* output, vtkMultiProcessController* controller,
  const std::function<void(palpate::Communicator&)>& body) noexcept;
