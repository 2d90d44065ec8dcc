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

/// Shares of a voxel. Beyond half a voxel a wall could pass the middle of one.
constexpr double Bound = 0.45;
constexpr int VolumeIterations = 20;
/// Of a label's volume; below this there is nothing to be corrected.
constexpr double VolumeTolerance = 1e-4;
constexpr int Rounds = 8;
constexpr int Projections = 5;

/// The walls with points in units of a voxel, where the middle of a voxel has whole numbers.
class Walls
{
public:
  Walls(const vtkPalpateLabelGrid& grid, const vtkPalpateLabelParts& parts,
    const vtkPalpateLabelGrid& image, double share)
    : Grid(grid)
    , Parts(parts)
    , Image(image)
    , Share(share)
  {
    this->FindFaces();
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

  /// Two triangles a face, along its shorter diagonal.
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

  /// Of each part, in voxels; that of 0 has no meaning.
  std::vector<double> Volumes() const
  {
    std::vector<double> volumes(this->Parts.Label.size(), 0);
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
  /// @param wanted In voxels; that of 0 has no meaning.
  void FitVolumes(const std::vector<double>& wanted)
  {
    for (int iteration = 0; iteration < VolumeIterations; ++iteration)
    {
      std::vector<double> missing(wanted.size(), 0);
      double worst = 0;
      const auto volumes = this->Volumes();
      for (std::size_t part = 1; part < wanted.size(); ++part)
      {
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

  /// @returns whether nothing was to be put back.
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

  std::vector<std::array<int, 2>> Sides;

private:
  /// Moves points between two labels alone to where these have the same share of a voxel around
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
      box[axis] = this->Grid.Spacing(axis) / this->Image.Spacing(axis);
    }
    vtkPalpateLabelShares shares(this->Image, box);
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
      shares.MoveTo(this->Image.VoxelsOf(place));
      // Across a plane wall the difference falls from 1 to -1 within a voxel.
      const double difference =
        shares.Of(this->Parts.Label[behind]) - shares.Of(this->Parts.Label[front]);
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

  /// 0 outside the image.
  int PartAt(int i, int j, int k) const
  {
    const auto& size = this->Grid.Size;
    const bool inside = i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
    return inside ? this->Parts.OfVoxel[this->Grid.Index(i, j, k)] : 0;
  }

  /// A square of voxel corners for each pair of unlike voxels side by side.
  void FindFaces()
  {
    const auto& size = this->Grid.Size;
    const std::array<int, 3> corners = { size[0] + 1, size[1] + 1, size[2] + 1 };
    std::vector<int> number(static_cast<std::size_t>(corners[0]) * corners[1] * corners[2], -1);
    // The corner (i, j, k) is between the voxels i − 1 and i, and so on.
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
          const int front = this->PartAt(i, j, k);
          for (int axis = 0; axis < 3; ++axis)
          {
            std::array<int, 3> before = { i, j, k };
            --before[axis];
            const int behind = this->PartAt(before[0], before[1], before[2]);
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
  }

  /// Those that draw at a point: along the walls, or where walls of different labels meet, along
  /// the curve of those; none at the ends of curves.
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
    for (int axis = 0; axis < 3; ++axis)
    {
      x[axis] = std::clamp(x[axis], this->Rest[p][axis] - Bound, this->Rest[p][axis] + Bound);
    }
  }

  const vtkPalpateLabelGrid& Grid;
  const vtkPalpateLabelParts& Parts;
  const vtkPalpateLabelGrid& Image;
  double Share;
  std::vector<Vector> Points;
  std::vector<Vector> Rest;
  std::vector<std::array<vtkIdType, 4>> Faces;
  std::vector<std::array<int, 2>> FaceSides;
  std::vector<std::vector<int>> Neighbours;
  /// The two parts that alone meet at a point; where others do, too, twice the same.
  std::vector<std::array<int, 2>> Between;
  std::vector<std::array<vtkIdType, 3>> Triangles;
};
}

vtkPalpateLabelSurface vtkPalpateMakeLabelSurface(const vtkPalpateLabelGrid& grid,
  const vtkPalpateLabelParts& parts, const vtkPalpateLabelGrid& image,
  const std::map<int, double>& wanted, int iterations, double share)
{
  Walls walls(grid, parts, image, share);
  walls.Smooth(iterations);
  walls.Split();
  if (iterations > 0 && share > 0)
  {
    std::map<int, std::size_t> counts;
    for (std::size_t part = 1; part < parts.Label.size(); ++part)
    {
      counts[parts.Label[part]] += parts.Count[part];
    }
    std::vector<double> in_voxels = { 0 };
    for (std::size_t part = 1; part < parts.Label.size(); ++part)
    {
      const int label = parts.Label[part];
      const double of_label = wanted.at(label) / grid.Volume();
      in_voxels.push_back(
        of_label * static_cast<double>(parts.Count[part]) / static_cast<double>(counts[label]));
    }
    walls.FitVolumes(in_voxels);
  }
  vtkPalpateLabelSurface result;
  // At rest nothing crosses.
  for (int round = 0; round < Rounds; ++round)
  {
    if (walls.PutBack(walls.ToSpace(), round < Rounds / 2 ? 0.5 : 0))
    {
      break;
    }
  }
  result.Walls = walls.ToSpace();
  for (const auto& [behind, front] : walls.Sides)
  {
    result.Sides.push_back({ parts.Label[behind], parts.Label[front] });
  }
  const std::vector<double> volumes = walls.Volumes();
  for (std::size_t part = 1; part < volumes.size(); ++part)
  {
    result.Volumes[parts.Label[part]] += volumes[part] * grid.Volume();
  }
  return result;
}
