// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateDisplaySurface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/memory_error.h"
#include "base/quantity.h"
#include "mesh/surface_embedding.h"
#include "schedule/communicator.h"
#include "state_space/split_surface.h"
#include "vtkBoundingBox.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeSurface.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStaticPointLocator.h"
#include "vtkTriangleFilter.h"

namespace
{
using palpate::Index;
using palpate::Vec3;

/// How far off the body half of the points of a surface may be, and how far all of them without a
/// warning, as shares of the body's diagonal.
constexpr double MostHalf = 0.05;
constexpr double MostSilent = 0.05;
/// Points at one place are one where normals are computed, unless the normals that they came with
/// differ by more than this angle: there the surface has an edge.
const double CosineOfEdge = std::cos(30 * 3.14159265358979323846 / 180);
/// How far from the sheet of a cut a point of the surface looks for the side that it follows, as a
/// share of the body's diagonal.
constexpr double BesideCut = 0.002;
/// Sizes of a surface and a body that differ by this factor, to 20 %, are in mm and in m.
constexpr double Thousand = 1000;

double DiagonalOf(const std::vector<Vec3>& points)
{
  vtkBoundingBox box;
  for (const Vec3& point : points)
  {
    box.AddPoint(point[0], point[1], point[2]);
  }
  return box.GetDiagonalLength();
}

std::vector<Vec3> PointsOf(vtkPolyData* surface)
{
  std::vector<Vec3> points(static_cast<std::size_t>(surface->GetNumberOfPoints()));
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    surface->GetPoint(static_cast<vtkIdType>(p), points[p].data());
    if (!points[p].allFinite())
    {
      throw palpate::InputError("Point " + std::to_string(p) +
        " of the display surface is not finite. Take it out, as with Clean.");
    }
  }
  return points;
}

/// The first of the points at each point's place whose normal is alike, and which is on the same
/// side of a cut [points]. @param onSide The first points, moved to their side; the others are
/// alone.
std::vector<vtkIdType> FirstAtPlace(
  const std::vector<Vec3>& points, vtkDataArray* normals, const std::vector<Vec3>& onSide)
{
  std::map<std::array<double, 3>, std::vector<vtkIdType>> atPlace;
  std::vector<vtkIdType> first;
  for (vtkIdType p = 0; p < static_cast<vtkIdType>(points.size()); ++p)
  {
    if (p >= static_cast<vtkIdType>(onSide.size()))
    {
      first.push_back(p);
      continue;
    }
    const Vec3& x = onSide[static_cast<std::size_t>(p)];
    auto& here = atPlace[{ x[0], x[1], x[2] }];
    const auto same = std::find_if(here.begin(), here.end(),
      [&](vtkIdType other)
      {
        return !normals ||
          Vec3(normals->GetTuple3(p))
            .normalized()
            .dot(Vec3(normals->GetTuple3(other)).normalized()) >= CosineOfEdge;
      });
    first.push_back(same == here.end() ? p : *same);
    if (same == here.end())
    {
      here.push_back(p);
    }
  }
  return first;
}
}

struct vtkPalpateDisplaySurface::Embedded
{
  Embedded(vtkPolyData* surface, const Carrier& carrier)
  {
    this->Shown->ShallowCopy(surface);
    std::vector<Vec3> embedded = PointsOf(surface);
    if (!carrier.Surface.stages_of_cut.empty())
    {
      embedded = this->Split(surface, embedded, carrier.Surface);
    }
    this->Points = PointsOf(this->Shown);
    this->Embedding = std::make_unique<palpate::SurfaceEmbedding>(
      carrier.Surface.points, carrier.Surface.touched_triangles(), embedded);
    const std::vector<vtkIdType> first =
      FirstAtPlace(this->Points, this->Shown->GetPointData()->GetNormals(), embedded);
    this->Rest.resize(3 * static_cast<Eigen::Index>(this->Points.size()));
    for (std::size_t p = 0; p < this->Points.size(); ++p)
    {
      this->Rest.segment<3>(3 * static_cast<Eigen::Index>(p)) = this->Points[p].cast<float>();
    }
    // Its own normals are those at rest.
    if (vtkDataArray* normals = this->Shown->GetPointData()->GetNormals())
    {
      this->Shown->GetPointData()->RemoveArray(normals->GetName());
    }
    std::map<vtkIdType, vtkIdType> places;
    for (const vtkIdType p : first)
    {
      this->PlaceOfNormal.push_back(
        places.try_emplace(p, static_cast<vtkIdType>(places.size())).first->second);
    }
    this->NumberOfNormals = places.size();
    vtkIdType count;
    const vtkIdType* ids;
    for (vtkCellArray* polys = this->Shown->GetPolys(); polys->GetNextCell(count, ids);)
    {
      this->Triangles.push_back({ ids[0], ids[1], ids[2] });
    }
  }

  /// Where the body was meshed, m.
  std::vector<Vec3> Points;
  std::unique_ptr<palpate::SurfaceEmbedding> Embedding;
  /// The points of the carrier that the last points are, which are those of the sides of a cut.
  std::vector<Index> OfSides;
  /// Where displacements count from [3 points], m.
  Eigen::VectorXf Rest;
  /// The surface with its arrays, as it came, and with what is added where it is cut.
  vtkNew<vtkPolyData> Shown;
  std::vector<std::array<vtkIdType, 3>> Triangles;
  /// Points at one place share a normal: the place of that of each point among all.
  std::vector<vtkIdType> PlaceOfNormal;
  std::size_t NumberOfNormals = 0;

  /// Splits the surface along the cut of the carrier, and adds the sides of that.
  /// @param given The places of its points.
  /// @return Where each point looks for what it follows, without those of the sides.
  std::vector<Vec3> Split(
    vtkPolyData* surface, const std::vector<Vec3>& given, const palpate::Surface& carrier)
  {
    std::vector<std::array<Index, 3>> triangles;
    vtkIdType count;
    const vtkIdType* ids;
    for (vtkCellArray* polys = surface->GetPolys(); polys->GetNextCell(count, ids);)
    {
      triangles.push_back(
        { static_cast<Index>(ids[0]), static_cast<Index>(ids[1]), static_cast<Index>(ids[2]) });
    }
    const double diagonal = DiagonalOf(carrier.points);
    palpate::SplitSurface split = palpate::split_surface(given, triangles,
      palpate::sheet_of_cut(carrier), MostSilent * diagonal, BesideCut * diagonal);

    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkPointData* from = surface->GetPointData();
    vtkPointData* arrays = this->Shown->GetPointData();
    arrays->Initialize();
    arrays->InterpolateAllocate(from);
    for (vtkIdType p = 0; p < surface->GetNumberOfPoints(); ++p)
    {
      arrays->CopyData(from, p, points->InsertNextPoint(surface->GetPoint(p)));
    }
    for (const auto& [a, b, share] : split.added)
    {
      const Vec3 x = given[a] + share * (given[b] - given[a]);
      arrays->InterpolateEdge(from, points->InsertNextPoint(x.data()), a, b, share);
    }
    vtkNew<vtkCellArray> polys;
    vtkCellData* ofCells = this->Shown->GetCellData();
    ofCells->Initialize();
    ofCells->CopyAllocate(surface->GetCellData());
    for (std::size_t t = 0; t < split.triangles.size(); ++t)
    {
      const auto& [a, b, c] = split.triangles[t];
      ofCells->CopyData(
        surface->GetCellData(), split.parents[t], polys->InsertNextCell({ a, b, c }));
    }
    // A triangle at each of the given points.
    std::vector<vtkIdType> cellAt(given.size(), 0);
    for (std::size_t t = 0; t < triangles.size(); ++t)
    {
      for (const Index corner : triangles[t])
      {
        cellAt[corner] = static_cast<vtkIdType>(t);
      }
    }
    // The sides look like what is nearest to them outside.
    vtkNew<vtkStaticPointLocator> locator;
    locator->SetDataSet(surface);
    locator->BuildLocator();
    std::map<Index, vtkIdType> number;
    for (auto t = static_cast<std::size_t>(carrier.num_touched()); t < carrier.triangles.size();
         ++t)
    {
      std::array<vtkIdType, 3> side;
      vtkIdType nearest = 0;
      for (int k = 0; k < 3; ++k)
      {
        const Index corner = carrier.triangles[t][k];
        const Vec3& x = carrier.points[corner];
        nearest = locator->FindClosestPoint(x.data());
        const auto [at, isNew] = number.try_emplace(corner, points->GetNumberOfPoints());
        if (isNew)
        {
          arrays->CopyData(from, nearest, points->InsertNextPoint(x.data()));
          this->OfSides.push_back(corner);
        }
        side[k] = at->second;
      }
      ofCells->CopyData(surface->GetCellData(), cellAt[nearest],
        polys->InsertNextCell({ side[0], side[1], side[2] }));
    }
    this->Shown->SetPoints(points);
    this->Shown->SetPolys(polys);
    return std::move(split.on_side);
  }

  /// The displacements of all points [3 points], m. @param u Those of the carrier.
  [[nodiscard]] Eigen::VectorXf Displacement(const Eigen::VectorXf& u) const
  {
    const Eigen::VectorXf outside = this->Embedding->displacement(u);
    if (this->OfSides.empty())
    {
      return outside;
    }
    Eigen::VectorXf all(static_cast<Eigen::Index>(3 * this->Points.size()));
    all.head(outside.size()) = outside;
    for (std::size_t i = 0; i < this->OfSides.size(); ++i)
    {
      all.segment<3>(outside.size() + 3 * static_cast<Eigen::Index>(i)) =
        u.segment<3>(3 * Eigen::Index{ this->OfSides[i] });
    }
    return all;
  }

  /// Adds normals to the surface. @param places Those of its points [3 points], m.
  void AddNormals(const Eigen::VectorXf& places, vtkPolyData* surface) const
  {
    Eigen::Matrix3Xf sums =
      Eigen::Matrix3Xf::Zero(3, static_cast<Eigen::Index>(this->NumberOfNormals));
    for (const auto& [a, b, c] : this->Triangles)
    {
      const Eigen::Vector3f origin = places.segment<3>(3 * a);
      const Eigen::Vector3f normal =
        (places.segment<3>(3 * b) - origin).cross(places.segment<3>(3 * c) - origin);
      for (const vtkIdType corner : { a, b, c })
      {
        sums.col(this->PlaceOfNormal[static_cast<std::size_t>(corner)]) += normal;
      }
    }
    sums.colwise().normalize();
    vtkNew<vtkFloatArray> normals;
    normals->SetName("Normals");
    normals->SetNumberOfComponents(3);
    normals->SetNumberOfTuples(surface->GetNumberOfPoints());
    Eigen::Map<Eigen::Matrix3Xf> values(normals->GetPointer(0), 3, surface->GetNumberOfPoints());
    for (Eigen::Index p = 0; p < values.cols(); ++p)
    {
      values.col(p) = sums.col(this->PlaceOfNormal[static_cast<std::size_t>(p)]);
    }
    surface->GetPointData()->SetNormals(normals);
  }

  /// Gives the surface a point array of the carrier, at the nearest places.
  void Carry(vtkDataArray* array, vtkPolyData* surface) const
  {
    const int components = array->GetNumberOfComponents();
    vtkNew<vtkDoubleArray> carried;
    carried->SetName(array->GetName());
    carried->SetNumberOfComponents(components);
    carried->SetNumberOfTuples(surface->GetNumberOfPoints());
    const auto& places = this->Embedding->nearest();
    for (std::size_t i = 0; i < this->OfSides.size(); ++i)
    {
      carried->SetTuple(static_cast<vtkIdType>(places.size() + i), this->OfSides[i], array);
    }
    for (vtkIdType p = 0; p < static_cast<vtkIdType>(places.size()); ++p)
    {
      const auto& [points, weights] = places[static_cast<std::size_t>(p)];
      for (int c = 0; c < components; ++c)
      {
        double value = 0;
        for (int k = 0; k < 3; ++k)
        {
          value += weights[k] * array->GetComponent(points[static_cast<std::size_t>(k)], c);
        }
        carried->SetComponent(p, c, value);
      }
    }
    surface->GetPointData()->AddArray(carried);
  }
};

vtkPalpateDisplaySurface::vtkPalpateDisplaySurface() = default;
vtkPalpateDisplaySurface::~vtkPalpateDisplaySurface() = default;

bool vtkPalpateDisplaySurface::IsGiven() const
{
  return this->Surface != nullptr;
}

void vtkPalpateDisplaySurface::Take(vtkObject* filter, vtkInformationVector* port,
  vtkMTimeType carrierTime, vtkMultiProcessController* controller, palpate::Communicator& ranks,
  const std::function<Carrier()>& carrier)
{
  // The same on every rank.
  if (port->GetNumberOfInformationObjects() == 0)
  {
    this->Surface.reset();
    this->SurfaceTime = 0;
    return;
  }
  auto* input = vtkPalpateInput<vtkPolyData>(port);
  const vtkMTimeType time = input ? input->GetMTime() : 0;
  if (!palpate::any(ranks, time != this->SurfaceTime || carrierTime != this->CarrierTime))
  {
    return;
  }
  this->Surface.reset();
  this->SurfaceTime = 0;
  std::string warning;
  palpate::agree(ranks,
    [&]
    {
      const auto whole = vtkPalpateGatherSurface(input, controller, true);
      if (!whole)
      {
        return;
      }
      vtkNew<vtkTriangleFilter> triangles;
      triangles->SetInputData(whole);
      triangles->PassVertsOff();
      triangles->PassLinesOff();
      triangles->Update();
      vtkPolyData* surface = triangles->GetOutput();
      if (surface->GetNumberOfPolys() == 0)
      {
        throw palpate::InputError("The display surface has no triangles. Connect a surface of the "
                                  "organ, or disconnect DisplaySurface.");
      }
      palpate::with_memory("to embed the display surface in the body",
        [&]
        {
          const Carrier body = carrier();
          auto embedded = std::make_unique<Embedded>(surface, body);
          const double diagonal = DiagonalOf(body.Surface.points);
          const double ratio = DiagonalOf(embedded->Points) / diagonal;
          const palpate::SurfaceEmbedding& embedding = *embedded->Embedding;
          const auto text = [](double length) { return palpate::quantity(length, "m"); };
          if (embedding.median_distance() > MostHalf * diagonal)
          {
            const bool isInMillimetres = std::abs(ratio / Thousand - 1) < 0.2;
            throw palpate::InputError(
              "The display surface does not lie on the body: half of its points are more than " +
              text(embedding.median_distance()) + " off it, and the body is " + text(diagonal) +
              " across. " +
              (isInMillimetres ? "It seems to be in mm: scale it by 0.001 with Transform."
                               : "Move it onto the body with Transform, or connect a surface of "
                                 "the same organ, in m and in the same axes."));
          }
          if (body.Settled.size() > 0)
          {
            embedded->Rest += embedded->Displacement(body.Settled);
          }
          if (embedding.largest_distance() > MostSilent * diagonal)
          {
            warning = "Some points of the display surface are up to " +
              text(embedding.largest_distance()) + " off the body, which is " + text(diagonal) +
              " across. They follow its nearest part, which shows nothing of the body there.";
          }
          this->Surface = std::move(embedded);
        });
    });
  this->CarrierTime = carrierTime;
  this->SurfaceTime = time;
  if (!warning.empty())
  {
    vtkPalpateWarn(filter, warning);
  }
}

void vtkPalpateDisplaySurface::Follow(vtkPolyData* body) const
{
  const Embedded& embedded = *this->Surface;
  vtkNew<vtkPolyData> carrier;
  carrier->ShallowCopy(body);
  vtkPointData* arrays = carrier->GetPointData();
  vtkDataArray* displacement = arrays->GetArray(vtkPalpateArray::Displacement);
  Eigen::VectorXf u(3 * displacement->GetNumberOfTuples());
  for (vtkIdType i = 0; i < u.size(); ++i)
  {
    u[i] = static_cast<float>(displacement->GetComponent(i / 3, static_cast<int>(i % 3)));
  }
  const Eigen::VectorXf shown = embedded.Displacement(u);

  body->Initialize();
  body->ShallowCopy(embedded.Shown);
  body->GetFieldData()->ShallowCopy(carrier->GetFieldData());
  const vtkIdType number = embedded.Shown->GetNumberOfPoints();
  vtkNew<vtkFloatArray> carried;
  carried->SetName(vtkPalpateArray::Displacement);
  carried->SetNumberOfComponents(3);
  carried->SetNumberOfTuples(number);
  std::copy(shown.begin(), shown.end(), carried->GetPointer(0));
  const Eigen::VectorXf places = embedded.Rest + shown;
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(number);
  std::copy(places.begin(), places.end(), static_cast<float*>(points->GetVoidPointer(0)));
  body->SetPoints(points);
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = arrays->GetArray(i);
    if (array && array != displacement && array != arrays->GetNormals())
    {
      embedded.Carry(array, body);
    }
  }
  body->GetPointData()->SetVectors(carried);
  embedded.AddNormals(places, body);
  body->GetPointData()->SetActiveScalars(vtkPalpateArray::Displacement);
}
