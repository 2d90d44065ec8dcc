// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSegments.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "base/error.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkPalpateImageFile.h"
#include "vtkStringArray.h"

namespace
{
using palpate::InputError;

std::optional<std::string> Find(
  const vtkPalpateImageHeader& header, std::size_t segment, const std::string& name)
{
  const auto found = header.Keys.find("Segment" + std::to_string(segment) + '_' + name);
  return found == header.Keys.end() ? std::nullopt : std::make_optional(found->second);
}

std::size_t CountSegments(const vtkPalpateImageHeader& header)
{
  std::size_t count = 0;
  const auto has = [&header](std::size_t segment)
  {
    const std::string start = "Segment" + std::to_string(segment) + '_';
    const auto found = header.Keys.lower_bound(start);
    return found != header.Keys.end() && found->first.compare(0, start.size(), start) == 0;
  };
  while (has(count))
  {
    ++count;
  }
  return count;
}

/// @param otherwise The value if the file has none.
int WholeNumber(const vtkPalpateImageHeader& header, std::size_t segment, const std::string& name,
  int otherwise, int least, int most)
{
  const auto text = Find(header, segment, name);
  if (!text)
  {
    return otherwise;
  }
  std::istringstream words(*text);
  int number = 0;
  if (!(words >> number) || !(words >> std::ws).eof() || number < least || number > most)
  {
    throw InputError("The file says '" + *text + "' for Segment" + std::to_string(segment) + '_' +
      name + ", where a whole number from " + std::to_string(least) + " to " +
      std::to_string(most) + " is due.");
  }
  return number;
}

std::string UniqueName(const std::string& name, std::set<std::string>& taken)
{
  std::string unique = name;
  for (int number = 2; !taken.insert(unique).second; ++number)
  {
    unique = name + " (" + std::to_string(number) + ')';
  }
  return unique;
}

std::array<double, 3> ColorOf(const vtkPalpateImageHeader& header, std::size_t segment)
{
  constexpr double grey = 0.5;
  std::array<double, 3> color = { grey, grey, grey };
  std::istringstream words(Find(header, segment, "Color").value_or(""));
  for (double& part : color)
  {
    if (double value; words >> value)
    {
      part = std::clamp(value, 0.0, 1.0);
    }
  }
  return color;
}
}

std::vector<vtkPalpateSegment> vtkPalpateFindSegments(const vtkPalpateImageHeader& header)
{
  std::vector<vtkPalpateSegment> segments(CountSegments(header));
  // Old files have no layers: each segment is one.
  const bool layer_each = header.Components == static_cast<int>(segments.size());
  std::set<std::string> names;
  std::set<int> values;
  std::map<std::pair<int, int>, std::string> places;
  for (std::size_t i = 0; i < segments.size(); ++i)
  {
    vtkPalpateSegment& segment = segments[i];
    const int number = static_cast<int>(i);
    const bool has_layer = Find(header, i, "Layer").has_value();
    segment.Layer =
      WholeNumber(header, i, "Layer", layer_each ? number : 0, 0, header.Components - 1);
    segment.Value = WholeNumber(header, i, "LabelValue", layer_each && !has_layer ? 1 : number + 1,
      1, std::numeric_limits<int>::max());
    const std::string name = Find(header, i, "Name").value_or("");
    segment.Name = UniqueName(name.empty() ? "Segment " + std::to_string(i + 1) : name, names);
    segment.Color = ColorOf(header, i);
    values.insert(segment.Value);
    const auto [place, is_new] =
      places.emplace(std::make_pair(segment.Layer, segment.Value), segment.Name);
    if (!is_new)
    {
      throw InputError("The segments '" + place->second + "' and '" + segment.Name +
        "' of the file have the same layer and the same value.");
    }
  }
  for (std::size_t i = 0; i < segments.size(); ++i)
  {
    segments[i].Label =
      values.size() == segments.size() ? segments[i].Value : static_cast<int>(i) + 1;
  }
  return segments;
}

vtkPalpateJoinedSegments vtkPalpateJoinSegments(const vtkPalpateImageFile& image,
  const std::vector<vtkPalpateSegment>& segments, const std::vector<char>& chosen)
{
  if (!image.Values.empty())
  {
    throw InputError("The file has segments, but its voxels are not whole numbers.");
  }
  const auto layers = static_cast<std::size_t>(image.Header.Components);
  constexpr int none = -1;
  std::vector<std::map<int, int>> segment_of(layers);
  for (std::size_t i = 0; i < segments.size(); ++i)
  {
    segment_of[static_cast<std::size_t>(segments[i].Layer)][segments[i].Value] =
      static_cast<int>(i);
  }
  vtkPalpateJoinedSegments joined;
  joined.Voxels.resize(segments.size());
  joined.Lost.resize(segments.size());
  joined.Labels.resize(image.Header.Count());
  // The last value of each layer and its segment, since neighbours are mostly alike.
  std::vector<std::pair<int, int>> last(layers, { 0, none });
  for (std::size_t voxel = 0; voxel < joined.Labels.size(); ++voxel)
  {
    int winner = none;
    bool unnamed = false;
    for (std::size_t layer = 0; layer < layers; ++layer)
    {
      const int value = image.Labels[voxel * layers + layer];
      if (value == 0)
      {
        continue;
      }
      auto& [before, segment] = last[layer];
      if (value != before)
      {
        const auto found = segment_of[layer].find(value);
        before = value;
        segment = found == segment_of[layer].end() ? none : found->second;
      }
      if (segment == none)
      {
        unnamed = true;
        continue;
      }
      ++joined.Voxels[static_cast<std::size_t>(segment)];
      if (!chosen[static_cast<std::size_t>(segment)])
      {
        continue;
      }
      if (winner != none)
      {
        ++joined.Lost[static_cast<std::size_t>(std::min(winner, segment))];
      }
      winner = std::max(winner, segment);
    }
    joined.Unnamed += unnamed ? 1 : 0;
    joined.Labels[voxel] = winner == none ? 0 : segments[static_cast<std::size_t>(winner)].Label;
  }
  return joined;
}

std::map<int, std::string> vtkPalpateNamesOfLabels(vtkFieldData* fields)
{
  auto* names = vtkStringArray::SafeDownCast(fields->GetAbstractArray("Segment"));
  vtkDataArray* labels = fields->GetArray("SegmentLabel");
  std::map<int, std::string> names_of_labels;
  if (names && labels && names->GetNumberOfValues() == labels->GetNumberOfTuples())
  {
    for (vtkIdType i = 0; i < names->GetNumberOfValues(); ++i)
    {
      names_of_labels[static_cast<int>(labels->GetComponent(i, 0))] = names->GetValue(i);
    }
  }
  return names_of_labels;
}
