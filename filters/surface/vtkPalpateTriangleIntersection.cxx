// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTriangleIntersection.h"

#include <algorithm>
#include <vector>

#include "mesh/box_tree.h"
#include "vtkSMPThreadLocal.h"
#include "vtkSMPTools.h"

namespace
{
using Point = vtkPalpatePoint;

/// An axis along which the triangle does not look like a line, or −1 if it has no area.
int ViewAxis(const Point& a, const Point& b, const Point& c)
{
  const auto normal = vtkPalpateNormal(a, b, c);
  std::array<int, 3> axes = { 0, 1, 2 };
  std::sort(axes.begin(), axes.end(),
    [&normal](int i, int j) { return std::abs(normal[i]) > std::abs(normal[j]); });
  for (const int axis : axes)
  {
    if (vtkPalpateOrient2D(a, b, c, axis) != 0)
    {
      return axis;
    }
  }
  return -1;
}

/// Whether x, on the line through p and q, lies between them.
bool Between(const Point& p, const Point& q, const Point& x, int axis)
{
  for (const int i : { (axis + 1) % 3, (axis + 2) % 3 })
  {
    if (x[i] < std::min(p[i], q[i]) || x[i] > std::max(p[i], q[i]))
    {
      return false;
    }
  }
  return true;
}

bool SegmentsMeet(const Point& p, const Point& q, const Point& a, const Point& b, int axis)
{
  const int a_side = vtkPalpateOrient2D(p, q, a, axis);
  const int b_side = vtkPalpateOrient2D(p, q, b, axis);
  const int p_side = vtkPalpateOrient2D(a, b, p, axis);
  const int q_side = vtkPalpateOrient2D(a, b, q, axis);
  if (a_side * b_side < 0 && p_side * q_side < 0)
  {
    return true;
  }
  return (a_side == 0 && Between(p, q, a, axis)) || (b_side == 0 && Between(p, q, b, axis)) ||
    (p_side == 0 && Between(a, b, p, axis)) || (q_side == 0 && Between(a, b, q, axis));
}

bool CoplanarSegmentMeetsTriangle(
  const Point& p, const Point& q, const Point& a, const Point& b, const Point& c)
{
  const int axis = ViewAxis(a, b, c);
  const int turn = vtkPalpateOrient2D(a, b, c, axis);
  if (turn * vtkPalpateOrient2D(a, b, p, axis) >= 0 &&
    turn * vtkPalpateOrient2D(b, c, p, axis) >= 0 && turn * vtkPalpateOrient2D(c, a, p, axis) >= 0)
  {
    return true;
  }
  return SegmentsMeet(p, q, a, b, axis) || SegmentsMeet(p, q, b, c, axis) ||
    SegmentsMeet(p, q, c, a, axis);
}

bool SegmentMeetsTriangle(
  const Point& p, const Point& q, const Point& a, const Point& b, const Point& c)
{
  const int p_side = vtkPalpateOrient3D(a, b, c, p);
  const int q_side = vtkPalpateOrient3D(a, b, c, q);
  if (p_side * q_side > 0)
  {
    return false;
  }
  if (p_side == 0 && q_side == 0)
  {
    return CoplanarSegmentMeetsTriangle(p, q, a, b, c);
  }
  const int ab = vtkPalpateOrient3D(p, q, a, b);
  const int bc = vtkPalpateOrient3D(p, q, b, c);
  const int ca = vtkPalpateOrient3D(p, q, c, a);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

/// The corners of a triangle, those that it shares with another one first.
struct Corners
{
  std::array<vtkIdType, 3> Ids;
  int Shared = 0;

  Corners(const std::array<vtkIdType, 3>& ids, const std::array<vtkIdType, 3>& other)
    : Ids(ids)
  {
    const auto end = std::stable_partition(Ids.begin(), Ids.end(),
      [&other](vtkIdType id) { return std::find(other.begin(), other.end(), id) != other.end(); });
    Shared = static_cast<int>(end - Ids.begin());
  }
};

std::vector<palpate::BoxTree::Box> BoxesOf(const vtkPalpateSurface& surface)
{
  std::vector<palpate::BoxTree::Box> boxes;
  boxes.reserve(surface.Triangles.size());
  for (const auto& triangle : surface.Triangles)
  {
    auto& box = boxes.emplace_back();
    for (const vtkIdType point : triangle)
    {
      box.extend(palpate::Vec3(surface.Points[point].data()));
    }
  }
  return boxes;
}
}

bool vtkPalpateTrianglesIntersect(
  const vtkPalpateSurface& surface, vtkIdType first, vtkIdType second)
{
  const Corners s(surface.Triangles[first], surface.Triangles[second]);
  const Corners t(surface.Triangles[second], surface.Triangles[first]);
  const auto& points = surface.Points;
  const Point &a = points[s.Ids[0]], &b = points[s.Ids[1]], &c = points[s.Ids[2]];
  const Point &d = points[t.Ids[0]], &e = points[t.Ids[1]], &f = points[t.Ids[2]];
  switch (s.Shared)
  {
    case 0:
      return SegmentMeetsTriangle(a, b, d, e, f) || SegmentMeetsTriangle(b, c, d, e, f) ||
        SegmentMeetsTriangle(c, a, d, e, f) || SegmentMeetsTriangle(d, e, a, b, c) ||
        SegmentMeetsTriangle(e, f, a, b, c) || SegmentMeetsTriangle(f, d, a, b, c);
    case 1:
      // What they have in common is convex and holds the shared corner: if there is more, it leaves
      // one of the two triangles through the edge opposite to that corner.
      return SegmentMeetsTriangle(b, c, d, e, f) || SegmentMeetsTriangle(e, f, a, b, c);
    case 2:
    {
      // One folded flat onto the other.
      if (vtkPalpateOrient3D(a, b, c, f) != 0)
      {
        return false;
      }
      const int axis = ViewAxis(a, b, c);
      return vtkPalpateOrient2D(a, b, c, axis) == vtkPalpateOrient2D(a, b, f, axis);
    }
    default:
      return true;
  }
}

std::vector<std::array<vtkIdType, 2>> vtkPalpateIntersectingTriangles(
  const vtkPalpateSurface& surface)
{
  const auto count = static_cast<vtkIdType>(surface.Triangles.size());
  std::vector<char> has_area(surface.Triangles.size());
  for (vtkIdType i = 0; i < count; ++i)
  {
    const auto& t = surface.Triangles[i];
    has_area[i] = ViewAxis(surface.Points[t[0]], surface.Points[t[1]], surface.Points[t[2]]) >= 0;
  }

  const std::vector<palpate::BoxTree::Box> boxes = BoxesOf(surface);
  const palpate::BoxTree tree(boxes);
  vtkSMPThreadLocal<std::vector<std::array<vtkIdType, 2>>> found;
  vtkSMPTools::For(0, count,
    [&](vtkIdType begin, vtkIdType end)
    {
      auto& pairs = found.Local();
      for (vtkIdType i = begin; i < end; ++i)
      {
        tree.for_overlapping(boxes[i],
          [&, i](palpate::Index place)
          {
            const vtkIdType j = tree.order()[place];
            if (j > i && has_area[i] && has_area[j] && boxes[i].intersects(boxes[j]) &&
              vtkPalpateTrianglesIntersect(surface, i, j))
            {
              pairs.push_back({ i, j });
            }
          });
      }
    });
  std::vector<std::array<vtkIdType, 2>> result;
  for (const auto& pairs : found)
  {
    result.insert(result.end(), pairs.begin(), pairs.end());
  }
  std::sort(result.begin(), result.end());
  return result;
}
