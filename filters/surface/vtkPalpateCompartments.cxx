// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateCompartments.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "vtkMath.h"
#include "vtkPalpateSurfaceShells.h"

namespace
{
using Compartments = vtkPalpateCompartments;
using Copy = vtkPalpateWalls::Copy;
using Side = vtkPalpateSurface::Side;
using Triangle = std::array<vtkIdType, 3>;

/// The number of a side of a triangle of the walls.
vtkIdType Half(vtkIdType triangle, bool front)
{
  return 2 * triangle + (front ? 1 : 0);
}

class UnionFind
{
public:
  explicit UnionFind(std::size_t size)
    : Parent(size)
  {
    std::iota(Parent.begin(), Parent.end(), vtkIdType{ 0 });
  }
  vtkIdType Root(vtkIdType i)
  {
    while (Parent[i] != i)
    {
      i = Parent[i] = Parent[Parent[i]];
    }
    return i;
  }
  void Join(vtkIdType a, vtkIdType b)
  {
    a = Root(a);
    b = Root(b);
    Parent[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<vtkIdType> Parent;
};

/// The triangles around an edge, sorted by angle. The sense of rotation is that of the normal of a
/// triangle which goes from the lower end of the edge to the higher one.
class Fan
{
public:
  Fan(const vtkPalpateSurface& surface, std::vector<Side> sides)
    : Points(surface.Points)
    , Sides(std::move(sides))
  {
    for (const Side& side : Sides)
    {
      const Triangle& t = surface.Triangles[side.Triangle];
      Apexes[side.Triangle] = *std::find_if(
        t.begin(), t.end(), [&side](vtkIdType id) { return id != side.Low && id != side.High; });
    }
    const vtkIdType first = Apexes.at(Sides[0].Triangle);
    std::stable_sort(Sides.begin(), Sides.end(),
      [&](const Side& a, const Side& b)
      {
        const vtkIdType x = Apexes.at(a.Triangle);
        const vtkIdType y = Apexes.at(b.Triangle);
        const int sector_x = Sector(first, x);
        const int sector_y = Sector(first, y);
        return sector_x != sector_y ? sector_x < sector_y : Turn(x, y) > 0;
      });
  }

  const std::vector<Side>& InOrder() const { return Sides; }

private:
  /// 1 where one turns from the half plane of x by less than half a turn to that of y.
  int Turn(vtkIdType x, vtkIdType y) const
  {
    return -vtkPalpateOrient3D(Points[Sides[0].Low], Points[Sides[0].High], Points[x], Points[y]);
  }

  /// 0 along `first`, 1 up to half a turn, 2 opposite to it, 3 beyond.
  int Sector(vtkIdType first, vtkIdType x) const
  {
    const int turn = Turn(first, x);
    if (turn != 0)
    {
      return turn > 0 ? 1 : 3;
    }
    const auto& a = Points[Sides[0].Low];
    const auto& b = Points[Sides[0].High];
    const auto n = vtkPalpateNormal(a, b, Points[first]);
    const auto m = vtkPalpateNormal(a, b, Points[x]);
    return vtkMath::Dot(n.data(), m.data()) >= 0 ? 0 : 2;
  }

  const std::vector<vtkPalpatePoint>& Points;
  std::vector<Side> Sides;
  std::map<vtkIdType, vtkIdType> Apexes;
};

/// Calls `visit` with the sides of each edge.
template <class Visit>
void ForEachEdge(const std::vector<Side>& sides, Visit&& visit)
{
  for (auto first = sides.begin(); first != sides.end();)
  {
    const auto last = std::find_if(
      first, sides.end(), [&first](const Side& side) { return !side.SameEdge(*first); });
    visit(first, last);
    first = last;
  }
}

/// The boundary that each side of a triangle belongs to, numbered by its first side.
std::vector<int> FindBoundaries(const vtkPalpateSurface& surface, int& count)
{
  UnionFind halves(2 * surface.Triangles.size());
  ForEachEdge(vtkPalpateSides(surface),
    [&](auto first, auto last)
    {
      const auto join = [&](const Side& from, const Side& to)
      { halves.Join(Half(from.Triangle, from.Forward), Half(to.Triangle, !to.Forward)); };
      if (last - first <= 2)
      {
        join(*first, *(last - 1));
        join(*(last - 1), *first);
        return;
      }
      const Fan fan(surface, { first, last });
      const auto& order = fan.InOrder();
      for (std::size_t i = 0; i < order.size(); ++i)
      {
        join(order[i], order[(i + 1) % order.size()]);
      }
    });
  std::vector<int> boundary(2 * surface.Triangles.size());
  count = 0;
  for (std::size_t i = 0; i < boundary.size(); ++i)
  {
    const vtkIdType root = halves.Root(static_cast<vtkIdType>(i));
    boundary[i] = root == static_cast<vtkIdType>(i) ? count++ : boundary[root];
  }
  return boundary;
}

/// The volume of the tetrahedron of a triangle and the point to which all volumes refer, m³.
double VolumeOf(const vtkPalpateSurface& surface, vtkIdType triangle)
{
  const auto& origin = surface.Points[surface.Triangles[0][0]];
  const Triangle& t = surface.Triangles[triangle];
  const auto& a = surface.Points[t[0]];
  const auto normal = vtkPalpateNormal(a, surface.Points[t[1]], surface.Points[t[2]]);
  const double arm[3] = { a[0] - origin[0], a[1] - origin[1], a[2] - origin[2] };
  return vtkMath::Dot(normal.data(), arm) / 6;
}

double AreaOf(const vtkPalpateSurface& surface, vtkIdType triangle)
{
  const Triangle& t = surface.Triangles[triangle];
  const auto normal =
    vtkPalpateNormal(surface.Points[t[0]], surface.Points[t[1]], surface.Points[t[2]]);
  return vtkMath::Norm(normal.data()) / 2;
}

vtkPalpatePoint Centre(const vtkPalpateSurface& surface, vtkIdType triangle)
{
  const Triangle& t = surface.Triangles[triangle];
  vtkPalpatePoint centre;
  for (int i = 0; i < 3; ++i)
  {
    centre[i] = (surface.Points[t[0]][i] + surface.Points[t[1]][i] + surface.Points[t[2]][i]) / 3;
  }
  return centre;
}

/// Finds compartments, then what is in them.
class Finder
{
public:
  explicit Finder(const vtkPalpateWalls& walls)
    : Walls(walls.Surface)
    , Copies(walls.Copies)
  {
  }

  Compartments Find()
  {
    this->FindSides();
    this->FindFilled();
    this->FindRegions();
    this->FindHinges();
    return std::move(this->Result);
  }

private:
  vtkIdType Triangles() const { return static_cast<vtkIdType>(Walls.Triangles.size()); }

  /// The compartment that a copy's normal points away from.
  int Behind(const Copy& copy) const { return Result.Sides[copy.Triangle][copy.Forward ? 0 : 1]; }
  int InFront(const Copy& copy) const { return Result.Sides[copy.Triangle][copy.Forward ? 1 : 0]; }

  void FindSides()
  {
    int boundaries = 0;
    const std::vector<int> boundary = FindBoundaries(Walls, boundaries);
    std::vector<double> enclosed(boundaries, 0);
    for (vtkIdType t = 0; t < this->Triangles(); ++t)
    {
      enclosed[boundary[Half(t, false)]] += VolumeOf(Walls, t);
      enclosed[boundary[Half(t, true)]] -= VolumeOf(Walls, t);
    }

    // Compartments by the first side of their outer boundary.
    std::vector<int> compartment(boundaries, Compartments::Outside);
    Result.Volume.assign(1, 0);
    for (int i = 0; i < boundaries; ++i)
    {
      if (enclosed[i] > 0)
      {
        compartment[i] = Result.Count();
        Result.Volume.push_back(enclosed[i]);
      }
    }
    std::vector<std::vector<vtkIdType>> halves(Result.Count());
    for (std::size_t half = 0; half < boundary.size(); ++half)
    {
      if (const int i = compartment[boundary[half]])
      {
        halves[i].push_back(static_cast<vtkIdType>(half));
      }
    }
    Result.Boundary.resize(Result.Count());
    for (int i = 1; i < Result.Count(); ++i)
    {
      std::vector<vtkIdType> triangles;
      for (const vtkIdType half : halves[i])
      {
        triangles.push_back(half / 2);
      }
      auto& surface = Result.Boundary[i] = vtkPalpateSubset(Walls, triangles);
      for (std::size_t k = 0; k < triangles.size(); ++k)
      {
        if (halves[i][k] % 2 == 1)
        {
          std::swap(surface.Triangles[k][1], surface.Triangles[k][2]);
        }
      }
    }

    int parts = 0;
    PartOf = vtkPalpateConnectedParts(Walls, parts);
    FirstOfPart.assign(parts, -1);
    for (vtkIdType t = this->Triangles() - 1; t >= 0; --t)
    {
      FirstOfPart[PartOf[t]] = t;
    }
    Result.Part.assign(Result.Count(), -1);
    for (int i = 1; i < Result.Count(); ++i)
    {
      Result.Part[i] = PartOf[halves[i][0] / 2];
    }
    this->FindAround(parts);

    Result.Sides.resize(Walls.Triangles.size());
    std::vector<char> counted(boundaries, 0);
    for (vtkIdType t = 0; t < this->Triangles(); ++t)
    {
      for (const bool front : { false, true })
      {
        const int i = boundary[Half(t, front)];
        const int inside = compartment[i];
        const int around = Around[PartOf[t]];
        Result.Sides[t][front] = inside ? inside : around;
        if (!inside && around && !counted[i])
        {
          counted[i] = 1;
          Result.Volume[around] += enclosed[i];
        }
      }
    }
  }

  /// The compartment that each part of the walls lies in.
  void FindAround(int parts)
  {
    Around.assign(parts, Compartments::Outside);
    if (parts == 1)
    {
      return;
    }
    std::vector<std::array<double, 6>> bounds;
    for (const auto& surface : Result.Boundary)
    {
      bounds.push_back(vtkPalpateBounds(surface));
    }
    for (int part = 0; part < parts; ++part)
    {
      const auto probe = Centre(Walls, FirstOfPart[part]);
      double least = 0;
      for (int i = 1; i < Result.Count(); ++i)
      {
        const double volume = vtkPalpateVolume(Result.Boundary[i]);
        const bool smaller = Around[part] == Compartments::Outside || volume < least;
        // The level may be any one between 0 (outside) and 1 (inside).
        if (Result.Part[i] != part && smaller && vtkPalpateIsInside(bounds[i], probe) &&
          vtkPalpateWindingNumber(Result.Boundary[i], probe) > 0.5)
        {
          Around[part] = i;
          least = volume;
        }
      }
    }
  }

  /// Parts of the walls such that each comes after the one around it.
  std::vector<int> FromOutsideInwards() const
  {
    std::vector<int> depth(Around.size(), 0), order(Around.size());
    for (std::size_t part = 0; part < depth.size(); ++part)
    {
      for (int at = Around[part]; at; at = Around[Result.Part[at]])
      {
        ++depth[part];
      }
    }
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(
      order.begin(), order.end(), [&depth](int a, int b) { return depth[a] < depth[b]; });
    return order;
  }

  /// Whether the surface of each tissue has its normals outwards as a whole: 1 or −1; 0 for one
  /// that is open without the walls that others have.
  std::map<int, int> SensesOfTissues() const
  {
    std::map<int, std::vector<vtkIdType>> triangles;
    std::map<int, double> volume;
    for (const Copy& copy : Copies)
    {
      if (copy.Tissue >= 0)
      {
        triangles[copy.Tissue].push_back(copy.Triangle);
        volume[copy.Tissue] += (copy.Forward ? 1 : -1) * VolumeOf(Walls, copy.Triangle);
      }
    }
    std::map<int, int> senses;
    for (auto& [tissue, ids] : triangles)
    {
      ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
      bool closed = true;
      ForEachEdge(vtkPalpateSides(vtkPalpateSubset(Walls, ids)),
        [&closed](auto first, auto last) { closed = closed && last - first > 1; });
      senses[tissue] = !closed ? 0 : volume[tissue] > 0 ? 1 : -1;
    }
    return senses;
  }

  /// Finds the compartments that hold tissue, from the outside inwards.
  void FindFilled()
  {
    const auto of_tissue = this->SensesOfTissues();
    for (const auto& [tissue, sense] : of_tissue)
    {
      if (sense != 0)
      {
        Closed.insert(tissue);
      }
    }
    std::vector<std::vector<const Copy*>> copies(FirstOfPart.size());
    for (const Copy& copy : Copies)
    {
      copies[PartOf[copy.Triangle]].push_back(&copy);
    }
    std::vector<std::vector<int>> inside(FirstOfPart.size());
    for (int i = 1; i < Result.Count(); ++i)
    {
      inside[Result.Part[i]].push_back(i);
    }
    std::vector<int> sense_of_part(FirstOfPart.size(), 1);
    Outward.assign(Copies.size(), 0);
    Filled.assign(Result.Count(), 0);
    for (const int part : this->FromOutsideInwards())
    {
      const int around = Around[part];
      int& sense = sense_of_part[part];
      sense =
        Filled[around] ? sense_of_part[Result.Part[around]] : this->SenseOf(copies[part], around);
      std::set<int> pointed_out;
      for (const Copy* copy : copies[part])
      {
        const auto found = of_tissue.find(copy->Tissue);
        const int own = found != of_tissue.end() && found->second != 0 ? found->second : sense;
        Outward[copy - Copies.data()] = own > 0 ? 1 : -1;
        pointed_out.insert(own > 0 ? this->Behind(*copy) : this->InFront(*copy));
      }
      this->Fill(copies[part], around, inside[part], pointed_out);
    }
  }

  /// Whether most of what borders the compartment around a part has its normals towards it.
  int SenseOf(const std::vector<const Copy*>& copies, int around) const
  {
    double balance = 0;
    for (const Copy* copy : copies)
    {
      const double area = AreaOf(Walls, copy->Triangle);
      balance += this->InFront(*copy) == around ? area : 0;
      balance -= this->Behind(*copy) == around ? area : 0;
    }
    return balance >= 0 ? 1 : -1;
  }

  /// @param inside The compartments of one part. @param pointed_out Those that a normal points out
  /// of.
  void Fill(const std::vector<const Copy*>& copies, int around, std::vector<int> inside,
    const std::set<int>& pointed_out)
  {
    std::map<int, std::set<int>> neighbours;
    for (const Copy* copy : copies)
    {
      neighbours[this->Behind(*copy)].insert(this->InFront(*copy));
      neighbours[this->InFront(*copy)].insert(this->Behind(*copy));
    }
    std::stable_sort(inside.begin(), inside.end(),
      [this](int a, int b) { return Result.Volume[a] > Result.Volume[b]; });
    std::set<int> cavities;
    if (!Filled[around])
    {
      cavities.insert(around);
    }
    for (const int i : inside)
    {
      const auto& beside = neighbours[i];
      const bool by_cavity = std::any_of(
        beside.begin(), beside.end(), [&cavities](int other) { return cavities.count(other) > 0; });
      Filled[i] = by_cavity || pointed_out.count(i) > 0;
      if (!Filled[i])
      {
        cavities.insert(i);
      }
    }
  }

  /// The share of a tissue in a compartment's outer boundary.
  struct Share
  {
    std::set<vtkIdType> Outwards, All; ///< triangles, and those with normals out of it
    double Area = 0;                   ///< of the former, m²
  };

  void FindRegions()
  {
    std::vector<std::map<int, Share>> shares(Result.Count());
    std::vector<vtkIdType> first(Result.Count(), VTK_ID_MAX), first_of_any = first;
    for (std::size_t c = 0; c < Copies.size(); ++c)
    {
      const Copy& copy = Copies[c];
      const int behind = Outward[c] > 0 ? this->Behind(copy) : this->InFront(copy);
      for (const int i : Result.Sides[copy.Triangle])
      {
        if (!Filled[i] || PartOf[copy.Triangle] != Result.Part[i])
        {
          continue;
        }
        auto& share = shares[i][copy.Tissue];
        share.All.insert(copy.Triangle);
        first_of_any[i] = std::min(first_of_any[i], copy.Source);
        if (i == behind)
        {
          share.Area +=
            share.Outwards.insert(copy.Triangle).second ? AreaOf(Walls, copy.Triangle) : 0;
          first[i] = std::min(first[i], copy.Source);
        }
      }
    }

    Result.Region.assign(Result.Count(), Compartments::Empty);
    std::vector<int> nameless;
    for (int i = 1; i < Result.Count(); ++i)
    {
      if (!Filled[i])
      {
        continue;
      }
      Result.Region[i] = this->TissueOf(i, shares[i]);
      if (Result.Region[i] < 0)
      {
        nameless.push_back(i);
      }
    }
    const auto place = [&](int i)
    { return std::make_pair(first[i] < VTK_ID_MAX ? first[i] : first_of_any[i], i); };
    std::sort(
      nameless.begin(), nameless.end(), [&place](int a, int b) { return place(a) < place(b); });
    for (std::size_t i = 0; i < nameless.size(); ++i)
    {
      Result.Region[nameless[i]] = static_cast<int>(i);
    }
  }

  int TissueOf(int compartment, const std::map<int, Share>& shares)
  {
    const std::size_t whole = Result.Boundary[compartment].Triangles.size();
    std::vector<int> full, some;
    int largest = -1;
    std::pair<double, std::size_t> most = { -1, 0 };
    for (const auto& [tissue, share] : shares)
    {
      if (share.Outwards.size() == whole)
      {
        full.push_back(tissue);
      }
      if (!share.Outwards.empty())
      {
        some.push_back(tissue);
      }
      if (const auto size = std::make_pair(share.Area, share.All.size()); size > most)
      {
        most = size;
        largest = tissue;
      }
    }
    if (full.size() == 1)
    {
      return full[0];
    }
    if (some.empty())
    {
      // The surface is inside out if no other tissue has this wall.
      const auto found = std::find_if(shares.begin(), shares.end(),
        [whole](const auto& entry) { return entry.second.All.size() == whole; });
      return found != shares.end() ? found->first : largest;
    }
    std::vector<int> closed;
    std::copy_if(some.begin(), some.end(), std::back_inserter(closed),
      [this](int tissue) { return Closed.count(tissue) > 0; });
    if (closed.size() > 1)
    {
      Result.Overlaps.push_back({ compartment, { closed[0], closed[1] } });
    }
    else if (some.size() > 1)
    {
      Result.Doubtful.push_back(compartment);
    }
    return largest;
  }

  void FindHinges()
  {
    ForEachEdge(vtkPalpateSides(Walls),
      [this](auto first, auto last)
      {
        const auto borders_tissue = [this](const Side& side)
        {
          const auto& [behind, front] = Result.Sides[side.Triangle];
          return Filled[behind] != Filled[front];
        };
        if (last - first > 2 && std::count_if(first, last, borders_tissue) > 2)
        {
          Result.Hinges.push_back({ first->Low, first->High });
        }
      });
  }

  const vtkPalpateSurface& Walls;
  const std::vector<Copy>& Copies;
  Compartments Result;
  std::vector<int> PartOf;            ///< of each triangle
  std::vector<vtkIdType> FirstOfPart; ///< triangle
  std::vector<int> Around;            ///< of each part
  std::vector<char> Filled;           ///< of each compartment
  std::vector<int> Outward; ///< of each copy: 1 where its normal points out of its tissue, or −1
  std::set<int> Closed;     ///< tissues
};

}

vtkPalpateCompartments vtkPalpateFindCompartments(const vtkPalpateWalls& walls)
{
  return Finder(walls).Find();
}

int vtkPalpateCompartmentOf(const vtkPalpateCompartments& compartments, const vtkPalpatePoint& x)
{
  int found = vtkPalpateCompartments::Outside;
  double least = 0;
  for (int i = 1; i < compartments.Count(); ++i)
  {
    const auto& boundary = compartments.Boundary[i];
    const double volume = vtkPalpateVolume(boundary);
    const bool smaller = found == vtkPalpateCompartments::Outside || volume < least;
    // Any level between 0 (outside) and 1 (inside).
    if (smaller && vtkPalpateIsInside(vtkPalpateBounds(boundary), x) &&
      vtkPalpateWindingNumber(boundary, x) > 0.5)
    {
      found = i;
      least = volume;
    }
  }
  return found;
}

vtkPalpatePoint vtkPalpateMiddleOf(const vtkPalpateCompartments& compartments, int compartment)
{
  const auto b = vtkPalpateBounds(compartments.Boundary[compartment]);
  return { (b[0] + b[1]) / 2, (b[2] + b[3]) / 2, (b[4] + b[5]) / 2 };
}
