// SPDX-License-Identifier: BSD-3-Clause
// What a long filter will take, told before it runs: the text of its property Estimate.
//
// A filter has `UpdateEstimate()`, which makes the text of what the input has now and of the
// properties, and `GetEstimate()`. The window calls them for a filter that is a copy of the one in
// the panel, with what the panel shows and is not applied yet (pqPalpateEstimateWidget).
#pragma once

#include <functional>
#include <string>

#include "PalpateCommonModule.h"

class vtkMultiProcessController;

/// The estimate that `make` gives on rank 0; what is wrong, where it throws: that is what Apply
/// would say too. Other ranks have no text.
/// @note Collective, so `make` must come to its end on every rank.
[[nodiscard]] PALPATECOMMON_EXPORT std::string vtkPalpateEstimate(
  vtkMultiProcessController* controller, const std::function<std::string()>& make) noexcept;

/// What the text says where the input has not been made.
/// @throws palpate::InputError always.
[[noreturn]] PALPATECOMMON_EXPORT void vtkPalpateNothingToEstimate();

///@{ Two figures: "12 000", "90 s", "2.5 min", "85 MB".
PALPATECOMMON_EXPORT std::string vtkPalpateTellNumber(double number);
PALPATECOMMON_EXPORT std::string vtkPalpateTellSeconds(double seconds);
PALPATECOMMON_EXPORT std::string vtkPalpateTellBytes(double bytes);
///@}

/// A body of so many tetrahedra, and what it takes to make it.
/// @param seconds, bytes Beside the tetrahedra, s and bytes.
[[nodiscard]] PALPATECOMMON_EXPORT std::string vtkPalpateTellBody(
  double tetrahedra, bool quadratic, double seconds, double bytes);
