// SPDX-License-Identifier: BSD-3-Clause
// One cause, one error message: a filter that fails empties its output and leaves a mark in it, the
// field array `Error` with the message. A filter of ours that meets the mark passes it on in
// silence, where it would else complain that it has no cells.
#pragma once

#include <exception>
#include <utility>

#include "PalpateFiltersModule.h"
#include "vtkPalpateGuard.h"

class vtkDataObject;

/// Empties `output` and leaves the mark in it.
PALPATEFILTERS_EXPORT void vtkPalpateMarkFailed(vtkDataObject* output, const char* message);

/// Where `input` bears the mark: empties `output`, passes the mark on and answers true.
PALPATEFILTERS_EXPORT bool vtkPalpatePassFailure(vtkDataObject* input, vtkDataObject* output);

/// The body of RequestData: calls `body()`; what it throws becomes one error message of `self` and
/// the mark in `output`. Where several ranks meet the same error, `self` is null on all but one.
/// @returns 1, for the reason given at vtkPalpateGuard.
template <class Body>
int vtkPalpateProduce(vtkObject* self, vtkDataObject* output, Body&& body) noexcept
{
  vtkPalpateGuard(self,
    [&]
    {
      try
      {
        std::forward<Body>(body)();
      }
      catch (const std::exception& error)
      {
        vtkPalpateMarkFailed(output, error.what());
        throw;
      }
    });
  return 1;
}
