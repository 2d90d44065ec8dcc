// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateDroppedDirections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <set>
#include <sstream>
#include <vector>

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkInformation.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMetaReader.h"
#include "vtkPalpateImageFile.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

namespace
{
using Matrix = std::array<std::array<double, 3>, 3>;

/// Where an image lies: its first voxel, and the edges of its voxels.
struct Frame
{
  vtkPalpatePoint Origin{};
  std::array<vtkPalpatePoint, 3> Axes{};
};

void FindReaders(vtkAlgorithm* filter, std::set<vtkAlgorithm*>& seen)
{
  for (int port = 0; port < filter->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < filter->GetNumberOfInputConnections(port); ++i)
    {
      vtkAlgorithm* input = filter->GetInputAlgorithm(port, i);
      if (input && seen.insert(input).second)
      {
        FindReaders(input, seen);
      }
    }
  }
}

/// The file that a reader of images has read; empty if the filter is no such reader.
std::string FileOf(vtkAlgorithm* reader)
{
  // ParaView's readers of a series of files have one of VTK's within.
  if (auto* series = vtkMetaReader::SafeDownCast(reader))
  {
    reader = series->GetReader();
  }
  auto* image = vtkImageReader2::SafeDownCast(reader);
  if (!image)
  {
    return "";
  }
  if (const char* name = image->GetFileName())
  {
    return name;
  }
  vtkStringArray* names = image->GetFileNames();
  return names && names->GetNumberOfValues() > 0 ? names->GetValue(0) : "";
}

Frame FrameAsRead(vtkAlgorithm* reader)
{
  vtkInformation* information = reader->GetOutputInformation(0);
  std::array<double, 3> spacing = { 1, 1, 1 };
  Frame frame;
  if (information->Has(vtkDataObject::SPACING()))
  {
    information->Get(vtkDataObject::SPACING(), spacing.data());
  }
  if (information->Has(vtkDataObject::ORIGIN()))
  {
    information->Get(vtkDataObject::ORIGIN(), frame.Origin.data());
  }
  std::array<double, 9> directions = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  if (information->Has(vtkDataObject::DIRECTION()))
  {
    information->Get(vtkDataObject::DIRECTION(), directions.data());
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int c = 0; c < 3; ++c)
    {
      frame.Axes[axis][c] = spacing[axis] * directions[3 * c + axis];
    }
  }
  return frame;
}

/// The largest distance between the same voxels, at the corners of an image of that size.
double Distance(const Frame& a, const Frame& b, const std::array<int, 3>& size)
{
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner)
  {
    double sum = 0;
    for (int c = 0; c < 3; ++c)
    {
      double away = a.Origin[c] - b.Origin[c];
      for (int axis = 0; axis < 3; ++axis)
      {
        const int last = (corner >> axis) & 1 ? size[axis] - 1 : 0;
        away += last * (a.Axes[axis][c] - b.Axes[axis][c]);
      }
      sum += away * away;
    }
    largest = std::max(largest, std::sqrt(sum));
  }
  return largest;
}

/// The frame with x and y reversed: from LPS to RAS.
Frame InRas(Frame frame)
{
  for (int c = 0; c < 2; ++c)
  {
    frame.Origin[c] = -frame.Origin[c];
    for (auto& axis : frame.Axes)
    {
      axis[c] = -axis[c];
    }
  }
  return frame;
}

/// A text that says how a body made of what was read lies with respect to the file.
std::string TellMotion(const Frame& read, const Frame& file, double distance)
{
  Matrix turn{};
  for (int axis = 0; axis < 3; ++axis)
  {
    const double lengths =
      vtkMath::Norm(read.Axes[axis].data()) * vtkMath::Norm(file.Axes[axis].data());
    for (int i = 0; i < 3; ++i)
    {
      for (int j = 0; j < 3; ++j)
      {
        turn[i][j] += file.Axes[axis][i] * read.Axes[axis][j] / lengths;
      }
    }
  }
  const double determinant =
    vtkMath::Determinant3x3(turn[0].data(), turn[1].data(), turn[2].data());
  if (determinant < 0)
  {
    return "is the mirror image of what the file shows";
  }
  const double cosine = (turn[0][0] + turn[1][1] + turn[2][2] - 1) / 2;
  const double angle = vtkMath::DegreesFromRadians(std::acos(std::clamp(cosine, -1.0, 1.0)));
  std::ostringstream text;
  text.precision(3);
  constexpr double least = 0.1;
  if (angle > least)
  {
    text << "is turned by " << angle << "°, and ";
  }
  text << "lies up to " << distance << " units of the file beside its place";
  return text.str();
}

/// Whether the points of a contour lie on the edges between voxels of its image as if that had no
/// direction matrix.
bool IsUnturnedContour(vtkAlgorithm* filter)
{
  auto* contour = vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0));
  const bool has_input =
    filter->GetNumberOfInputPorts() > 0 && filter->GetNumberOfInputConnections(0) > 0;
  auto* image = has_input ? vtkImageData::SafeDownCast(filter->GetInputDataObject(0, 0)) : nullptr;
  if (!image || !contour || contour->GetNumberOfPoints() == 0 ||
    image->GetDirectionMatrix()->IsIdentity())
  {
    return false;
  }
  constexpr vtkIdType samples = 100;
  const vtkIdType step = std::max<vtkIdType>(1, contour->GetNumberOfPoints() / samples);
  for (vtkIdType point = 0; point < contour->GetNumberOfPoints(); point += step)
  {
    int whole = 0;
    for (int c = 0; c < 3; ++c)
    {
      const double voxel =
        (contour->GetPoint(point)[c] - image->GetOrigin()[c]) / image->GetSpacing()[c];
      constexpr double tolerance = 1e-3;
      whole += std::abs(voxel - std::round(voxel)) < tolerance ? 1 : 0;
    }
    if (whole < 2)
    {
      return false;
    }
  }
  return true;
}

/// Whether a reader keeps the directions, as some readers of later versions of VTK do.
bool HasDirections(vtkAlgorithm* reader)
{
  auto* image = vtkImageData::SafeDownCast(reader->GetOutputDataObject(0));
  return image && !image->GetDirectionMatrix()->IsIdentity();
}

std::string TellOf(const std::string& file, vtkAlgorithm* reader)
{
  vtkPalpateImageHeader header;
  try
  {
    header = vtkPalpateReadImageHeader(file);
  }
  catch (const std::exception& error)
  {
    if (HasDirections(reader))
    {
      return "";
    }
    return "It cannot be told whether ParaView's reader has left out directions of " + file +
      ", so that what was read is turned, moved or mirrored. " + error.what();
  }
  const std::string advice = " Read it with Segmentation Reader instead.";
  if (header.Components > 1)
  {
    return "The file " + file + " has " + std::to_string(header.Components) +
      " values for each voxel, such as layers of segments, which ParaView's reader does not tell "
      "apart." +
      advice;
  }
  const Frame read = FrameAsRead(reader);
  Frame lps;
  lps.Origin = header.Origin;
  lps.Axes = header.Axes;
  double shortest = VTK_DOUBLE_MAX;
  for (const auto& axis : header.Axes)
  {
    shortest = std::min(shortest, vtkMath::Norm(axis.data()));
  }
  const double distance = Distance(read, lps, header.Size);
  constexpr double tolerance = 0.01; // of a voxel
  if (std::min(distance, Distance(read, InRas(lps), header.Size)) <= tolerance * shortest)
  {
    return "";
  }
  return "ParaView's reader has left out directions that the header of " + file +
    " has: what was read " + TellMotion(read, lps, distance) + '.' + advice;
}
}

std::string vtkPalpateTellDroppedDirections(vtkAlgorithm* filter)
{
  std::set<vtkAlgorithm*> seen;
  FindReaders(filter, seen);
  std::set<std::string> told;
  for (vtkAlgorithm* before : seen)
  {
    const std::string file = FileOf(before);
    if (vtkPalpateIsImageFile(file))
    {
      told.insert(TellOf(file, before));
    }
    if (IsUnturnedContour(before))
    {
      told.insert("The contour of an oblique image is not turned as the image is: this version of "
                  "ParaView leaves that out. Make the body with Tetrahedralize Label Map instead.");
    }
  }
  std::string text;
  for (const auto& sentence : told)
  {
    text += (text.empty() || sentence.empty() ? "" : " ") + sentence;
  }
  return text;
}
