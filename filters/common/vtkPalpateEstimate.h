// SPDX-License-Identifier: BSD-3-Clause
// The expected cost of a long filter, before it runs: the text of its property Estimate.
//
// A filter has `UpdateEstimate()`, which makes the text from the present input and the properties,
// and `GetEstimate()`. The window calls both for a copy of the filter that has the properties as
// the panel shows them, before they are applied (pqPalpateEstimateWidget).
#pragma once

#include <functional>
#include <string>

#include "PalpateCommonModule.h"

class vtkMultiProcessController;

/// The estimate that `make` gives on rank 0. If `make` throws, the text is its message, as it would
/// be after Apply. Other ranks have no text.
/// @note Collective, so `make` must come to its end on every rank.
[[nodiscard]] PALPATECOMMON_EXPORT std::string vtkPalpateEstimate(
  vtkMultiProcessController* controller, const std::function<std::string()>& make) noexcept;

/// Throws the message for an input that has not been made yet. @throws palpate::InputError always.
[[noreturn]] PALPATECOMMON_EXPORT void vtkPalpateNothingToEstimate();

///@{
/// A figure with two digits: "12 000", "90 s", "2.5 min", "85 MB".
PALPATECOMMON_EXPORT std::string vtkPalpateTellNumber(double number);
PALPATECOMMON_EXPORT std::string vtkPalpateTellSeconds(double seconds);
PALPATECOMMON_EXPORT std::string vtkPalpateTellBytes(double bytes);
///@}

/// The text for a body of so many tetrahedra, and the cost of making it.
/// @param seconds, bytes The cost of the steps before the tetrahedra, s and bytes.
[[nodiscard]] PALPATECOMMON_EXPORT std::string vtkPalpateTellBody(
  double tetrahedra, bool quadratic, double seconds, double bytes);
