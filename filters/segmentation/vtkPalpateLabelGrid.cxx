// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateLabelGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "base/error.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkPalpateArrayCheck.h"
#include "vtkPointData.h"

namespace
{
using palpate::InputError;

/// An image with more is not one of labels.
constexpr std::size_t MostLabels = 1000;

vtkDataArray* FindArray(vtkImageData* image, const std::string& name, bool& ofPoints)
{
  for (const bool points : { true, false })
  {
    vtkDataSetAttributes* data = image->GetPointData();
    if (!points)
    {
      data = image->GetCellData();
    }
    vtkDataArray* array = name.empty() ? data->GetScalars() : data->GetArray(name.c_str());
    if (array)
    {
      ofPoints = points;
      return array;
    }
  }
  if (name.empty())
  {
    throw InputError("The image has no scalars. Choose the array of labels as LabelArray.");
  }
  throw InputError("The image has no array '" + name +
    "' of points or cells. Choose the array of "
    "labels as LabelArray.");
}

std::string ToText(const std::set<int>& labels)
{
  std::ostringstream text;
  std::size_t count = 0;
  constexpr std::size_t most = 20;
  for (const int label : labels)
  {
    if (++count > most)
    {
      text << ", …";
      break;
    }
    text << (count > 1 ? ", " : "") << label;
  }
  return text.str();
}

int ToLabel(double value, vtkIdType voxel, vtkDataArray* array)
{
  const double whole = std::round(value);
  const bool fits = whole >= std::numeric_limits<int>::min() &&
    whole <= std::numeric_limits<int>::max() && std::abs(value - whole) <= vtkPalpateLabelTolerance;
  if (!fits)
  {
    std::ostringstream text;
    text << "The array " << vtkPalpateNameOf(array) << " is not one of labels: voxel " << voxel
         << " has the value " << value << ". Labels are whole numbers to within "
         << vtkPalpateLabelTolerance
         << ", of 32 bits; make them of grey values or probabilities with Threshold or Calculator.";
    throw InputError(text.str());
  }
  return static_cast<int>(whole);
}
}

vtkPalpatePoint vtkPalpateLabelGrid::Place(double i, double j, double k) const
{
  vtkPalpatePoint place;
  for (int c = 0; c < 3; ++c)
  {
    place[c] = Origin[c] + i * Axes[0][c] + j * Axes[1][c] + k * Axes[2][c];
  }
  return place;
}

std::array<double, 3> vtkPalpateLabelGrid::VoxelsOf(const vtkPalpatePoint& place) const
{
  std::array<double, 3> voxels{};
  vtkPalpatePoint away;
  vtkMath::Subtract(place.data(), Origin.data(), away.data());
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto& edge = Axes[axis];
    voxels[axis] = vtkMath::Dot(away.data(), edge.data()) / vtkMath::Dot(edge.data(), edge.data());
  }
  return voxels;
}

double vtkPalpateLabelGrid::SignedVolume() const
{
  return vtkMath::Determinant3x3(Axes[0].data(), Axes[1].data(), Axes[2].data());
}

double vtkPalpateLabelGrid::Spacing(int axis) const
{
  return vtkMath::Norm(Axes[axis].data());
}

vtkPalpateLabelGrid vtkPalpateReadLabels(vtkImageData* image, const std::string& name,
  const std::vector<int>& wanted, double unit, std::map<int, std::size_t>* negative)
{
  bool ofPoints = true;
  vtkDataArray* array = FindArray(image, name, ofPoints);
  if (array->GetNumberOfComponents() != 1)
  {
    throw InputError("The array " + vtkPalpateNameOf(array) + " has " +
      std::to_string(array->GetNumberOfComponents()) +
      " components; labels are one number for each voxel.");
  }
  vtkPalpateLabelGrid grid;
  double number = 1;
  const int* extent = image->GetExtent();
  for (int axis = 0; axis < 3; ++axis)
  {
    grid.Size[axis] = extent[2 * axis + 1] - extent[2 * axis] + (ofPoints ? 1 : 0);
    number *= grid.Size[axis];
  }
  if (*std::min_element(grid.Size.begin(), grid.Size.end()) < 2)
  {
    std::ostringstream text;
    text << "The image has " << grid.Size[0] << " × " << grid.Size[1] << " × " << grid.Size[2]
         << " voxels, a single layer, which bounds no body. Read the whole stack of slices.";
    throw InputError(text.str());
  }
  if (number > vtkPalpateMostVoxels)
  {
    std::ostringstream text;
    text << "The image has " << number << " voxels, more than the " << vtkPalpateMostVoxels
         << " that are taken. Cut the organ out or take every second voxel with Extract Subset.";
    throw InputError(text.str());
  }
  const double shift = ofPoints ? 0 : 0.5;
  double first[3];
  image->TransformContinuousIndexToPhysicalPoint(
    extent[0] + shift, extent[2] + shift, extent[4] + shift, first);
  for (int axis = 0; axis < 3; ++axis)
  {
    double next[3];
    image->TransformContinuousIndexToPhysicalPoint(extent[0] + shift + (axis == 0),
      extent[2] + shift + (axis == 1), extent[4] + shift + (axis == 2), next);
    for (int c = 0; c < 3; ++c)
    {
      grid.Axes[axis][c] = unit * (next[c] - first[c]);
      grid.Origin[c] = unit * first[c];
    }
  }
  if (!(grid.Volume() > 0) || !std::isfinite(grid.Volume()))
  {
    throw InputError("The voxels of the image have no volume. Check its spacing and direction.");
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const int next = (axis + 1) % 3;
    // Headers have four digits and more; over a thousand voxels this is one.
    constexpr double tolerance = 1e-3;
    if (std::abs(vtkMath::Dot(grid.Axes[axis].data(), grid.Axes[next].data())) >
      tolerance * grid.Spacing(axis) * grid.Spacing(next))
    {
      throw InputError(
        "The axes of the image are not at right angles: its direction matrix shears. "
        "Resample the image in the program that made it.");
    }
  }

  const auto count = static_cast<vtkIdType>(number);
  vtkPalpateCheckArrays(image);
  grid.Labels.resize(static_cast<std::size_t>(count));
  const std::set<int> keep(wanted.begin(), wanted.end());
  std::set<int> there;
  int last = 0;
  for (vtkIdType voxel = 0; voxel < count; ++voxel)
  {
    const int label = ToLabel(array->GetComponent(voxel, 0), voxel, array);
    if (label != last)
    {
      last = label;
      there.insert(label);
      if (there.size() > MostLabels)
      {
        throw InputError("The array " + vtkPalpateNameOf(array) + " has more than " +
          std::to_string(MostLabels) +
          " different values: it is not one of labels. Make them of grey values with Threshold or "
          "Calculator.");
      }
    }
    const bool isTissue = keep.empty() ? label > 0 : keep.count(label) > 0;
    grid.Labels[voxel] = isTissue ? label : 0;
    if (keep.empty() && label < 0 && negative)
    {
      ++(*negative)[label];
    }
  }
  there.erase(0);
  for (const int label : keep)
  {
    if (label == 0)
    {
      throw InputError("Labels has 0, which is what is not part of the body. Leave it out.");
    }
    if (there.count(label) == 0)
    {
      throw InputError("Labels has " + std::to_string(label) +
        ", but no voxel has that value. The image has: " + ToText(there) + '.');
    }
  }
  if (keep.empty() && (there.empty() || *there.rbegin() < 0))
  {
    throw InputError("The array " + vtkPalpateNameOf(array) +
      " is 0 throughout, or less: there is no body. Choose the array of labels as LabelArray; a "
      "negative label is a tissue where Labels has it.");
  }
  return grid;
}

std::map<int, std::size_t> vtkPalpateCountLabels(const vtkPalpateLabelGrid& grid)
{
  std::map<int, std::size_t> counts;
  for (const int label : grid.Labels)
  {
    if (label != 0)
    {
      ++counts[label];
    }
  }
  return counts;
}

vtkPalpateLabelShares::vtkPalpateLabelShares(
  const vtkPalpateLabelGrid& grid, const std::array<double, 3>& box)
  : Grid(grid)
  , Box(box)
  , Samples()
{
  for (int axis = 0; axis < 3; ++axis)
  {
    constexpr int most = 6;
    Samples[axis] = std::clamp(static_cast<int>(std::ceil(2 * box[axis])), 2, most);
  }
}

void vtkPalpateLabelShares::MoveTo(const std::array<double, 3>& middle)
{
  Shares.clear();
  const int number = Samples[0] * Samples[1] * Samples[2];
  for (int sample = 0; sample < number; ++sample)
  {
    const std::array<int, 3> part = { sample % Samples[0], sample / Samples[0] % Samples[1],
      sample / (Samples[0] * Samples[1]) };
    std::array<int, 3> low{};
    std::array<double, 3> fraction{};
    for (int axis = 0; axis < 3; ++axis)
    {
      const double at = middle[axis] + ((part[axis] + 0.5) / Samples[axis] - 0.5) * Box[axis];
      low[axis] = static_cast<int>(std::floor(at));
      fraction[axis] = at - low[axis];
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      double weight = 1.0 / number;
      std::array<int, 3> voxel = low;
      for (int axis = 0; axis < 3; ++axis)
      {
        const int up = (corner >> axis) & 1;
        voxel[axis] += up;
        weight *= up ? fraction[axis] : 1 - fraction[axis];
      }
      if (weight <= 0)
      {
        continue;
      }
      const int label = Grid.At(voxel[0], voxel[1], voxel[2]);
      const auto found = std::find_if(Shares.begin(), Shares.end(),
        [label](const std::pair<int, double>& share) { return share.first == label; });
      if (found == Shares.end())
      {
        Shares.emplace_back(label, weight);
      }
      else
      {
        found->second += weight;
      }
    }
  }
}

double vtkPalpateLabelShares::Of(int label) const
{
  const auto found = std::find_if(Shares.begin(), Shares.end(),
    [label](const std::pair<int, double>& share) { return share.first == label; });
  return found == Shares.end() ? 0 : found->second;
}

int vtkPalpateLabelShares::Most() const
{
  return std::max_element(
    Shares.begin(), Shares.end(), [](const auto& a, const auto& b) { return a.second < b.second; })
    ->first;
}

std::vector<int> vtkPalpateLabelShares::InOrder() const
{
  std::vector<std::pair<int, double>> order = Shares;
  std::stable_sort(
    order.begin(), order.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<int> labels;
  for (const auto& [label, share] : order)
  {
    labels.push_back(label);
  }
  return labels;
}
