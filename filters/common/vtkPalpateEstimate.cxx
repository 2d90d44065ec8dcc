// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateEstimate.h"

#include <cmath>
#include <cstdio>
#include <exception>

#include "base/error.h"
#include "vtkMultiProcessController.h"

namespace
{
/// The points for each tetrahedron in TetGen's meshes of organs, for linear and quadratic ones.
constexpr double PointsOfLinear = 0.25;
constexpr double PointsOfQuadratic = 1.65;
/// The cost of a tetrahedron in palpate-tetgen and in the filter: bytes, and s on one core.
constexpr double BytesOfTetrahedron = 1200;
constexpr double SecondsOfTetrahedron = 1e-5;

/// A number with two figures.
double Round(double value)
{
  if (!(value > 0))
  {
    return 0;
  }
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return unit * std::round(value / unit);
}

std::string ToText(double value, const char* unit)
{
  char text[64];
  std::snprintf(text, sizeof text, "%.10g %s", Round(value), unit);
  return text;
}
}

std::string vtkPalpateEstimate(
  vtkMultiProcessController* controller, const std::function<std::string()>& make) noexcept
{
  std::string text;
  try
  {
    text = make();
  }
  catch (const std::exception& error)
  {
    text = error.what();
  }
  return !controller || controller->GetLocalProcessId() == 0 ? text : std::string();
}

void vtkPalpateNothingToEstimate()
{
  throw palpate::InputError("Apply the filter before this one: its output is empty.");
}

std::string vtkPalpateTellNumber(double number)
{
  const double rounded = Round(number);
  std::string text = std::to_string(std::llround(rounded));
  for (auto end = static_cast<std::ptrdiff_t>(text.size()) - 3; end > 0; end -= 3)
  {
    text.insert(static_cast<std::size_t>(end), "\u00a0"); // a space at which no line ends
  }
  return text;
}

std::string vtkPalpateTellSeconds(double seconds)
{
  constexpr double minute = 60;
  constexpr double hour = 60 * minute;
  constexpr double day = 24 * hour;
  if (seconds < 1)
  {
    return "1 s at most";
  }
  if (seconds < 2 * minute)
  {
    return ToText(seconds, "s");
  }
  if (seconds < 2 * hour)
  {
    return ToText(seconds / minute, "min");
  }
  return seconds < 2 * day ? ToText(seconds / hour, "h") : ToText(seconds / day, "days");
}

std::string vtkPalpateTellBytes(double bytes)
{
  constexpr double mega = 1e6;
  constexpr double giga = 1e9;
  if (bytes < mega)
  {
    return "1 MB at most";
  }
  return bytes < giga ? ToText(bytes / mega, "MB") : ToText(bytes / giga, "GB");
}

std::string vtkPalpateTellBody(double tetrahedra, bool quadratic, double seconds, double bytes)
{
  const double points = (quadratic ? PointsOfQuadratic : PointsOfLinear) * tetrahedra;
  return "About " + vtkPalpateTellNumber(tetrahedra) + " tetrahedra with " +
    vtkPalpateTellNumber(points) + " points, so up to " + vtkPalpateTellNumber(3 * points) +
    " unknowns. It takes " + vtkPalpateTellSeconds(seconds + SecondsOfTetrahedron * tetrahedra) +
    " and " + vtkPalpateTellBytes(bytes + BytesOfTetrahedron * tetrahedra) + " of memory.";
}
