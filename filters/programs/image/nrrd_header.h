// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include <NrrdIO.h>

#include "image/frame.h"

/// The signs that lead from a space of NRRD to LPS; nothing for a space of unknown axes.
std::optional<Vector> ToLps(int space);

/// What NRRD says in its header and ITK does not tell, or tells otherwise: it turns what is in LAS
/// by 180° about z.
struct NrrdHeader
{
  std::string Unit;
  int Space = nrrdSpaceUnknown;
  bool IsDetached = false;    ///< the voxels are in other files
  bool IsRaw = false;         ///< they are neither compressed nor text
  std::optional<Frame> Place; ///< where the header has directions, in LPS if it can be

  explicit NrrdHeader(const std::string& file);

private:
  static std::optional<Frame> PlaceOf(const Nrrd& nrrd);
};
