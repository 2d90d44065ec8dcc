// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateLabelParts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

namespace
{
using Voxel = std::array<int, 3>;

/// A part with a smaller share of a cube than this that vanishes is too small for the elements.
constexpr double LeastVolume = 0.05;
/// A piece that is separated from its part is left out if it has no more than this share of the
/// part's volume.
constexpr double Crumb = 0.02;

/// Half of the steps to neighbours: those that a sweep over the voxels has met before, those across
/// a face first.
constexpr int FaceSteps = 3;
constexpr Voxel StepsBack[] = { { -1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 }, { -1, -1, 0 },
  { 1, -1, 0 }, { -1, 0, -1 }, { 1, 0, -1 }, { 0, -1, -1 }, { 0, 1, -1 }, { -1, -1, -1 },
  { 1, -1, -1 }, { -1, 1, -1 }, { 1, 1, -1 } };
constexpr int AllSteps = std::size(StepsBack);

Voxel Moved(const Voxel& from, const Voxel& step, int sign = 1)
{
  return { from[0] + sign * step[0], from[1] + sign * step[1], from[2] + sign * step[2] };
}

bool IsInside(const vtkPalpateLabelGrid& grid, const Voxel& at)
{
  return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < grid.Size[0] && at[1] < grid.Size[1] &&
    at[2] < grid.Size[2];
}

std::size_t IndexOf(const vtkPalpateLabelGrid& grid, const Voxel& at)
{
  return grid.Index(at[0], at[1], at[2]);
}

/// Calls `use(at)` for each voxel, in their order.
template <class Use>
void ForEachVoxel(const vtkPalpateLabelGrid& grid, Use&& use)
{
  for (int k = 0; k < grid.Size[2]; ++k)
  {
    for (int j = 0; j < grid.Size[1]; ++j)
    {
      for (int i = 0; i < grid.Size[0]; ++i)
      {
        use(Voxel{ i, j, k });
      }
    }
  }
}

/// Sets of numbers that grow together.
class DisjointSets
{
public:
  int Add()
  {
    Parent.push_back(static_cast<int>(Parent.size()));
    return Parent.back();
  }

  int Find(int of)
  {
    while (Parent[of] != of)
    {
      Parent[of] = Parent[Parent[of]];
      of = Parent[of];
    }
    return of;
  }

  /// Joins two sets; the smaller of their first numbers stands for them.
  int Join(int a, int b)
  {
    a = Find(a);
    b = Find(b);
    Parent[std::max(a, b)] = std::min(a, b);
    return std::min(a, b);
  }

  std::size_t Count() const { return Parent.size(); }

private:
  std::vector<int> Parent;
};

/// The components of voxels with one label that touch by the first `steps` of StepsBack, numbered
/// from 0 as the grid comes to them.
struct Components
{
  std::vector<int> Of;
  int Count = 0;

  Components(const vtkPalpateLabelGrid& grid, int steps)
  {
    Of.resize(grid.Labels.size());
    DisjointSets sets;
    ForEachVoxel(grid,
      [&](const Voxel& at)
      {
        const std::size_t here = IndexOf(grid, at);
        int set = -1;
        for (int s = 0; s < steps; ++s)
        {
          const Voxel to = Moved(at, StepsBack[s]);
          if (!IsInside(grid, to) || grid.Labels[IndexOf(grid, to)] != grid.Labels[here])
          {
            continue;
          }
          const int other = Of[IndexOf(grid, to)];
          set = set < 0 || set == other ? other : sets.Join(set, other);
        }
        Of[here] = set < 0 ? sets.Add() : set;
      });
    std::vector<int> number(sets.Count(), -1);
    for (int& set : Of)
    {
      int& known = number[sets.Find(set)];
      if (known < 0)
      {
        known = Count++;
      }
      set = known;
    }
  }
};

/// For each number in the grid, the number of its faces to each other number.
std::vector<std::map<int, std::size_t>> FacesBetween(
  const vtkPalpateLabelGrid& grid, std::size_t numbers)
{
  std::vector<std::map<int, std::size_t>> faces(numbers);
  ForEachVoxel(grid,
    [&](const Voxel& at)
    {
      const int here = grid.Labels[IndexOf(grid, at)];
      for (int s = 0; s < FaceSteps; ++s)
      {
        const Voxel to = Moved(at, StepsBack[s]);
        const int there = IsInside(grid, to) ? grid.Labels[IndexOf(grid, to)] : here;
        if (there != here)
        {
          ++faces[here][there];
          ++faces[there][here];
        }
      }
    });
  return faces;
}

/// The number that is touched most; 0 if nothing is touched.
int Most(const std::map<int, std::size_t>& touched)
{
  const auto most = std::max_element(touched.begin(), touched.end(),
    [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == touched.end() ? 0 : most->first;
}

/// The part that is touched most, among those of the label that is touched most.
/// @param touched The number of faces, by number of part.
int MostOfLabel(
  const std::map<int, std::size_t>& touched, const std::vector<vtkPalpateLabelPart>& parts)
{
  std::map<int, std::size_t> ofLabel;
  for (const auto& [part, faces] : touched)
  {
    ofLabel[parts[part].Label] += faces;
  }
  const int label = Most(ofLabel);
  std::map<int, std::size_t> those;
  for (const auto& [part, faces] : touched)
  {
    if (parts[part].Label == label)
    {
      those[part] = faces;
    }
  }
  return Most(those);
}

/// Gives the parts that are `unwanted` to the labels that they touch most. @returns how many of
/// each label.
template <class Predicate>
std::map<int, int> GiveAway(vtkPalpateLabelGrid& grid, Predicate&& unwanted)
{
  std::map<int, int> given;
  const vtkPalpateLabelParts parts = vtkPalpateFindParts(grid);
  std::vector<char> goes(parts.Each.size(), 0);
  for (std::size_t part = 1; part < goes.size(); ++part)
  {
    if (unwanted(parts.Each[part]))
    {
      goes[part] = 1;
      ++given[parts.Each[part].Label];
    }
  }
  for (std::size_t voxel = 0; voxel < grid.Labels.size(); ++voxel)
  {
    const int part = parts.Grid.Labels[voxel];
    if (goes[part] != 0)
    {
      grid.Labels[voxel] = parts.Each[parts.Each[part].Around].Label;
    }
  }
  return given;
}

/// Makes cubes of parts; see vtkPalpateResampleParts.
class Resampler
{
public:
  Resampler(const vtkPalpateLabelParts& parts, double edge)
    : Parts(parts)
    , Image(parts.Grid)
    , Shares(parts.Grid, this->LayOut(edge))
    , Left(parts.Each.size(), 0)
  {
    this->Left[0] = static_cast<int>(this->Cubes.Labels.size());
  }

  vtkPalpateCubes Make()
  {
    ForEachVoxel(this->Cubes,
      [&](const Voxel& at)
      {
        this->LookAt(at);
        this->Set(at, this->Shares.Most());
      });
    this->OpenGaps();
    this->KeepTheVanished();
    this->LeaveCrumbsOut();
    vtkPalpateCubes cubes{ this->Cubes, std::vector<int>(this->Left.size(), 0), {} };
    const Components pieces(this->Cubes, AllSteps);
    std::vector<int> partOf(static_cast<std::size_t>(pieces.Count));
    for (std::size_t cube = 0; cube < this->Cubes.Labels.size(); ++cube)
    {
      partOf[static_cast<std::size_t>(pieces.Of[cube])] = this->Cubes.Labels[cube];
    }
    for (const int part : partOf)
    {
      ++cubes.Pieces[static_cast<std::size_t>(part)];
    }
    const auto joined = this->Conflicts();
    cubes.Joined.assign(joined.begin(), joined.end());
    return cubes;
  }

private:
  using Pair = std::array<int, 2>;

  /// Places the cubes. @returns the step from one to the next, in voxels.
  std::array<double, 3> LayOut(double edge)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Step[axis] = edge / this->Image.Spacing(axis);
      this->Cubes.Size[axis] =
        std::max(1, static_cast<int>(std::ceil(this->Image.Size[axis] / this->Step[axis] - 1e-9)));
      // The cubes stand over both ends of the image alike.
      this->First[axis] =
        0.5 * (this->Image.Size[axis] - 1 - (this->Cubes.Size[axis] - 1) * this->Step[axis]);
      for (int c = 0; c < 3; ++c)
      {
        this->Cubes.Axes[axis][c] = this->Step[axis] * this->Image.Axes[axis][c];
      }
    }
    this->Cubes.Origin = this->Image.Place(this->First[0], this->First[1], this->First[2]);
    this->Cubes.Labels.assign(
      static_cast<std::size_t>(this->Cubes.Size[0]) * this->Cubes.Size[1] * this->Cubes.Size[2], 0);
    return this->Step;
  }

  void LookAt(const Voxel& cube)
  {
    this->Shares.MoveTo({ this->First[0] + cube[0] * this->Step[0],
      this->First[1] + cube[1] * this->Step[1], this->First[2] + cube[2] * this->Step[2] });
  }

  int Get(const Voxel& cube) const { return this->Cubes.At(cube[0], cube[1], cube[2]); }

  void Set(const Voxel& cube, int part)
  {
    int& here = this->Cubes.Labels[IndexOf(this->Cubes, cube)];
    --this->Left[here];
    ++this->Left[part];
    here = part;
  }

  int LabelOf(int part) const { return part == 0 ? 0 : this->Parts.Each[part].Label; }

  /// Whether two parts must not touch so. In the image parts of one label touch by edges and
  /// corners at the most.
  bool AreInConflict(int a, int b, bool byFace) const
  {
    return a != b && this->LabelOf(a) == this->LabelOf(b) &&
      (byFace || this->Touching.count({ std::min(a, b), std::max(a, b) }) == 0);
  }

  /// Calls `use(to, there, by face)` for each of 26 neighbours, those outside included.
  template <class Use>
  static void ForEachNeighbour(const Voxel& at, Use&& use)
  {
    for (const int sign : { 1, -1 })
    {
      for (int s = 0; s < AllSteps; ++s)
      {
        use(Moved(at, StepsBack[s], sign), s < FaceSteps);
      }
    }
  }

  bool WouldConflict(const Voxel& at, int part) const
  {
    bool conflicts = false;
    ForEachNeighbour(at,
      [&](const Voxel& to, bool byFace)
      { conflicts = conflicts || this->AreInConflict(part, this->Get(to), byFace); });
    return conflicts;
  }

  std::set<Pair> Conflicts() const
  {
    std::set<Pair> pairs;
    ForEachVoxel(this->Cubes,
      [&](const Voxel& at)
      {
        const int here = this->Get(at);
        ForEachNeighbour(at,
          [&](const Voxel& to, bool byFace)
          {
            const int there = this->Get(to);
            if (this->AreInConflict(here, there, byFace))
            {
              pairs.insert({ std::min(here, there), std::max(here, there) });
            }
          });
      });
    return pairs;
  }

  /// Finds out which of these pairs touch in the image.
  void FindTouching(const std::set<Pair>& pairs)
  {
    ForEachVoxel(this->Image,
      [&](const Voxel& at)
      {
        const int here = this->Image.Labels[IndexOf(this->Image, at)];
        for (int s = FaceSteps; s < AllSteps; ++s)
        {
          const Voxel to = Moved(at, StepsBack[s]);
          const int there = this->Image.At(to[0], to[1], to[2]);
          const Pair pair = { std::min(here, there), std::max(here, there) };
          if (here != there && pairs.count(pair) > 0)
          {
            this->Touching.insert(pair);
          }
        }
      });
  }

  void OpenGaps()
  {
    const std::set<Pair> pairs = this->Conflicts();
    if (pairs.empty())
    {
      return;
    }
    this->FindTouching(pairs);
    ForEachVoxel(this->Cubes,
      [&](const Voxel& at)
      {
        ForEachNeighbour(at,
          [&](const Voxel& to, bool byFace)
          {
            const int here = this->Get(at);
            const int there = this->Get(to);
            if (this->AreInConflict(here, there, byFace))
            {
              this->OpenGap(at, to);
            }
          });
      });
  }

  /// One of two cubes goes to what is between their parts: the one of which its part has less,
  /// unless it is the last one.
  void OpenGap(const Voxel& a, const Voxel& b)
  {
    const double ofA = this->OwnShare(a);
    const double ofB = this->OwnShare(b);
    if (ofA <= ofB ? !this->GiveUp(a) : !this->GiveUp(b))
    {
      this->GiveUp(ofA <= ofB ? b : a);
    }
  }

  /// More than any share for a cube that cannot be given up.
  double OwnShare(const Voxel& cube)
  {
    constexpr double all = 2;
    if (!IsInside(this->Cubes, cube) || (this->Get(cube) != 0 && this->Left[this->Get(cube)] == 1))
    {
      return all;
    }
    this->LookAt(cube);
    return this->Shares.Of(this->Get(cube));
  }

  /// Gives a cube to another part. @returns Whether there is a part that it can have.
  bool GiveUp(const Voxel& cube)
  {
    if (!IsInside(this->Cubes, cube))
    {
      return false;
    }
    const int own = this->Get(cube);
    this->LookAt(cube);
    std::vector<int> others = this->Shares.InOrder();
    others.push_back(this->Parts.Each[own].Around);
    ForEachNeighbour(cube, [&](const Voxel& to, bool) { others.push_back(this->Get(to)); });
    const auto other = std::find_if(others.begin(), others.end(),
      [&](int part)
      { return this->LabelOf(part) != this->LabelOf(own) && !this->WouldConflict(cube, part); });
    if (other == others.end())
    {
      return false;
    }
    this->Set(cube, *other);
    return true;
  }

  /// Gives cubes to the parts that have vanished, unless they are too small, or nearer than a cube
  /// to another part of their label.
  void KeepTheVanished()
  {
    const double voxelsOfCube = this->Step[0] * this->Step[1] * this->Step[2];
    std::map<int, std::map<Voxel, std::size_t>> voxels; // of each cube, of a part that has vanished
    for (std::size_t part = 1; part < this->Left.size(); ++part)
    {
      if (this->Left[part] == 0 &&
        static_cast<double>(this->Parts.Each[part].Count) >= LeastVolume * voxelsOfCube)
      {
        voxels[static_cast<int>(part)];
      }
    }
    if (voxels.empty())
    {
      return;
    }
    ForEachVoxel(this->Image,
      [&](const Voxel& at)
      {
        const auto found = voxels.find(this->Image.Labels[IndexOf(this->Image, at)]);
        if (found != voxels.end())
        {
          Voxel cube{};
          for (int axis = 0; axis < 3; ++axis)
          {
            cube[axis] = std::clamp(
              static_cast<int>(std::lround((at[axis] - this->First[axis]) / this->Step[axis])), 0,
              this->Cubes.Size[axis] - 1);
          }
          ++found->second[cube];
        }
      });
    for (const auto& [part, cubes] : voxels)
    {
      this->Keep(part, cubes, static_cast<double>(this->Parts.Each[part].Count) / voxelsOfCube);
    }
  }

  /// @param cubes The number of its voxels in each cube.
  /// @param volume The volume of the part, in cubes.
  void Keep(int part, const std::map<Voxel, std::size_t>& cubes, double volume)
  {
    std::vector<std::pair<std::size_t, Voxel>> order;
    for (const auto& [cube, count] : cubes)
    {
      order.emplace_back(count, cube);
    }
    std::stable_sort(
      order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    // One that is about as large as a cube lies around a corner of some, where these have each as
    // much of it; a smaller one is put into one of them.
    const bool many = volume > 1;
    for (const auto& [count, cube] : order)
    {
      const bool enough = this->Left[part] > 0 && (!many || 2 * count < order.front().first);
      if (enough || 2 * count < order.front().first)
      {
        return;
      }
      const int before = this->Get(cube);
      if ((before == 0 || this->Left[before] > 1) && !this->WouldConflict(cube, part))
      {
        this->Set(cube, part);
      }
    }
  }

  void LeaveCrumbsOut()
  {
    const Components pieces(this->Cubes, AllSteps);
    std::vector<std::size_t> size(static_cast<std::size_t>(pieces.Count), 0);
    for (const int piece : pieces.Of)
    {
      ++size[static_cast<std::size_t>(piece)];
    }
    ForEachVoxel(this->Cubes,
      [&](const Voxel& at)
      {
        const int part = this->Get(at);
        const std::size_t own = size[static_cast<std::size_t>(pieces.Of[IndexOf(Cubes, at)])];
        if (part != 0 && static_cast<double>(own) <= Crumb * this->Left[part])
        {
          this->GiveUp(at);
        }
      });
  }

  const vtkPalpateLabelParts& Parts;
  const vtkPalpateLabelGrid& Image;
  vtkPalpateLabelGrid Cubes;
  std::array<double, 3> Step{};  ///< from a cube to the next, in voxels
  std::array<double, 3> First{}; ///< the middle of the first, in voxels
  vtkPalpateLabelShares Shares;
  std::vector<int> Left; ///< cubes of each part
  std::set<Pair> Touching;
};
}

vtkPalpateLabelParts vtkPalpateFindParts(vtkPalpateLabelGrid labels)
{
  vtkPalpateLabelParts parts;
  Components components(labels, FaceSteps);
  // Components that are neither part of the body nor enclosed by it reach the border of the image.
  std::vector<char> isOutside(static_cast<std::size_t>(components.Count), 0);
  ForEachVoxel(labels,
    [&](const Voxel& at)
    {
      bool atBorder = false;
      for (int axis = 0; axis < 3; ++axis)
      {
        atBorder = atBorder || at[axis] == 0 || at[axis] == labels.Size[axis] - 1;
      }
      const std::size_t here = IndexOf(labels, at);
      if (atBorder && labels.Labels[here] == 0)
      {
        isOutside[static_cast<std::size_t>(components.Of[here])] = 1;
      }
    });
  std::vector<int> number(isOutside.size(), 0);
  int next = 0;
  for (std::size_t component = 0; component < number.size(); ++component)
  {
    number[component] = isOutside[component] != 0 ? 0 : ++next;
  }
  parts.Each.resize(static_cast<std::size_t>(next) + 1);
  ForEachVoxel(labels,
    [&](const Voxel& at)
    {
      const std::size_t here = IndexOf(labels, at);
      int& of = components.Of[here];
      of = number[static_cast<std::size_t>(of)];
      vtkPalpateLabelPart& part = parts.Each[static_cast<std::size_t>(of)];
      part.Label = labels.Labels[here];
      part.Voxel = part.Count == 0 ? at : part.Voxel;
      // Welford's running mean and sum of squares.
      ++part.Count;
      for (int axis = 0; axis < 3; ++axis)
      {
        const double away = at[axis] - part.Middle[axis];
        part.Middle[axis] += away / static_cast<double>(part.Count);
        part.Edges[axis] += away * (at[axis] - part.Middle[axis]);
      }
    });
  labels.Labels = std::move(components.Of);
  parts.Grid = std::move(labels);
  const auto faces = FacesBetween(parts.Grid, parts.Each.size());
  for (std::size_t i = 0; i < parts.Each.size(); ++i)
  {
    vtkPalpateLabelPart& part = parts.Each[i];
    part.Around = MostOfLabel(faces[i], parts.Each);
    for (double& edge : part.Edges)
    {
      // A voxel has the variance of a box of edge 1.
      edge = std::sqrt(12 * edge / static_cast<double>(std::max<std::size_t>(part.Count, 1)) + 1);
    }
  }
  return parts;
}

std::map<int, int> vtkPalpateRemoveIslands(vtkPalpateLabelGrid& grid, double smallest)
{
  if (smallest <= 0)
  {
    return {};
  }
  const double volume = grid.Volume();
  return GiveAway(grid,
    [=](const vtkPalpateLabelPart& part)
    { return part.Label != 0 && static_cast<double>(part.Count) * volume < smallest; });
}

int vtkPalpateFillHoles(vtkPalpateLabelGrid& grid)
{
  return GiveAway(grid, [](const vtkPalpateLabelPart& part) { return part.Label == 0; })[0];
}

vtkPalpateCubes vtkPalpateResampleParts(const vtkPalpateLabelParts& parts, double edge)
{
  return edge > 0 ? Resampler(parts, edge).Make()
                  : vtkPalpateCubes{ parts.Grid, std::vector<int>(parts.Each.size(), 1), {} };
}
