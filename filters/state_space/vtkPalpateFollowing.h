// SPDX-License-Identifier: BSD-3-Clause
// State spaces that are explored around a hand in this process. Whoever explores one has its file
// alone; filters that show it take what was found from here.
#pragma once

#include <memory>
#include <string>

#include "PalpateStateSpaceModule.h"
#include "exploration/precompute_options.h"
#include "following/live_space.h"

/// What the exploration of a space needs.
struct vtkPalpateFollowing
{
  std::shared_ptr<const palpate::Scene> Scene;
  palpate::PrecomputeOptions Options;
};

/// Says that the space of a file is explored from now on. @param space Null: no longer.
PALPATESTATESPACE_EXPORT void vtkPalpateSetLiveSpace(
  const std::string& file, std::shared_ptr<palpate::LiveSpace> space);

/// The space that is explored in a file; null: it is not.
[[nodiscard]] PALPATESTATESPACE_EXPORT std::shared_ptr<palpate::LiveSpace> vtkPalpateFindLiveSpace(
  const std::string& file);
