// SPDX-License-Identifier: BSD-3-Clause
// What a long filter will take, told before it runs: the text of its property Estimate.
//
// A filter has `UpdateEstimate()`, which makes the text of what the input has now and of the
// properties, and `GetEstimate()`. The window calls them for a filter that is a copy of the one in
// the panel, with what the panel shows and is not applied yet (pqPalpateEstimateWidget).
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "PalpateFiltersModule.h"
#include "assembly/scene.h"
#include "vtkPalpatePieces.h"

class vtkMultiProcessController;

/// The estimate that `make` gives on rank 0; what is wrong, where it throws: that is what Apply
/// would say too. Other ranks have no text.
/// @note Collective, so `make` must come to its end on every rank.
[[nodiscard]] PALPATEFILTERS_EXPORT std::string vtkPalpateEstimate(
  vtkMultiProcessController* controller, const std::function<std::string()>& make) noexcept;

/// What the text says where the input has not been made.
/// @throws palpate::InputError always.
[[noreturn]] PALPATEFILTERS_EXPORT void vtkPalpateNothingToEstimate();

/// The scene that a filter has as its input, on rank 0; none on the others.
/// @param own What this rank has of it; a piece may be null. @param bodyForce It is under, m/s².
/// @note Collective. @throws palpate::InputError on every rank: there is none yet, or as
/// vtkPalpateSceneFromGrid.
[[nodiscard]] PALPATEFILTERS_EXPORT std::optional<palpate::Scene> vtkPalpateSceneToEstimate(
  const vtkPalpatePieces& own, vtkMultiProcessController* controller,
  const palpate::Vec3& bodyForce = palpate::Vec3::Zero());

///@{ Two figures: "12 000", "90 s", "2.5 min", "85 MB".
PALPATEFILTERS_EXPORT std::string vtkPalpateTellNumber(double number);
PALPATEFILTERS_EXPORT std::string vtkPalpateTellSeconds(double seconds);
PALPATEFILTERS_EXPORT std::string vtkPalpateTellBytes(double bytes);
///@}

/// A body of so many tetrahedra, and what it takes to make it.
/// @param seconds, bytes Beside the tetrahedra, s and bytes.
[[nodiscard]] PALPATEFILTERS_EXPORT std::string vtkPalpateTellBody(
  double tetrahedra, bool quadratic, double seconds, double bytes);
