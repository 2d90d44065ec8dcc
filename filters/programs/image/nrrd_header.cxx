// SPDX-License-Identifier: BSD-3-Clause
#include "image/nrrd_header.h"

#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>

std::optional<Vector> ToLps(int space)
{
  switch (space)
  {
    case nrrdSpaceLeftPosteriorSuperior:
    case nrrdSpaceLeftPosteriorSuperiorTime:
      return Vector{ 1, 1, 1 };
    case nrrdSpaceRightAnteriorSuperior:
    case nrrdSpaceRightAnteriorSuperiorTime:
      return Vector{ -1, -1, 1 };
    case nrrdSpaceLeftAnteriorSuperior:
    case nrrdSpaceLeftAnteriorSuperiorTime:
      return Vector{ 1, -1, 1 };
    default:
      return std::nullopt;
  }
}

NrrdHeader::NrrdHeader(const std::string& file)
{
  const std::unique_ptr<Nrrd, Nrrd* (*)(Nrrd*)> nrrd(nrrdNew(), nrrdNuke);
  const std::unique_ptr<NrrdIoState, NrrdIoState* (*)(NrrdIoState*)> state(
    nrrdIoStateNew(), nrrdIoStateNix);
  nrrdIoStateSet(state.get(), nrrdIoStateSkipData, 1);
  if (nrrdLoad(nrrd.get(), file.c_str(), state.get()) != 0)
  {
    std::free(biffGetDone(NRRD));
    throw std::runtime_error("its header is damaged");
  }
  Space = nrrd->space;
  IsDetached = state->detachedHeader || state->dataFNArr->len > 0 || state->dataFNFormat;
  IsRaw = state->encoding == nrrdEncodingRaw;
  Place = PlaceOf(*nrrd);
  for (const char* unit : nrrd->spaceUnits)
  {
    if (unit && *unit)
    {
      Unit = unit;
      break;
    }
  }
}

std::optional<Frame> NrrdHeader::PlaceOf(const Nrrd& nrrd)
{
  const Vector sign = ToLps(nrrd.space).value_or(Vector{ 1, 1, 1 });
  Frame place;
  std::size_t axes = 0;
  for (unsigned axis = 0; nrrd.spaceDim >= Dimension && axis < nrrd.dim; ++axis)
  {
    const double* direction = nrrd.axis[axis].spaceDirection;
    if (std::isfinite(direction[0]) && axes < Dimension)
    {
      for (int c = 0; c < Dimension; ++c)
      {
        place.Axes[axes][c] = sign[c] * direction[c];
      }
      ++axes;
    }
  }
  for (int c = 0; c < Dimension; ++c)
  {
    // An origin that is not told is not a number.
    const double origin = nrrd.spaceOrigin[c];
    place.Origin[c] = std::isfinite(origin) ? sign[c] * origin : 0;
  }
  return axes == Dimension ? std::make_optional(place) : std::nullopt;
}
