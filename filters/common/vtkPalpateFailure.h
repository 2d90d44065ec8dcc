// SPDX-License-Identifier: BSD-3-Clause
// One cause, one error message: a filter that fails empties its output and leaves a mark in it, a
// field array with the message. A filter of ours that meets the mark passes it on in silence, where
// it would else complain that it has no cells.
//
// The mark is told from an array of the user by a key in the information of the array, not by its
// name. The key goes through stock filters and between processes, as the array does.
//
// A script sees a failure in the error code of the filter (vtkAlgorithm::GetErrorCode, the property
// ErrorCode), also where the failure is one that the filter passes on.
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

/// The message of the mark that the data bears; empty where it bears none.
[[nodiscard]] PALPATECOMMON_EXPORT std::string vtkPalpateFailureOf(vtkDataObject* data);

/// Where `input` bears the mark: empties `output`, passes the mark on and answers true.
PALPATECOMMON_EXPORT bool vtkPalpatePassFailure(vtkDataObject* input, vtkDataObject* output);

/// The body of RequestData: calls `body()`. What it throws becomes the mark in `output` and one
/// error message of `self` (null: none): of rank 0, or where that has none, of each rank that has
/// one. Where one rank fails, the output of every rank bears the mark.
/// @param controller The ranks; null: one.
/// @returns the error code, the same on every rank, for vtkAlgorithm::ErrorCode. (SetErrorCode
/// would modify the filter, so that it runs again at the next render.) RequestData itself answers
/// 1, for the reason given at vtkPalpateGuard.
/// @note Collective, so `body` must come to its end on every rank.
[[nodiscard]] PALPATECOMMON_EXPORT unsigned long vtkPalpateProduce(vtkObject* self,
  vtkDataObject* output, vtkMultiProcessController* controller,
  const std::function<void()>& body) noexcept;

/// The same for a body that has collective operations of the communicator in it: it may throw on
/// one rank between two of them, see palpate::agree().
[[nodiscard]] PALPATECOMMON_EXPORT unsigned long vtkPalpateProduce(vtkObject* self,
  vtkDataObject* output, vtkMultiProcessController* controller,
  const std::function<void(palpate::Communicator&)>& body) noexcept;
