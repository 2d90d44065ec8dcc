// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSurfaceResample.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "mesh/box_tree.h"
#include "vtkFlyingEdges3D.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateSurfaceRelax.h"
#include "vtkPalpateSurfaceShells.h"
#include "vtkPolyData.h"
#include "vtkQuadricDecimation.h"

namespace
{
/// Distances are exact up to so many grid steps and cut off beyond: the zero level needs one.
constexpr double BandInSteps = 2;
/// No grid point is nearer to the level than this fraction of a step: keeps slivers out.
constexpr double LeastDistanceInSteps = 0.05;

struct Grid
{
  std::array<int, 3> Size;
  vtkPalpatePoint Origin;
  double Step;

  Grid(const vtkPalpateSurface& surface, int resolution)
  {
    const auto bounds = vtkPalpateBounds(surface);
    const double longest =
      std::max({ bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] });
    Step = longest / (resolution - 1);
    for (int i = 0; i < 3; ++i)
    {
      const double length = bounds[2 * i + 1] - bounds[2 * i];
      // Two points outside at either end close the level; the grid is centred.
      Size[i] = static_cast<int>(std::ceil(length / Step)) + 5;
      Origin[i] = (bounds[2 * i] + bounds[2 * i + 1] - (Size[i] - 1) * Step) / 2;
    }
  }

  std::size_t Count() const { return static_cast<std::size_t>(Size[0]) * Size[1] * Size[2]; }
  std::size_t Stride(int axis) const
  {
    return axis == 0 ? 1 : axis == 1 ? Size[0] : static_cast<std::size_t>(Size[0]) * Size[1];
  }
  double Coordinate(int axis, int index) const { return Origin[axis] + index * Step; }
  /// The least index whose coordinate is not below x, within the grid.
  int Above(int axis, double x) const
  {
    return std::clamp(static_cast<int>(std::ceil((x - Origin[axis]) / Step)), 0, Size[axis] - 1);
  }
  /// The greatest index whose coordinate is not above x, within the grid.
  int Below(int axis, double x) const
  {
    return std::clamp(static_cast<int>(std::floor((x - Origin[axis]) / Step)), 0, Size[axis] - 1);
  }
};

/// Whether the point lies on the triangle, seen along the axis. A point on the edge between two
/// triangles belongs to exactly one of them, or, at a fold, to both or none.
bool Covers(
  const std::array<vtkPalpatePoint, 3>& corners, int turn, const vtkPalpatePoint& x, int axis)
{
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  for (int i = 0; i < 3; ++i)
  {
    const auto& from = corners[i];
    const auto& to = corners[(i + 1) % 3];
    const int side = turn * vtkPalpateOrient2D(from, to, x, axis);
    const double du = turn * (to[u] - from[u]);
    const double dv = turn * (to[v] - from[v]);
    if (side < 0 || (side == 0 && !(dv > 0 || (dv == 0 && du > 0))))
    {
      return false;
    }
  }
  return true;
}

/// Adds to each grid point the winding number that the grid lines along the axis give.
void AddWinding(
  const vtkPalpateSurface& surface, const Grid& grid, int axis, std::vector<float>& winding)
{
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const std::size_t step_u = grid.Stride(u), step_v = grid.Stride(v), step = grid.Stride(axis);
  // At each grid point: crossings between it and the point before it, outward less inward.
  std::vector<std::int16_t> crossings(grid.Count(), 0);
  for (const auto& triangle : surface.Triangles)
  {
    const std::array<vtkPalpatePoint, 3> corners = { surface.Points[triangle[0]],
      surface.Points[triangle[1]], surface.Points[triangle[2]] };
    const int turn = vtkPalpateOrient2D(corners[0], corners[1], corners[2], axis);
    if (turn == 0)
    {
      continue;
    }
    const auto normal = vtkPalpateNormal(corners[0], corners[1], corners[2]);
    const auto range_u = std::minmax({ corners[0][u], corners[1][u], corners[2][u] });
    const auto range_v = std::minmax({ corners[0][v], corners[1][v], corners[2][v] });
    const auto range = std::minmax({ corners[0][axis], corners[1][axis], corners[2][axis] });
    for (int j = grid.Above(v, range_v.first); j <= grid.Below(v, range_v.second); ++j)
    {
      for (int i = grid.Above(u, range_u.first); i <= grid.Below(u, range_u.second); ++i)
      {
        vtkPalpatePoint x = corners[0];
        x[u] = grid.Coordinate(u, i);
        x[v] = grid.Coordinate(v, j);
        if (!Covers(corners, turn, x, axis))
        {
          continue;
        }
        const double height = corners[0][axis] -
          (normal[u] * (x[u] - corners[0][u]) + normal[v] * (x[v] - corners[0][v])) / normal[axis];
        const int k = grid.Above(axis, std::clamp(height, range.first, range.second));
        crossings[i * step_u + j * step_v + k * step] += static_cast<std::int16_t>(turn);
      }
    }
  }

  for (int j = 0; j < grid.Size[v]; ++j)
  {
    for (int i = 0; i < grid.Size[u]; ++i)
    {
      const std::size_t start = i * step_u + j * step_v;
      int total = 0;
      for (int k = 0; k < grid.Size[axis]; ++k)
      {
        total += crossings[start + k * step];
      }
      int below = 0;
      for (int k = 0; k < grid.Size[axis]; ++k)
      {
        // Mean of what the line sees upwards and downwards; equal where the surface is closed.
        below += crossings[start + k * step];
        winding[start + k * step] += static_cast<float>(total) / 2 - static_cast<float>(below);
      }
    }
  }
}

/// Distance of each grid point to the surface, in grid steps, at most BandInSteps.
void Distance(const vtkPalpateSurface& surface, const Grid& grid, float* distance)
{
  const double band = BandInSteps * grid.Step;
  std::fill_n(distance, grid.Count(), static_cast<float>(BandInSteps * BandInSteps));
  for (const auto& triangle : surface.Triangles)
  {
    const palpate::Vec3 a(surface.Points[triangle[0]].data());
    const palpate::Vec3 b(surface.Points[triangle[1]].data());
    const palpate::Vec3 c(surface.Points[triangle[2]].data());
    std::array<int, 3> first, last;
    for (int i = 0; i < 3; ++i)
    {
      const auto range = std::minmax({ a[i], b[i], c[i] });
      first[i] = grid.Above(i, range.first - band);
      last[i] = grid.Below(i, range.second + band);
    }
    for (int k = first[2]; k <= last[2]; ++k)
    {
      for (int j = first[1]; j <= last[1]; ++j)
      {
        for (int i = first[0]; i <= last[0]; ++i)
        {
          const palpate::Vec3 x(
            grid.Coordinate(0, i), grid.Coordinate(1, j), grid.Coordinate(2, k));
          const double squared =
            palpate::nearest_on_triangle(a, b, c, x).squared_distance / (grid.Step * grid.Step);
          float& value = distance[i + j * grid.Stride(1) + k * grid.Stride(2)];
          value = std::min(value, static_cast<float>(squared));
        }
      }
    }
  }
  std::transform(
    distance, distance + grid.Count(), distance, [](float squared) { return std::sqrt(squared); });
}

/// In units of grid steps, with the grid's first point at the origin: any unit of length will do.
vtkSmartPointer<vtkImageData> SignedDistance(
  const vtkPalpateSurface& surface, const Grid& grid, const vtkPalpateShareDone& progress)
{
  std::vector<float> winding(grid.Count(), 0);
  for (int axis = 0; axis < 3; ++axis)
  {
    AddWinding(surface, grid, axis, winding);
    progress(0.1 * (axis + 1));
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(grid.Size.data());
  image->AllocateScalars(VTK_FLOAT, 1);
  auto* distance = static_cast<float*>(image->GetScalarPointer());
  Distance(surface, grid, distance);
  for (std::size_t i = 0; i < grid.Count(); ++i)
  {
    const float size = std::max(distance[i], static_cast<float>(LeastDistanceInSteps));
    distance[i] = winding[i] / 3 > 0.5F ? -size : size;
  }
  progress(0.6);
  return image;
}

/// The surface without pieces that are smaller than a grid cell: splinters from places where the
/// surface crossed itself.
vtkPalpateSurface WithoutSpecks(const vtkPalpateSurface& surface)
{
  int count = 0;
  const auto part = vtkPalpateConnectedParts(surface, count);
  std::vector<std::vector<vtkIdType>> triangles(count);
  for (std::size_t i = 0; i < part.size(); ++i)
  {
    triangles[part[i]].push_back(static_cast<vtkIdType>(i));
  }
  std::vector<vtkIdType> kept;
  for (const auto& ids : triangles)
  {
    if (std::abs(vtkPalpateVolume(vtkPalpateSubset(surface, ids))) > 1)
    {
      kept.insert(kept.end(), ids.begin(), ids.end());
    }
  }
  std::sort(kept.begin(), kept.end());
  return vtkPalpateSubset(surface, kept);
}

/// Improves the shape of the triangles, if the surface then has no faults.
/// @returns Whether it has none.
bool Relax(vtkPalpateSurface& surface, const vtkPalpateSurface& shape)
{
  auto faults = vtkPalpateCheckSurface(surface);
  const bool clean = faults.None();
  faults.IntersectingPairs.clear();
  faults.FlatTriangles.clear();
  if (!faults.None())
  {
    return false;
  }
  auto relaxed = surface;
  vtkPalpateRelaxSurface(relaxed, shape);
  if (vtkPalpateCheckSurface(relaxed).None())
  {
    surface = std::move(relaxed);
    return true;
  }
  return clean;
}

vtkPalpateSurface Decimated(vtkPolyData* surface, double wanted, bool regular)
{
  vtkNew<vtkQuadricDecimation> decimate;
  decimate->SetInputData(surface);
  decimate->SetTargetReduction(1 - wanted / static_cast<double>(surface->GetNumberOfPolys()));
  decimate->VolumePreservationOn();
  decimate->SetRegularize(regular);
  decimate->Update();
  return vtkPalpateSurfaceFromPolyData(decimate->GetOutput());
}

/// The surface with about so many well-shaped triangles; with more if fewer do not make a good
/// surface.
vtkPalpateSurface Thinned(
  const vtkPalpateSurface& surface, vtkIdType wanted, const vtkPalpateShareDone& progress)
{
  const auto polydata = vtkPalpateSurfaceToPolyData(surface);
  const auto count = static_cast<double>(surface.Triangles.size());
  constexpr double worth_it = 0.9;
  constexpr double growth = 1.5;
  for (double target = static_cast<double>(wanted); target < worth_it * count; target *= growth)
  {
    // Regular decimation keeps flat parts from ending in splinters. Either may tear the surface at
    // a crease, seldom both.
    for (const bool regular : { true, false })
    {
      auto thinned = Decimated(polydata, target, regular);
      if (Relax(thinned, surface))
      {
        return thinned;
      }
    }
    progress(0.7 + 0.3 * target / count);
  }
  auto result = surface;
  Relax(result, surface);
  return result;
}
}

vtkPalpateSurface vtkPalpateResampleSurface(
  const vtkPalpateSurface& surface, const vtkPalpateResampleOptions& options)
{
  const vtkPalpateShareDone progress = options.Progress ? options.Progress : [](double) {};
  const Grid grid(surface, options.Resolution);

  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(SignedDistance(surface, grid, progress));
  contour->SetValue(0, 0.0);
  contour->ComputeNormalsOff();
  contour->ComputeGradientsOff();
  contour->ComputeScalarsOff();
  contour->Update();
  if (contour->GetOutput()->GetNumberOfPolys() == 0)
  {
    return {};
  }
  auto result = WithoutSpecks(vtkPalpateSurfaceFromPolyData(contour->GetOutput()));
  progress(0.7);
  if (options.Triangles > 0)
  {
    result = Thinned(result, options.Triangles, progress);
  }
  if (vtkPalpateVolume(result) < 0)
  {
    for (auto& triangle : result.Triangles)
    {
      std::swap(triangle[1], triangle[2]);
    }
  }
  for (auto& point : result.Points)
  {
    for (int i = 0; i < 3; ++i)
    {
      point[i] = grid.Origin[i] + grid.Step * point[i];
    }
  }
  progress(1);
  return result;
}
