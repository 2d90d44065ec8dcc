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
#include "vtkPointData.h"

namespace
{
using palpate::InputError;

/// An image with more is not one of labels.
constexpr std::size_t MostLabels = 1000;

constexpr int Neighbours[6][3] = { { -1, 0, 0 }, { 1, 0, 0 }, { 0, -1, 0 }, { 0, 1, 0 },
  { 0, 0, -1 }, { 0, 0, 1 } };

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
  const bool fits = value >= std::numeric_limits<int>::min() &&
    value <= std::numeric_limits<int>::max() && value == std::floor(value);
  if (!fits)
  {
    std::ostringstream text;
    text << "The array '" << array->GetName() << "' is not one of labels: voxel " << voxel
         << " has the value " << value
         << ". Labels are whole numbers; make them of grey values or probabilities with Threshold "
            "or Calculator.";
    throw InputError(text.str());
  }
  return static_cast<int>(value);
}

/// The voxels of the connected part that one is in, and of how many faces it touches which label.
class Part
{
public:
  explicit Part(const vtkPalpateLabelGrid& grid)
    : Grid(grid)
    , Visited(grid.Labels.size(), 0)
  {
  }

  bool IsVisited(std::size_t voxel) const { return Visited[voxel] != 0; }

  void Fill(int i, int j, int k)
  {
    Voxels.clear();
    Touched.clear();
    ReachesBorder = false;
    Label = Grid.At(i, j, k);
    Visited[Grid.Index(i, j, k)] = 1;
    Voxels.push_back({ i, j, k });
    for (std::size_t next = 0; next < Voxels.size(); ++next)
    {
      const auto at = Voxels[next];
      for (const auto& step : Neighbours)
      {
        const std::array<int, 3> to = { at[0] + step[0], at[1] + step[1], at[2] + step[2] };
        const bool inside = to[0] >= 0 && to[1] >= 0 && to[2] >= 0 && to[0] < Grid.Size[0] &&
          to[1] < Grid.Size[1] && to[2] < Grid.Size[2];
        if (!inside)
        {
          ReachesBorder = true;
          continue;
        }
        const std::size_t index = Grid.Index(to[0], to[1], to[2]);
        if (Grid.Labels[index] != Label)
        {
          ++Touched[Grid.Labels[index]];
        }
        else if (Visited[index] == 0)
        {
          Visited[index] = 1;
          Voxels.push_back(to);
        }
      }
    }
  }

  /// That of most faces; what is outside the image counts as 0.
  int MostTouched() const
  {
    const auto most = std::max_element(Touched.begin(), Touched.end(),
      [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == Touched.end() ? 0 : most->first;
  }

  std::vector<std::array<int, 3>> Voxels;
  std::map<int, std::size_t> Touched;
  bool ReachesBorder = false;
  int Label = 0;

private:
  const vtkPalpateLabelGrid& Grid;
  std::vector<char> Visited;
};

/// Calls `use(part)` for each connected part.
template <class Use>
void ForEachPart(const vtkPalpateLabelGrid& grid, Use&& use)
{
  Part part(grid);
  for (int k = 0; k < grid.Size[2]; ++k)
  {
    for (int j = 0; j < grid.Size[1]; ++j)
    {
      for (int i = 0; i < grid.Size[0]; ++i)
      {
        if (!part.IsVisited(grid.Index(i, j, k)))
        {
          part.Fill(i, j, k);
          use(part);
        }
      }
    }
  }
}

/// Gives the parts that are `unwanted` to the labels that they touch most. @returns how many of
/// each label.
template <class Predicate>
std::map<int, int> GiveAway(vtkPalpateLabelGrid& grid, Predicate&& unwanted)
{
  std::map<int, int> given;
  const vtkPalpateLabelGrid before = grid;
  ForEachPart(before,
    [&](const Part& part)
    {
      if (unwanted(part))
      {
        ++given[part.Label];
        for (const auto& at : part.Voxels)
        {
          grid.Labels[grid.Index(at[0], at[1], at[2])] = part.MostTouched();
        }
      }
    });
  return given;
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

vtkPalpateLabelGrid vtkPalpateReadLabels(
  vtkImageData* image, const std::string& name, const std::vector<int>& wanted, double unit)
{
  bool ofPoints = true;
  vtkDataArray* array = FindArray(image, name, ofPoints);
  if (array->GetNumberOfComponents() != 1)
  {
    throw InputError("The array '" + std::string(array->GetName()) + "' has " +
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

  const auto count = static_cast<vtkIdType>(number);
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
        throw InputError("The array '" + std::string(array->GetName()) + "' has more than " +
          std::to_string(MostLabels) +
          " different values: it is not one of labels. Make them of grey values with Threshold or "
          "Calculator.");
      }
    }
    grid.Labels[voxel] = keep.empty() || keep.count(label) > 0 ? label : 0;
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
  if (there.empty())
  {
    throw InputError("The array '" + std::string(array->GetName()) +
      "' is 0 throughout: there is no body. Choose the array of labels as LabelArray.");
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

std::map<int, int> vtkPalpateRemoveIslands(vtkPalpateLabelGrid& grid, double smallest)
{
  if (smallest <= 0)
  {
    return {};
  }
  const double volume = grid.Volume();
  return GiveAway(grid,
    [=](const Part& part) { return part.Label != 0 && part.Voxels.size() * volume < smallest; });
}

int vtkPalpateFillHoles(vtkPalpateLabelGrid& grid)
{
  return GiveAway(grid, [](const Part& part) { return part.Label == 0 && !part.ReachesBorder; })[0];
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

vtkPalpateLabelGrid vtkPalpateResampleLabels(const vtkPalpateLabelGrid& grid, double edge)
{
  vtkPalpateLabelGrid cubes;
  std::array<double, 3> step{}; // from a cube to the next, in voxels
  std::array<double, 3> first{};
  for (int axis = 0; axis < 3; ++axis)
  {
    step[axis] = edge / grid.Spacing(axis);
    cubes.Size[axis] =
      std::max(1, static_cast<int>(std::ceil(grid.Size[axis] / step[axis] - 1e-9)));
    // The cubes stand over both ends of the image alike.
    first[axis] = 0.5 * (grid.Size[axis] - 1 - (cubes.Size[axis] - 1) * step[axis]);
    for (int c = 0; c < 3; ++c)
    {
      cubes.Axes[axis][c] = step[axis] * grid.Axes[axis][c];
    }
  }
  cubes.Origin = grid.Place(first[0], first[1], first[2]);
  cubes.Labels.assign(static_cast<std::size_t>(cubes.Size[0]) * cubes.Size[1] * cubes.Size[2], 0);
  vtkPalpateLabelShares shares(grid, step);
  for (int k = 0; k < cubes.Size[2]; ++k)
  {
    for (int j = 0; j < cubes.Size[1]; ++j)
    {
      for (int i = 0; i < cubes.Size[0]; ++i)
      {
        shares.MoveTo({ first[0] + i * step[0], first[1] + j * step[1], first[2] + k * step[2] });
        cubes.Labels[cubes.Index(i, j, k)] = shares.Most();
      }
    }
  }
  return cubes;
}

vtkPalpateLabelParts vtkPalpateFindParts(const vtkPalpateLabelGrid& grid)
{
  vtkPalpateLabelParts parts;
  parts.OfVoxel.assign(grid.Labels.size(), 0);
  parts.Label = { 0 };
  parts.Voxel = { { 0, 0, 0 } };
  parts.Count = { 0 };
  ForEachPart(grid,
    [&](const Part& part)
    {
      if (part.Label == 0)
      {
        return;
      }
      for (const auto& at : part.Voxels)
      {
        parts.OfVoxel[grid.Index(at[0], at[1], at[2])] = static_cast<int>(parts.Label.size());
      }
      parts.Label.push_back(part.Label);
      parts.Voxel.push_back(part.Voxels.front());
      parts.Count.push_back(part.Voxels.size());
    });
  return parts;
}
