// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpatePartsReport.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace
{
/// The largest difference of volumes that is not reported, as a share of a part's volume.
constexpr double VolumeTolerance = 0.02;
}

std::string vtkPalpateNameOfLabel(int label, const std::map<int, std::string>& names)
{
  const auto found = names.find(label);
  return "Label " + std::to_string(label) +
    (found == names.end() ? "" : " (" + found->second + ')');
}

vtkPalpatePartsReport::vtkPalpatePartsReport(const vtkPalpateLabelParts& parts,
  const vtkPalpateCubes& cubes, const vtkPalpateLabelSurface& surface,
  const std::map<int, std::string>& names)
  : Parts(parts)
  , Cubes(cubes)
  , Surface(surface)
  , Names(names)
{
  for (std::size_t part = 1; part < parts.Each.size(); ++part)
  {
    ++NumberOf[parts.Each[part].Label];
  }
}

double vtkPalpatePartsReport::ImageVolume(std::size_t part) const
{
  return static_cast<double>(Parts.Each[part].Count) * Parts.Grid.Volume();
}

vtkPalpatePoint vtkPalpatePartsReport::Place(std::size_t part) const
{
  const auto& middle = Parts.Each[part].Middle;
  return Parts.Grid.Place(middle[0], middle[1], middle[2]);
}

std::string vtkPalpatePartsReport::Wrong() const
{
  std::vector<std::size_t> lost, off, apart;
  for (std::size_t part = 1; part < Parts.Each.size(); ++part)
  {
    const bool isLost = Cubes.Pieces[part] == 0;
    (isLost ? lost : off).push_back(part);
    if (Cubes.Pieces[part] > 1)
    {
      apart.push_back(part);
    }
  }
  off.erase(std::remove_if(off.begin(), off.end(),
              [this](std::size_t part) { return std::abs(Error(part)) <= VolumeTolerance; }),
    off.end());
  std::string text =
    List("Lost, as they are too small for the elements or too near to others of their label:", lost,
      [](std::size_t) { return std::string(); });
  text += List("Volumes that are off:", off,
    [this](std::size_t part)
    {
      std::ostringstream error;
      error.precision(3);
      error << ", " << 100 * std::abs(Error(part)) << " % too "
            << (Error(part) > 0 ? "much" : "little");
      return error.str();
    });
  text += List("In several pieces:", apart,
    [this](std::size_t part) { return ", " + std::to_string(Cubes.Pieces[part]) + " pieces"; });
  std::vector<std::size_t> joined;
  std::map<std::size_t, std::size_t> other;
  for (const auto& [a, b] : Cubes.Joined)
  {
    // The outside is no part.
    joined.push_back(static_cast<std::size_t>(b));
    other[joined.back()] = static_cast<std::size_t>(a);
  }
  text += List("Grown together with another one:", joined,
    [&](std::size_t part)
    { return other[part] == 0 ? " with the outside" : " with " + Name(other[part]); });
  return text;
}

std::string vtkPalpatePartsReport::Lines() const
{
  std::ostringstream text;
  text.precision(3);
  std::size_t lines = 0;
  for (std::size_t part = 1; part < Parts.Each.size(); ++part)
  {
    const int label = Parts.Each[part].Label;
    if ((label != 0 && NumberOf.at(label) == 1) || ++lines > MostLines)
    {
      continue;
    }
    text << Name(part) << ": ";
    if (Cubes.Pieces[part] == 0)
    {
      text << "lost.\n";
    }
    else
    {
      text << 100 * Error(part) << " % more or less in the body.\n";
    }
  }
  if (lines > MostLines)
  {
    text << "And " << lines - MostLines << " parts more.\n";
  }
  return text.str();
}

std::string vtkPalpatePartsReport::Name(std::size_t part) const
{
  const int label = Parts.Each[part].Label;
  std::ostringstream name;
  name.precision(3);
  name << (label == 0 ? "A cavity" : vtkPalpateNameOfLabel(label, Names));
  name << (label == 0 || NumberOf.at(label) == 1 ? " of " : ", the part of ");
  const auto x = Place(part);
  name << ImageVolume(part) << " m³ around (" << x[0] << ", " << x[1] << ", " << x[2] << ") m";
  return name.str();
}

std::string vtkPalpatePartsReport::List(const char* title, std::vector<std::size_t> parts,
  const std::function<std::string(std::size_t)>& tell) const
{
  if (parts.empty())
  {
    return "";
  }
  std::stable_sort(parts.begin(), parts.end(),
    [this](std::size_t a, std::size_t b) { return Parts.Each[a].Count > Parts.Each[b].Count; });
  std::ostringstream text;
  text.precision(3);
  text << ' ' << title;
  double rest = 0;
  for (std::size_t i = 0; i < parts.size(); ++i)
  {
    if (i < MostNamed)
    {
      text << (i > 0 ? "; " : " ") << Name(parts[i]) << tell(parts[i]);
    }
    else
    {
      rest += ImageVolume(parts[i]);
    }
  }
  if (rest > 0)
  {
    text << "; and " << parts.size() - MostNamed << " smaller ones, together " << rest << " m³";
  }
  text << '.';
  return text.str();
}
