// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateLabelSurface.h"

#include <algorithm>
#include <cmath>

#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateTriangleIntersection.h"
#include "vtkVector.h"
#if __has_include("vtkVectorOperators.h") // In later versions vtkVector.h has them.
#  include "vtkVectorOperators.h"
#endif

namespace
{
using Vector = vtkVector3d;

/// The largest displacement of a point, as a share of a cube. Beyond half a cube, a wall could pass
/// the middle of a cube.
constexpr double Bound = 0.45;
/// A box in place of a cube stays within that of the middle of the cube: other walls are farther
/// away than 1.5 - Bound, and middles of cubes are farther away than that.
constexpr double BoxBound = 0.95;
constexpr int VolumeIterations = 20;
/// The largest error of a part's volume that is not corrected, as a share of the volume.
constexpr double VolumeTolerance = 1e-4;
constexpr int Rounds = 8;
constexpr int Projections = 5;

/// The walls with points in units of a cube, where the middle of a cube has whole numbers.
class Walls
{
public:
  /// @param boxes Whether a single cube becomes a box.
  Walls(
    const vtkPalpateLabelGrid& grid, const vtkPalpateLabelParts& parts, double share, bool boxes)
    : Grid(grid)
    , Parts(parts)
    , Share(share)
  {
    this->FindFaces(boxes);
    this->FindNeighbours();
  }

  void Smooth(int iterations)
  {
    constexpr double relaxation = 0.5;
    std::vector<Vector> next = this->Points;
    for (int i = 0; i < iterations; ++i)
    {
      for (std::size_t p = 0; p < this->Points.size(); ++p)
      {
        const auto& around = this->Neighbours[p];
        if (!around.empty())
        {
          Vector mean(0, 0, 0);
          for (const int q : around)
          {
            mean = mean + this->Points[q];
          }
          mean = (1.0 / static_cast<double>(around.size())) * mean;
          next[p] = this->Points[p] + relaxation * (mean - this->Points[p]);
          this->Confine(p, next[p]);
        }
      }
      this->Points = next;
      if (iterations - i <= Projections)
      {
        this->Project();
      }
    }
    for (std::size_t p = 0; p < this->Points.size(); ++p)
    {
      this->Points[p] = this->Rest[p] + this->Share * (this->Points[p] - this->Rest[p]);
    }
  }

  /// Divides each face into two triangles, along its shorter diagonal.
  void Split()
  {
    this->Triangles.clear();
    this->Sides.clear();
    for (std::size_t f = 0; f < this->Faces.size(); ++f)
    {
      const auto& q = this->Faces[f];
      const double first = (this->Points[q[0]] - this->Points[q[2]]).SquaredNorm();
      const double second = (this->Points[q[1]] - this->Points[q[3]]).SquaredNorm();
      if (first <= second)
      {
        this->Triangles.push_back({ q[0], q[1], q[2] });
        this->Triangles.push_back({ q[0], q[2], q[3] });
      }
      else
      {
        this->Triangles.push_back({ q[0], q[1], q[3] });
        this->Triangles.push_back({ q[1], q[2], q[3] });
      }
      this->Sides.push_back(this->FaceSides[f]);
      this->Sides.push_back(this->FaceSides[f]);
    }
  }

  /// The volume of each part, in cubes; the entry of 0 has no meaning.
  std::vector<double> Volumes() const
  {
    std::vector<double> volumes(this->Parts.Each.size(), 0);
    for (std::size_t t = 0; t < this->Triangles.size(); ++t)
    {
      const auto& c = this->Triangles[t];
      const double volume =
        this->Points[c[0]].Dot(this->Points[c[1]].Cross(this->Points[c[2]])) / 6;
      volumes[this->Sides[t][0]] += volume;
      volumes[this->Sides[t][1]] -= volume;
    }
    return volumes;
  }

  /// Moves each wall between a and b by λ_a − λ_b, λ_0 = 0, so that the volumes of all parts are
  /// right to first order.
  void FitVolumes()
  {
    std::vector<double> wanted(this->Parts.Each.size());
    for (std::size_t part = 0; part < wanted.size(); ++part)
    {
      wanted[part] = static_cast<double>(this->Parts.Each[part].Count) * this->Parts.Grid.Volume() /
        this->Grid.Volume();
    }
    for (int iteration = 0; iteration < VolumeIterations; ++iteration)
    {
      std::vector<double> missing(wanted.size(), 0);
      double worst = 0;
      const auto volumes = this->Volumes();
      for (std::size_t part = 1; part < wanted.size(); ++part)
      {
        if (volumes[part] == 0)
        {
          continue; // It is lost.
        }
        missing[part] = wanted[part] - volumes[part];
        worst = std::max(worst, std::abs(missing[part]) / wanted[part]);
      }
      if (worst < VolumeTolerance)
      {
        return;
      }
      std::vector<Vector> normals(this->Triangles.size());
      std::vector<std::map<int, double>> shared(wanted.size()); // areas of the walls to others
      for (std::size_t t = 0; t < this->Triangles.size(); ++t)
      {
        const auto& c = this->Triangles[t];
        normals[t] = 0.5 *
          (this->Points[c[1]] - this->Points[c[0]]).Cross(this->Points[c[2]] - this->Points[c[0]]);
        const auto [a, b] = this->Sides[t];
        shared[a][b] += normals[t].Norm();
        shared[b][a] += normals[t].Norm();
      }
      const std::vector<double> level = Levels(shared, missing);
      std::vector<Vector> move(this->Points.size(), Vector(0, 0, 0));
      std::vector<double> weight(this->Points.size(), 0);
      for (std::size_t t = 0; t < this->Triangles.size(); ++t)
      {
        const double shift = level[this->Sides[t][0]] - level[this->Sides[t][1]];
        for (const vtkIdType p : this->Triangles[t])
        {
          move[p] = move[p] + shift * normals[t];
          weight[p] += normals[t].Norm();
        }
      }
      for (std::size_t p = 0; p < this->Points.size(); ++p)
      {
        if (weight[p] > 0)
        {
          this->Points[p] = this->Points[p] + (1 / weight[p]) * move[p];
          this->Confine(p, this->Points[p]);
        }
      }
    }
  }

  /// Moves the points of triangles that have no area, or that cross each other, back to this share
  /// of their way, beyond which they do not move from then on.
  /// @returns Whether there were no such triangles.
  bool PutBack(const vtkPalpateSurface& surface, double share)
  {
    std::vector<char> wrong(this->Points.size(), 0);
    bool none = true;
    const auto mark = [&](vtkIdType triangle)
    {
      none = false;
      for (const vtkIdType p : this->Triangles[triangle])
      {
        wrong[p] = 1;
      }
    };
    for (const vtkIdType triangle : vtkPalpateFlatTriangles(surface))
    {
      mark(triangle);
    }
    for (const auto& [first, second] : vtkPalpateIntersectingTriangles(surface))
    {
      mark(first);
      mark(second);
    }
    for (std::size_t p = 0; p < this->Points.size(); ++p)
    {
      if (wrong[p] != 0)
      {
        this->Reach[p] *= share;
        this->Points[p] = this->Rest[p] + share * (this->Points[p] - this->Rest[p]);
      }
    }
    return none;
  }

  vtkPalpateSurface ToSpace() const
  {
    vtkPalpateSurface surface;
    for (const Vector& p : this->Points)
    {
      surface.Points.push_back(this->Grid.Place(p[0], p[1], p[2]));
    }
    surface.Triangles = this->Triangles;
    if (this->Grid.SignedVolume() < 0)
    {
      for (auto& triangle : surface.Triangles)
      {
        std::swap(triangle[1], triangle[2]);
      }
    }
    return surface;
  }

  /// See vtkPalpateLabelSurface.
  std::vector<std::pair<vtkPalpatePoint, int>> Inside() const
  {
    std::vector<std::pair<vtkPalpatePoint, int>> places;
    const vtkPalpateLabelParts regions = vtkPalpateFindParts(this->Grid);
    for (std::size_t region = 1; region < regions.Each.size(); ++region)
    {
      const auto& cube = regions.Each[region].Voxel;
      const auto box = this->Boxes.find(cube);
      const Vector at = box == this->Boxes.end() ? Vector(cube[0], cube[1], cube[2]) : box->second;
      places.emplace_back(this->Grid.Place(at[0], at[1], at[2]), regions.Each[region].Label);
    }
    return places;
  }

  std::vector<std::array<int, 2>> Sides;

private:
  /// Moves points between two parts alone to where these have the same share of a cube around
  /// them.
  void Project()
  {
    std::vector<Vector> normals(this->Points.size(), Vector(0, 0, 0));
    for (std::size_t f = 0; f < this->Faces.size(); ++f)
    {
      const auto& q = this->Faces[f];
      const Vector normal =
        (this->Points[q[2]] - this->Points[q[0]]).Cross(this->Points[q[3]] - this->Points[q[1]]);
      for (const vtkIdType p : q)
      {
        const double sign = this->FaceSides[f][0] == this->Between[p][0] ? 1 : -1;
        normals[p] = normals[p] + sign * normal;
      }
    }
    std::array<double, 3> box{};
    for (int axis = 0; axis < 3; ++axis)
    {
      box[axis] = this->Grid.Spacing(axis) / this->Parts.Grid.Spacing(axis);
    }
    vtkPalpateLabelShares shares(this->Parts.Grid, box);
    for (std::size_t p = 0; p < this->Points.size(); ++p)
    {
      const double length = normals[p].Norm();
      const auto [behind, front] = this->Between[p];
      if (behind == front || length == 0)
      {
        continue;
      }
      const auto place =
        this->Grid.Place(this->Points[p][0], this->Points[p][1], this->Points[p][2]);
      shares.MoveTo(this->Parts.Grid.VoxelsOf(place));
      // Across a plane wall the difference falls from 1 to -1 within a voxel.
      const double difference = shares.Of(behind) - shares.Of(front);
      this->Points[p] = this->Points[p] + (0.5 * difference / length) * normals[p];
      this->Confine(p, this->Points[p]);
    }
  }

  /// λ of each part with Σ_b A_ab (λ_a − λ_b) = missing_a, λ_0 = 0, by sweeps of Gauss and Seidel:
  /// it is the start of the next iteration that has to be better, not the solution.
  static std::vector<double> Levels(
    const std::vector<std::map<int, double>>& areas, const std::vector<double>& missing)
  {
    constexpr int sweeps = 50;
    std::vector<double> level(missing.size(), 0);
    for (int sweep = 0; sweep < sweeps; ++sweep)
    {
      for (std::size_t a = 1; a < missing.size(); ++a)
      {
        double sum = missing[a];
        double area = 0;
        for (const auto& [b, between] : areas[a])
        {
          sum += between * level[b];
          area += between;
        }
        level[a] = area > 0 ? sum / area : 0;
      }
    }
    return level;
  }

  /// Makes a square of corners for each pair of unlike cubes that share a face.
  void FindFaces(bool boxes)
  {
    const auto& size = this->Grid.Size;
    const std::array<int, 3> corners = { size[0] + 1, size[1] + 1, size[2] + 1 };
    std::vector<int> number(static_cast<std::size_t>(corners[0]) * corners[1] * corners[2], -1);
    // The corner (i, j, k) is between the cubes i − 1 and i, and so on.
    const auto point = [&](const std::array<int, 3>& at)
    {
      int& known =
        number[(static_cast<std::size_t>(at[2]) * corners[1] + at[1]) * corners[0] + at[0]];
      if (known < 0)
      {
        known = static_cast<int>(this->Points.size());
        this->Points.push_back(Vector(at[0] - 0.5, at[1] - 0.5, at[2] - 0.5));
      }
      return static_cast<vtkIdType>(known);
    };
    for (int k = 0; k <= size[2]; ++k)
    {
      for (int j = 0; j <= size[1]; ++j)
      {
        for (int i = 0; i <= size[0]; ++i)
        {
          const int front = this->Grid.At(i, j, k);
          for (int axis = 0; axis < 3; ++axis)
          {
            std::array<int, 3> before = { i, j, k };
            --before[axis];
            const int behind = this->Grid.At(before[0], before[1], before[2]);
            if (behind == front)
            {
              continue;
            }
            // Around the axis, as seen against it counter-clockwise.
            const int u = (axis + 1) % 3;
            const int v = (axis + 2) % 3;
            std::array<vtkIdType, 4> face{};
            for (int corner = 0; corner < 4; ++corner)
            {
              std::array<int, 3> at = { i, j, k };
              at[u] += corner == 1 || corner == 2;
              at[v] += corner >= 2;
              face[corner] = point(at);
            }
            this->Faces.push_back(face);
            this->FaceSides.push_back({ behind, front });
          }
        }
      }
    }
    this->Rest = this->Points;
    this->Reach.assign(this->Points.size(), 1);
    this->CubesOf.assign(this->Parts.Each.size(), 0);
    for (const int part : this->Grid.Labels)
    {
      ++this->CubesOf[static_cast<std::size_t>(part)];
    }
    if (boxes)
    {
      this->MakeBoxes(point);
    }
  }

  /// @param point Gives the number of a corner.
  template <class Point>
  void MakeBoxes(Point&& point)
  {
    const auto& size = this->Grid.Size;
    for (int k = 0; k < size[2]; ++k)
    {
      for (int j = 0; j < size[1]; ++j)
      {
        for (int i = 0; i < size[0]; ++i)
        {
          const std::array<int, 3> cube = { i, j, k };
          std::array<double, 3> edges{};
          if (!this->IsAlone(cube) || !this->BoxEdges(this->Grid.At(i, j, k), edges))
          {
            continue;
          }
          const Vector middle = this->BoxMiddle(cube, edges);
          this->Boxes.emplace(cube, middle);
          for (int corner = 0; corner < 8; ++corner)
          {
            const std::array<int, 3> up = { corner & 1, (corner >> 1) & 1, (corner >> 2) & 1 };
            const auto p = static_cast<std::size_t>(point({ i + up[0], j + up[1], k + up[2] }));
            for (int axis = 0; axis < 3; ++axis)
            {
              this->Rest[p][axis] = middle[axis] + (up[axis] - 0.5) * edges[axis];
            }
            this->Points[p] = this->Rest[p];
            this->Reach[p] = 0;
          }
        }
      }
    }
  }

  /// Whether the cubes around a cube are all of one other part.
  bool IsAlone(const std::array<int, 3>& cube) const
  {
    const int own = this->Grid.At(cube[0], cube[1], cube[2]);
    const int around = this->Grid.At(cube[0] - 1, cube[1], cube[2]);
    bool alone = own != 0 && around != own;
    for (int step = 0; alone && step < 27; ++step)
    {
      const int to =
        this->Grid.At(cube[0] + step % 3 - 1, cube[1] + step / 3 % 3 - 1, cube[2] + step / 9 - 1);
      constexpr int itself = 13;
      alone = step == itself || to == around;
    }
    return alone;
  }

  /// Finds the edges of the box in place of a cube, in cubes.
  /// @returns Whether there is such a box: the part must not be in other cubes, too.
  bool BoxEdges(int number, std::array<double, 3>& edges) const
  {
    const vtkPalpateLabelPart& part = this->Parts.Each[static_cast<std::size_t>(number)];
    const double volume =
      static_cast<double>(part.Count) * this->Parts.Grid.Volume() / this->Grid.Volume();
    for (int axis = 0; axis < 3; ++axis)
    {
      edges[axis] = part.Edges[axis] * this->Parts.Grid.Spacing(axis) / this->Grid.Spacing(axis);
    }
    const double scale = std::cbrt(volume / (edges[0] * edges[1] * edges[2]));
    for (double& edge : edges)
    {
      edge *= scale;
    }
    const auto fits = [](double edge) { return edge < 2 * BoxBound; };
    if (!std::all_of(edges.begin(), edges.end(), fits))
    {
      edges.fill(std::cbrt(volume));
    }
    return this->CubesOf[static_cast<std::size_t>(number)] == 1 && fits(edges[0]);
  }

  /// The middle of the box, as near to that of the part as the box may be.
  Vector BoxMiddle(const std::array<int, 3>& cube, const std::array<double, 3>& edges) const
  {
    const vtkPalpateLabelPart& part =
      this->Parts.Each[static_cast<std::size_t>(this->Grid.At(cube[0], cube[1], cube[2]))];
    const auto place =
      this->Grid.VoxelsOf(this->Parts.Grid.Place(part.Middle[0], part.Middle[1], part.Middle[2]));
    Vector middle;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double room = BoxBound - edges[axis] / 2;
      middle[axis] = std::clamp(place[axis], cube[axis] - room, cube[axis] + room);
    }
    return middle;
  }

  /// Finds the neighbours that a point is smoothed with: those along the walls, or where walls of
  /// different labels meet, those along the curve of such points; none at the ends of curves.
  void FindNeighbours()
  {
    struct Edge
    {
      int Low, High;
      std::array<int, 2> Labels;
    };
    std::vector<Edge> edges;
    edges.reserve(4 * this->Faces.size());
    for (std::size_t f = 0; f < this->Faces.size(); ++f)
    {
      const std::array<int, 2> labels = { std::min(this->FaceSides[f][0], this->FaceSides[f][1]),
        std::max(this->FaceSides[f][0], this->FaceSides[f][1]) };
      for (int i = 0; i < 4; ++i)
      {
        const auto a = static_cast<int>(this->Faces[f][i]);
        const auto b = static_cast<int>(this->Faces[f][(i + 1) % 4]);
        edges.push_back({ std::min(a, b), std::max(a, b), labels });
      }
    }
    std::sort(edges.begin(), edges.end(),
      [](const Edge& a, const Edge& b)
      { return a.Low != b.Low ? a.Low < b.Low : a.High < b.High; });
    std::vector<std::vector<int>> along(this->Points.size());
    this->Neighbours.resize(this->Points.size());
    for (auto first = edges.begin(); first != edges.end();)
    {
      auto last = first;
      bool alike = true;
      while (last != edges.end() && last->Low == first->Low && last->High == first->High)
      {
        alike = alike && last->Labels == first->Labels;
        ++last;
      }
      const bool meets = !alike || last - first != 2;
      for (auto* of : { &this->Neighbours, &along })
      {
        if (of == &this->Neighbours || meets)
        {
          (*of)[first->Low].push_back(first->High);
          (*of)[first->High].push_back(first->Low);
        }
      }
      first = last;
    }
    this->Between.assign(this->Points.size(), { 0, 0 });
    for (std::size_t f = 0; f < this->Faces.size(); ++f)
    {
      for (const vtkIdType p : this->Faces[f])
      {
        if (along[p].empty())
        {
          this->Between[p] = { std::min(this->FaceSides[f][0], this->FaceSides[f][1]),
            std::max(this->FaceSides[f][0], this->FaceSides[f][1]) };
        }
      }
    }
    for (std::size_t p = 0; p < this->Points.size(); ++p)
    {
      if (along[p].size() == 2)
      {
        this->Neighbours[p] = along[p];
      }
      else if (!along[p].empty())
      {
        this->Neighbours[p].clear();
      }
    }
  }

  void Confine(std::size_t p, Vector& x) const
  {
    const double bound = this->Reach[p] * Bound;
    for (int axis = 0; axis < 3; ++axis)
    {
      x[axis] = std::clamp(x[axis], this->Rest[p][axis] - bound, this->Rest[p][axis] + bound);
    }
  }

  const vtkPalpateLabelGrid& Grid;
  const vtkPalpateLabelParts& Parts;
  double Share;
  std::vector<Vector> Points;
  std::vector<Vector> Rest;
  std::vector<std::size_t> CubesOf;           ///< each part
  std::vector<double> Reach;                  ///< of each point, in Bound
  std::map<std::array<int, 3>, Vector> Boxes; ///< their middles, by cube
  std::vector<std::array<vtkIdType, 4>> Faces;
  std::vector<std::array<int, 2>> FaceSides;
  std::vector<std::vector<int>> Neighbours;
  /// The two parts that meet at a point. If more than two meet there, the pair has the same part
  /// twice.
  std::vector<std::array<int, 2>> Between;
  std::vector<std::array<vtkIdType, 3>> Triangles;
};
}

vtkPalpateLabelSurface vtkPalpateMakeLabelSurface(
  const vtkPalpateLabelGrid& cubes, const vtkPalpateLabelParts& parts, int iterations, double share)
{
  Walls walls(cubes, parts, share, iterations > 0);
  walls.Smooth(iterations);
  walls.Split();
  const bool fits = iterations > 0 && share > 0;
  // At rest nothing crosses.
  for (int round = 0; round < Rounds; ++round)
  {
    if (fits)
    {
      walls.FitVolumes();
    }
    if (walls.PutBack(walls.ToSpace(), round < Rounds / 2 ? 0.5 : 0))
    {
      break;
    }
  }
  vtkPalpateLabelSurface result;
  result.Walls = walls.ToSpace();
  result.Sides = walls.Sides;
  result.Volumes = walls.Volumes();
  for (double& volume : result.Volumes)
  {
    volume *= cubes.Volume();
  }
  result.Inside = walls.Inside();
  return result;
}
