// SPDX-License-Identifier: BSD-3-Clause
#include "image/frame.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace
{
double Dot(const Vector& a, const Vector& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector Cross(const Vector& a, const Vector& b)
{
  return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}
}

std::string StringOf(const itk::MetaDataDictionary& dictionary, const std::string& key)
{
  std::string value;
  itk::ExposeMetaData(dictionary, key, value);
  return value;
}

Frame FrameOf(const itk::ImageIOBase& io)
{
  const int stored = static_cast<int>(std::min(io.GetNumberOfDimensions(), 3u));
  Frame frame;
  for (int axis = 0; axis < stored; ++axis)
  {
    const auto direction = io.GetDirection(axis);
    frame.Origin[axis] = io.GetOrigin(axis);
    for (int c = 0; c < stored; ++c)
    {
      frame.Axes[axis][c] = io.GetSpacing(axis) * direction[c];
    }
  }
  if (stored < Dimension)
  {
    // A single slice: as thick as its voxels are long.
    const Vector normal = Cross(frame.Axes[0], frame.Axes[1]);
    const double length = std::sqrt(Dot(normal, normal));
    for (int c = 0; c < Dimension; ++c)
    {
      frame.Axes[2][c] = normal[c] / std::sqrt(length);
    }
  }
  return frame;
}

std::optional<Frame> SformOf(const itk::MetaDataDictionary& dictionary)
{
  const auto code = [&dictionary](const char* name)
  { return std::atoi(StringOf(dictionary, name).c_str()); };
  if (code("sform_code") <= 0 || code("qform_code") > 0)
  {
    return std::nullopt;
  }
  Frame frame;
  for (int c = 0; c < Dimension; ++c)
  {
    std::istringstream row(StringOf(dictionary, "srow_" + std::string(1, "xyz"[c])));
    row >> frame.Axes[0][c] >> frame.Axes[1][c] >> frame.Axes[2][c];
  }
  return frame;
}

void RescaleOrigin(const itk::MetaDataDictionary& dictionary, Frame& frame)
{
  constexpr int metre = 1;
  constexpr int micrometre = 3;
  constexpr int bits_of_length = 7;
  const int unit = std::atoi(StringOf(dictionary, "xyzt_units").c_str()) & bits_of_length;
  const double scale = unit == metre ? 1e3 : unit == micrometre ? 1e-3 : 1;
  std::array<Vector, 2> stored{};
  for (int c = 0; c < Dimension; ++c)
  {
    const std::string axis(1, static_cast<char>('x' + c));
    const double sign = c < 2 ? -1 : 1;
    stored[0][c] = sign * std::atof(StringOf(dictionary, "qoffset_" + axis).c_str());
    std::istringstream row(StringOf(dictionary, "srow_" + axis));
    double value = 0;
    for (int i = 0; i <= Dimension; ++i)
    {
      row >> value;
    }
    stored[1][c] = sign * value;
  }
  const bool is_stored = std::any_of(stored.begin(), stored.end(),
    [&frame](const Vector& origin)
    {
      double largest = 0, difference = 0;
      for (int c = 0; c < Dimension; ++c)
      {
        largest = std::max(largest, std::abs(origin[c]));
        difference = std::max(difference, std::abs(origin[c] - frame.Origin[c]));
      }
      constexpr double rounding = 1e-4;
      return difference <= rounding * largest;
    });
  if (scale != 1 && is_stored)
  {
    for (double& x : frame.Origin)
    {
      x *= scale;
    }
  }
}

void CheckFrame(const Frame& frame)
{
  for (const auto& vector : { frame.Axes[0], frame.Axes[1], frame.Axes[2], frame.Origin })
  {
    if (!std::isfinite(Dot(vector, vector)))
    {
      throw std::runtime_error("its header places voxels at numbers that are not finite");
    }
  }
  for (const auto& axis : frame.Axes)
  {
    if (!(Dot(axis, axis) > 0))
    {
      throw std::runtime_error("its header has voxels without an extent: a spacing or a direction "
                               "is 0");
    }
  }
  // Headers have four digits and more; over a thousand voxels this is one.
  constexpr double tolerance = 1e-3;
  for (int a = 0; a < Dimension; ++a)
  {
    const Vector& u = frame.Axes[a];
    const Vector& v = frame.Axes[(a + 1) % Dimension];
    if (std::abs(Dot(u, v)) > tolerance * std::sqrt(Dot(u, u) * Dot(v, v)))
    {
      throw std::runtime_error("the axes of its voxels are not at right angles (a tilted gantry, a "
                               "shear). Resample it to axes at right angles in the program that "
                               "made it, and save it again");
    }
  }
}
