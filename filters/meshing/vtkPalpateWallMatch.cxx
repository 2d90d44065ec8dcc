// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateWallMatch.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "mesh/box_tree.h"
#include "vtkMath.h"
#include "vtkPalpateSeparateSurfaces.h"

namespace
{
using Box = palpate::BoxTree::Box;
using palpate::Vec3;
using Edge = std::array<vtkIdType, 2>;
using Triangle = std::array<vtkIdType, 3>;

/// The points of two segments that are nearest to each other (Ericson, Real-Time Collision
/// Detection, 2005, 5.1.9). VTK's take short segments for parallel.
std::array<Vec3, 2> NearestOnSegments(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& w)
{
  const Vec3 d = q - p;
  const Vec3 e = w - r;
  const Vec3 between = p - r;
  const double dd = d.dot(d);
  const double ee = e.dot(e);
  const double de = d.dot(e);
  const double db = d.dot(between);
  const double eb = e.dot(between);
  const double determinant = dd * ee - de * de;
  double s = determinant > 0 ? std::clamp((de * eb - db * ee) / determinant, 0., 1.) : 0;
  double t = (de * s + eb) / ee;
  if (t < 0 || t > 1)
  {
    t = std::clamp(t, 0., 1.);
    s = std::clamp((t * de - db) / dd, 0., 1.);
  }
  return { p + s * d, r + t * e };
}

/// Triangles that are cut while they are matched.
class Matcher
{
public:
  Matcher(const vtkPalpateSurface& surfaces, double tolerance)
    : Given(surfaces)
    , Tolerance(tolerance)
    , Points(surfaces.Points)
    , Incident(surfaces.Points.size())
    , Alias(surfaces.Points.size())
  {
    std::iota(Alias.begin(), Alias.end(), vtkIdType{ 0 });
    const auto group = vtkPalpateSeparateSurfaces(surfaces);
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < surfaces.Triangles.size(); ++i)
    {
      PiecesOfRoot.emplace_back();
      const auto source = static_cast<vtkIdType>(i);
      this->Add({ surfaces.Triangles[i], group[i],
        surfaces.Tissues.empty() ? -1 : surfaces.Tissues[i], source, source });
      boxes.push_back(this->BoxOf(surfaces.Triangles[i]));
      Count = std::max(Count, group[i] + 1);
    }
    Tree.emplace(boxes);
  }

  vtkPalpateMatchedWalls Match()
  {
    for (int group = 1; group < Count; ++group)
    {
      Current = group;
      this->FindReach();
      this->Outline();
      if (this->HasTooManyPieces())
      {
        break;
      }
      this->Replace();
    }
    vtkPalpateMatchedWalls result;
    result.IsGivenUp = this->HasTooManyPieces();
    if (result.IsGivenUp || !this->AreClosedAsBefore())
    {
      result.Surfaces = Given;
      return result;
    }
    result.Replaced = Replaced;
    result.Moved = Moved;
    result.Place = Place;
    result.Surfaces.Points = Points;
    std::vector<const Piece*> left;
    for (const Piece& piece : Pieces)
    {
      if (piece.State == Here)
      {
        left.push_back(&piece);
      }
    }
    std::stable_sort(left.begin(), left.end(),
      [](const Piece* a, const Piece* b) { return a->Source < b->Source; });
    for (const Piece* piece : left)
    {
      result.Surfaces.Triangles.push_back(piece->Corners);
      result.Surfaces.Parts.push_back(piece->Group);
      if (!Given.Tissues.empty())
      {
        result.Surfaces.Tissues.push_back(piece->Tissue);
      }
    }
    return result;
  }

private:
  enum States
  {
    Here,
    Cut,     ///< into others
    Matched, ///< by triangles of the other surface
  };
  struct Piece
  {
    Triangle Corners;
    int Group;
    int Tissue;
    vtkIdType Source; ///< the triangle of the input
    vtkIdType Root;   ///< that in whose box it lies
    States State = Here;
  };
  struct Nearest
  {
    vtkIdType Piece = -1;
    palpate::OnTriangle At;
  };

  /// Whether there are more pieces than an outline asks for, since a wall gets new points along its
  /// outline alone. Then the tolerance is larger than details which it has to keep apart, or the
  /// surfaces cross each other.
  bool HasTooManyPieces() const
  {
    constexpr std::size_t of_each = 2;
    constexpr std::size_t at_least = 10000;
    return Pieces.size() >= at_least + of_each * Given.Triangles.size();
  }

  Vec3 At(vtkIdType id) const { return Vec3(Points[id].data()); }

  void Move(vtkIdType id, const Vec3& x)
  {
    Moved = std::max(Moved, (x - this->At(id)).norm());
    Points[id] = { x[0], x[1], x[2] };
  }

  Box BoxOf(const Triangle& triangle) const
  {
    Box box;
    for (const vtkIdType id : triangle)
    {
      box.extend(this->At(id));
    }
    return this->Inflated(box);
  }
  /// Points move by the tolerance while boxes stay.
  Box Inflated(const Box& box) const
  {
    const Vec3 margin = Vec3::Constant(2 * Tolerance);
    return { box.min() - margin, box.max() + margin };
  }

  void Add(const Piece& piece)
  {
    const auto id = static_cast<vtkIdType>(Pieces.size());
    Pieces.push_back(piece);
    const auto add_to = [&](std::vector<vtkIdType>& list)
    {
      // Before a full list is enlarged, remove pieces that were cut, so that the time grows as the
      // number of pieces does.
      if (list.size() == list.capacity())
      {
        list.erase(std::remove_if(list.begin(), list.end(),
                     [this](vtkIdType other) { return Pieces[other].State == Cut; }),
          list.end());
      }
      list.push_back(id);
    };
    add_to(PiecesOfRoot[piece.Root]);
    for (const vtkIdType corner : piece.Corners)
    {
      add_to(Incident[corner]);
    }
  }

  vtkIdType AddPoint(const Vec3& x)
  {
    Points.push_back({ x[0], x[1], x[2] });
    Incident.emplace_back();
    Alias.push_back(static_cast<vtkIdType>(Alias.size()));
    return Alias.back();
  }

  vtkIdType Resolved(vtkIdType id) const
  {
    while (Alias[id] != id)
    {
      id = Alias[id];
    }
    return id;
  }

  /// Whether a piece is of the surface that is being matched (`late`), or of one before it.
  bool IsOf(const Piece& piece, bool late) const
  {
    return late ? piece.Group == Current : piece.Group < Current;
  }

  /// Calls `visit` with the id of each piece that may be near a box. It may return true to end.
  template <class Visit>
  void ForNear(const Box& box, bool late, States state, Visit&& visit) const
  {
    bool ended = false;
    Tree->for_overlapping(this->Inflated(box),
      [&](palpate::Index place)
      {
        for (const vtkIdType id : PiecesOfRoot[Tree->order()[place]])
        {
          const Piece& piece = Pieces[id];
          if (!ended && piece.State == state && this->IsOf(piece, late) &&
            this->BoxOf(piece.Corners).intersects(box))
          {
            ended = visit(id);
          }
        }
      });
  }

  /// The nearest of one side's pieces within the tolerance.
  Nearest NearestTo(const Vec3& x, bool late, States state = Here) const
  {
    Nearest nearest;
    nearest.At.squared_distance = Tolerance * Tolerance;
    this->ForNear(Box(x), late, state,
      [&](vtkIdType id)
      {
        const Triangle& t = Pieces[id].Corners;
        const auto at =
          palpate::nearest_on_triangle(this->At(t[0]), this->At(t[1]), this->At(t[2]), x);
        if (at.squared_distance <= nearest.At.squared_distance)
        {
          nearest = { id, at };
        }
        return false;
      });
    return nearest;
  }

  /// The largest distance of the middle, the corners and the middles of sides of a piece from the
  /// other side; infinity beyond the tolerance.
  double DistanceOf(const Piece& piece) const
  {
    const bool other = piece.Group != Current;
    const Vec3 a = this->At(piece.Corners[0]);
    const Vec3 b = this->At(piece.Corners[1]);
    const Vec3 c = this->At(piece.Corners[2]);
    double most = 0;
    for (const Vec3& x :
      std::array<Vec3, 7>{ (a + b + c) / 3, a, b, c, (a + b) / 2, (b + c) / 2, (c + a) / 2 })
    {
      const auto nearest = this->NearestTo(x, other);
      if (nearest.Piece < 0)
      {
        return std::numeric_limits<double>::infinity();
      }
      most = std::max(most, std::sqrt(nearest.At.squared_distance));
    }
    return most;
  }

  bool HasEdge(vtkIdType a, vtkIdType b, bool late) const
  {
    return std::any_of(Incident[a].begin(), Incident[a].end(),
      [&](vtkIdType id)
      {
        const Piece& piece = Pieces[id];
        return piece.State == Here && this->IsOf(piece, late) && Has(piece, b);
      });
  }
  bool HasCorner(vtkIdType a, bool late) const
  {
    return std::any_of(Incident[a].begin(), Incident[a].end(),
      [&](vtkIdType id) { return Pieces[id].State == Here && this->IsOf(Pieces[id], late); });
  }
  static bool Has(const Piece& piece, vtkIdType corner)
  {
    return std::find(piece.Corners.begin(), piece.Corners.end(), corner) != piece.Corners.end();
  }

  /// Cuts all triangles at the edge in two. One whose third corner it is shrinks to its other
  /// sides.
  void SplitEdge(vtkIdType a, vtkIdType b, vtkIdType x)
  {
    const auto around = Incident[a];
    for (const vtkIdType id : around)
    {
      if (Pieces[id].State != Here || !Has(Pieces[id], b))
      {
        continue;
      }
      Pieces[id].State = Cut;
      if (Has(Pieces[id], x))
      {
        continue;
      }
      for (const vtkIdType end : { a, b })
      {
        Piece half = Pieces[id];
        half.State = Here;
        std::replace(half.Corners.begin(), half.Corners.end(), end, x);
        this->Add(half);
      }
    }
  }

  /// Cuts all triangles on the same three points in three.
  void SplitFace(vtkIdType id, vtkIdType x)
  {
    const Triangle corners = Pieces[id].Corners;
    const auto around = Incident[corners[0]];
    for (const vtkIdType other : around)
    {
      if (Pieces[other].State != Here || !Has(Pieces[other], corners[1]) ||
        !Has(Pieces[other], corners[2]))
      {
        continue;
      }
      Pieces[other].State = Cut;
      for (const vtkIdType corner : corners)
      {
        Piece third = Pieces[other];
        third.State = Here;
        std::replace(third.Corners.begin(), third.Corners.end(), corner, x);
        this->Add(third);
      }
    }
  }

  void Merge(vtkIdType from, vtkIdType to)
  {
    Moved = std::max(Moved, (this->At(from) - this->At(to)).norm());
    Alias[from] = to;
    const auto around = Incident[from];
    for (const vtkIdType id : around)
    {
      Piece& piece = Pieces[id];
      if (piece.State != Here)
      {
        continue;
      }
      if (Has(piece, to))
      {
        piece.State = Cut;
        continue;
      }
      std::replace(piece.Corners.begin(), piece.Corners.end(), from, to);
      Incident[to].push_back(id);
    }
    Incident[from].clear();
  }

  /// Draws a point into the other side, if it lies on that. @returns whether anything changed.
  bool DrawPoint(vtkIdType x, bool late)
  {
    const bool other = !late;
    if (this->HasCorner(x, other))
    {
      return false;
    }
    const Nearest nearest = this->NearestTo(this->At(x), other);
    if (nearest.Piece < 0)
    {
      return false;
    }
    const Triangle t = Pieces[nearest.Piece].Corners;
    const vtkIdType corner = *std::min_element(t.begin(), t.end(),
      [&](vtkIdType p, vtkIdType q)
      { return (this->At(p) - this->At(x)).norm() < (this->At(q) - this->At(x)).norm(); });
    if ((this->At(corner) - this->At(x)).norm() <= Tolerance)
    {
      late ? this->Merge(x, corner) : this->Merge(corner, x);
      return true;
    }
    for (int i = 0; i < 3; ++i)
    {
      const vtkIdType a = t[i];
      const vtkIdType b = t[(i + 1) % 3];
      const Vec3 on = this->OnSegment(a, b, this->At(x));
      if ((on - this->At(x)).norm() <= Tolerance)
      {
        if (late)
        {
          this->Move(x, on);
        }
        this->SplitEdge(a, b, x);
        return true;
      }
    }
    if (late)
    {
      this->Move(x, nearest.At.point);
    }
    this->SplitFace(nearest.Piece, x);
    return true;
  }

  Vec3 OnSegment(vtkIdType a, vtkIdType b, const Vec3& x) const
  {
    const Vec3 along = this->At(b) - this->At(a);
    const double t = std::clamp(along.dot(x - this->At(a)) / along.squaredNorm(), 0., 1.);
    return this->At(a) + t * along;
  }
  bool IsFarFrom(const Vec3& x, vtkIdType a, vtkIdType b) const
  {
    return (x - this->At(a)).norm() > Tolerance && (x - this->At(b)).norm() > Tolerance;
  }

  /// The first corner of the other side that lies on the edge between its ends.
  vtkIdType CornerOn(vtkIdType a, vtkIdType b, bool other) const
  {
    vtkIdType found = -1;
    this->ForNear(this->BoxOfEdge(a, b), other, Here,
      [&](vtkIdType id)
      {
        for (const vtkIdType c : Pieces[id].Corners)
        {
          const Vec3 x = this->At(c);
          if (c != a && c != b && this->IsFarFrom(x, a, b) &&
            (this->OnSegment(a, b, x) - x).norm() <= Tolerance)
          {
            found = c;
          }
        }
        return found >= 0;
      });
    return found;
  }

  struct Crossing
  {
    Edge Other;
    Vec3 OnOwn, OnOther;
  };
  /// The first edge of the other side that crosses the edge.
  std::optional<Crossing> EdgeAcross(vtkIdType a, vtkIdType b, bool other) const
  {
    std::optional<Crossing> found;
    this->ForNear(this->BoxOfEdge(a, b), other, Here,
      [&](vtkIdType id)
      {
        const Triangle& t = Pieces[id].Corners;
        for (int i = 0; i < 3 && !found; ++i)
        {
          const vtkIdType c = t[i];
          const vtkIdType d = t[(i + 1) % 3];
          if (c == a || c == b || d == a || d == b)
          {
            continue;
          }
          const auto [own, others] =
            NearestOnSegments(this->At(a), this->At(b), this->At(c), this->At(d));
          const double squared = (own - others).squaredNorm();
          if (squared <= Tolerance * Tolerance && this->IsFarFrom(own, a, b) &&
            this->IsFarFrom(others, c, d))
          {
            found = Crossing{ { c, d }, own, others };
          }
        }
        return found.has_value();
      });
    return found;
  }

  Box BoxOfEdge(vtkIdType a, vtkIdType b) const
  {
    Box box(this->At(a));
    box.extend(this->At(b));
    return box;
  }

  /// Draws an edge into the other side, as far as it lies on that.
  bool DrawEdge(const Edge& edge, bool late)
  {
    const bool other = !late;
    bool changed = false;
    std::vector<Edge> waiting = { edge };
    while (!waiting.empty() && !this->HasTooManyPieces())
    {
      const vtkIdType a = this->Resolved(waiting.back()[0]);
      const vtkIdType b = this->Resolved(waiting.back()[1]);
      waiting.pop_back();
      if (a == b || !this->HasEdge(a, b, late) || this->HasEdge(a, b, other))
      {
        continue;
      }
      vtkIdType x = this->CornerOn(a, b, other);
      if (x >= 0)
      {
        if (!late)
        {
          this->Move(x, this->OnSegment(a, b, this->At(x)));
        }
        this->SplitEdge(a, b, x);
      }
      else if (const auto crossing = this->EdgeAcross(a, b, other))
      {
        x = this->AddPoint(late ? crossing->OnOther : crossing->OnOwn);
        this->SplitEdge(a, b, x);
        this->SplitEdge(crossing->Other[0], crossing->Other[1], x);
      }
      else
      {
        continue;
      }
      changed = true;
      waiting.push_back({ a, x });
      waiting.push_back({ x, b });
    }
    return changed;
  }

  /// The box in which the surface can touch those before it.
  void FindReach()
  {
    Box early, late;
    for (const Piece& piece : Pieces)
    {
      if (piece.State == Here && piece.Group <= Current)
      {
        (piece.Group == Current ? late : early).extend(this->BoxOf(piece.Corners));
      }
    }
    Reach = early.intersection(late);
  }

  /// The edges of one side's pieces that do not lie on the other as a whole.
  std::set<Edge> EdgesOf(bool late) const
  {
    std::set<Edge> edges;
    for (const Piece& piece : Pieces)
    {
      if (piece.State != Here || !this->IsOf(piece, late) ||
        !Reach.intersects(this->BoxOf(piece.Corners)) || std::isfinite(this->DistanceOf(piece)))
      {
        continue;
      }
      for (int i = 0; i < 3; ++i)
      {
        const auto [low, high] = std::minmax(piece.Corners[i], piece.Corners[(i + 1) % 3]);
        edges.insert({ low, high });
      }
    }
    return edges;
  }

  /// Draws the outline of the contact into both sides.
  void Outline()
  {
    if (Reach.isEmpty())
    {
      return;
    }
    // An edge that is drawn cuts triangles, whose other sides are then edges of the outline too.
    constexpr int most_rounds = 6;
    bool changed = true;
    for (int round = 0; round < most_rounds && changed && !this->HasTooManyPieces(); ++round)
    {
      changed = false;
      for (const bool late : { false, true })
      {
        const auto edges = this->EdgesOf(late);
        for (const Edge& edge : edges)
        {
          if (this->HasTooManyPieces())
          {
            return;
          }
          for (const vtkIdType end : edge)
          {
            changed = this->DrawPoint(this->Resolved(end), late) || changed;
          }
        }
        for (const Edge& edge : edges)
        {
          changed = this->DrawEdge(edge, late) || changed;
        }
      }
    }
  }

  /// Replaces pieces that lie on earlier surfaces by the triangles of these.
  void Replace()
  {
    std::vector<vtkIdType> on;
    for (std::size_t i = 0; i < Pieces.size(); ++i)
    {
      if (Pieces[i].State != Here || Pieces[i].Group != Current ||
        !Reach.intersects(this->BoxOf(Pieces[i].Corners)))
      {
        continue;
      }
      const double distance = this->DistanceOf(Pieces[i]);
      if (std::isfinite(distance))
      {
        Moved = std::max(Moved, distance);
        on.push_back(static_cast<vtkIdType>(i));
      }
    }
    for (const vtkIdType id : on)
    {
      Pieces[id].State = Matched;
      ++Replaced;
    }
    if (on.empty())
    {
      return;
    }
    const Triangle& first = Pieces[on.front()].Corners;
    const Vec3 place = (this->At(first[0]) + this->At(first[1]) + this->At(first[2])) / 3;
    Place = { place[0], place[1], place[2] };
    std::set<Triangle> known;
    const auto count = Pieces.size();
    for (std::size_t i = 0; i < count; ++i)
    {
      const Piece& piece = Pieces[i];
      if (piece.State != Here || piece.Group >= Current ||
        !Reach.intersects(this->BoxOf(piece.Corners)))
      {
        continue;
      }
      const Triangle& t = piece.Corners;
      const Vec3 middle = (this->At(t[0]) + this->At(t[1]) + this->At(t[2])) / 3;
      const Nearest nearest = this->NearestTo(middle, true, Matched);
      Triangle key = t;
      std::sort(key.begin(), key.end());
      if (nearest.Piece < 0 || !known.insert(key).second)
      {
        continue;
      }
      const Piece& matched = Pieces[nearest.Piece];
      Piece copy = matched;
      copy.Corners = t;
      copy.Root = piece.Root;
      copy.State = Here;
      if (this->NormalOf(t).dot(this->NormalOf(matched.Corners)) < 0)
      {
        std::swap(copy.Corners[1], copy.Corners[2]);
      }
      this->Add(copy);
    }
  }

  /// The surfaces that have open edges.
  template <class Triangles, class Group>
  std::set<int> OpenSurfaces(const Triangles& triangles, Group&& group_of) const
  {
    std::map<std::pair<int, Edge>, int> uses;
    for (std::size_t i = 0; i < triangles.size(); ++i)
    {
      for (int k = 0; k < 3; ++k)
      {
        const auto [low, high] = std::minmax(triangles[i][k], triangles[i][(k + 1) % 3]);
        ++uses[{ group_of(i), Edge{ low, high } }];
      }
    }
    std::set<int> open;
    for (const auto& [edge, count] : uses)
    {
      if (count == 1)
      {
        open.insert(edge.first);
      }
    }
    return open;
  }

  /// Whether no surface has new open edges, which appear if outlines did not meet within the
  /// tolerance.
  bool AreClosedAsBefore() const
  {
    const auto before =
      this->OpenSurfaces(Given.Triangles, [this](std::size_t i) { return Pieces[i].Group; });
    std::vector<Triangle> triangles;
    std::vector<int> groups;
    for (const Piece& piece : Pieces)
    {
      if (piece.State == Here)
      {
        triangles.push_back(piece.Corners);
        groups.push_back(piece.Group);
      }
    }
    const auto after =
      this->OpenSurfaces(triangles, [&groups](std::size_t i) { return groups[i]; });
    return std::includes(before.begin(), before.end(), after.begin(), after.end());
  }

  Vec3 NormalOf(const Triangle& t) const
  {
    return (this->At(t[1]) - this->At(t[0])).cross(this->At(t[2]) - this->At(t[0]));
  }

  const vtkPalpateSurface& Given;
  const double Tolerance;
  std::vector<vtkPalpatePoint> Points;
  std::vector<std::vector<vtkIdType>> Incident; ///< pieces at each point
  std::vector<vtkIdType> Alias;                 ///< the point that each became
  std::vector<Piece> Pieces;
  std::vector<std::vector<vtkIdType>> PiecesOfRoot;
  std::optional<palpate::BoxTree> Tree; ///< of the input's triangles
  int Count = 0;                        ///< surfaces
  int Current = 0;
  Box Reach;
  vtkIdType Replaced = 0;
  double Moved = 0;
  vtkPalpatePoint Place = {};
};
}

vtkPalpateMatchedWalls vtkPalpateMatchWalls(const vtkPalpateSurface& surfaces, double tolerance)
{
  return Matcher(surfaces, tolerance).Match();
}
