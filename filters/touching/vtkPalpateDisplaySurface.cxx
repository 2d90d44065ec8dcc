// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateDisplaySurface.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/memory_error.h"
#include "base/quantity.h"
#include "mesh/surface_embedding.h"
#include "schedule/communicator.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateWholeSurface.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTriangleFilter.h"
#include "vtkTriangleMeshPointNormals.h"

namespace
{
using palpate::Vec3;

constexpr const char* Displacement = "Displacement";
/// How far off the body half of the points of a surface may be, and how far all of them without a
/// warning, as shares of the body's diagonal.
constexpr double MostHalf = 0.05;
constexpr double MostSilent = 0.05;
/// Points at one place are one where normals are computed, unless the normals that they came with
/// differ by more than this angle: there the surface has an edge.
const double CosineOfEdge = std::cos(30 * 3.14159265358979323846 / 180);
/// Sizes of a surface and a body that differ by this factor, to 20 %, are in mm and in m.
constexpr double Thousand = 1000;

double DiagonalOf(const std::vector<Vec3>& points)
{
  if (points.empty())
  {
    return 0;
  }
  Vec3 least = points.front();
  Vec3 most = least;
  for (const Vec3& point : points)
  {
    least = least.cwiseMin(point);
    most = most.cwiseMax(point);
  }
  return (most - least).norm();
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

/// The first of the points at each point's place whose normal is alike [points].
std::vector<vtkIdType> FirstAtPlace(const std::vector<Vec3>& points, vtkDataArray* normals)
{
  std::map<std::array<double, 3>, std::vector<vtkIdType>> atPlace;
  std::vector<vtkIdType> first;
  for (vtkIdType p = 0; p < static_cast<vtkIdType>(points.size()); ++p)
  {
    const Vec3& x = points[static_cast<std::size_t>(p)];
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
    : Rest(PointsOf(surface))
    , Embedding(carrier.Points, carrier.Triangles, this->Rest)
  {
    this->Shown->ShallowCopy(surface);
    const std::vector<vtkIdType> first =
      FirstAtPlace(this->Rest, surface->GetPointData()->GetNormals());
    // Its own normals are those at rest.
    if (vtkDataArray* normals = this->Shown->GetPointData()->GetNormals())
    {
      this->Shown->GetPointData()->RemoveArray(normals->GetName());
    }
    std::map<vtkIdType, vtkIdType> places;
    for (const vtkIdType p : first)
    {
      if (places.try_emplace(p, static_cast<vtkIdType>(places.size())).second)
      {
        this->Kept.push_back(p);
      }
      this->PlaceOfNormal.push_back(places.at(p));
    }
    vtkIdType count;
    const vtkIdType* ids;
    for (vtkCellArray* polys = surface->GetPolys(); polys->GetNextCell(count, ids);)
    {
      this->Triangles->InsertNextCell(
        { this->PlaceOfNormal[ids[0]], this->PlaceOfNormal[ids[1]], this->PlaceOfNormal[ids[2]] });
    }
  }

  std::vector<Vec3> Rest;
  palpate::SurfaceEmbedding Embedding;
  /// The surface with its arrays, as it came.
  vtkNew<vtkPolyData> Shown;
  /// The points without those that are there twice, the place of each point among them, and the
  /// triangles of these places.
  std::vector<vtkIdType> Kept;
  std::vector<vtkIdType> PlaceOfNormal;
  vtkNew<vtkCellArray> Triangles;

  /// Moves the points from which displacements count.
  void Settle(const Eigen::VectorXf& by)
  {
    for (std::size_t p = 0; p < this->Rest.size(); ++p)
    {
      this->Rest[p] += by.segment<3>(3 * static_cast<Eigen::Index>(p)).cast<double>();
    }
  }

  void AddNormals(vtkPolyData* surface) const
  {
    vtkNew<vtkPoints> points;
    points->SetNumberOfPoints(static_cast<vtkIdType>(this->Kept.size()));
    for (std::size_t i = 0; i < this->Kept.size(); ++i)
    {
      points->SetPoint(static_cast<vtkIdType>(i), surface->GetPoint(this->Kept[i]));
    }
    vtkNew<vtkPolyData> merged;
    merged->SetPoints(points);
    merged->SetPolys(this->Triangles);
    vtkNew<vtkTriangleMeshPointNormals> filter;
    filter->SetInputData(merged);
    filter->Update();
    vtkDataArray* found = filter->GetOutput()->GetPointData()->GetNormals();
    vtkNew<vtkFloatArray> normals;
    normals->SetName("Normals");
    normals->SetNumberOfComponents(3);
    normals->SetNumberOfTuples(surface->GetNumberOfPoints());
    for (vtkIdType p = 0; p < surface->GetNumberOfPoints(); ++p)
    {
      normals->SetTuple(p, this->PlaceOfNormal[static_cast<std::size_t>(p)], found);
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
    const auto& places = this->Embedding.nearest();
    for (vtkIdType p = 0; p < surface->GetNumberOfPoints(); ++p)
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

std::string vtkPalpateDisplaySurface::Take(vtkInformationVector* port, vtkMTimeType carrierTime,
  vtkMultiProcessController* controller, palpate::Communicator& ranks,
  const std::function<Carrier()>& carrier)
{
  // The same on every rank.
  if (port->GetNumberOfInformationObjects() == 0)
  {
    this->Surface.reset();
    this->SurfaceTime = 0;
    return {};
  }
  auto* input = vtkPalpateInput<vtkPolyData>(port);
  const vtkMTimeType time = input ? input->GetMTime() : 0;
  if (!palpate::any(ranks, time != this->SurfaceTime || carrierTime != this->CarrierTime))
  {
    return {};
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
          this->Surface = std::make_unique<Embedded>(surface, body);
          const double diagonal = DiagonalOf(body.Points);
          const double ratio = DiagonalOf(this->Surface->Rest) / diagonal;
          const palpate::SurfaceEmbedding& embedding = this->Surface->Embedding;
          const auto text = [](double length) { return palpate::quantity(length, "m"); };
          if (embedding.median_distance() > MostHalf * diagonal)
          {
            const bool isInMillimetres = std::abs(ratio / Thousand - 1) < 0.2;
            this->Surface.reset();
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
            this->Surface->Settle(embedding.displacement(body.Settled));
          }
          if (embedding.largest_distance() > MostSilent * diagonal)
          {
            warning = "Some points of the display surface are up to " +
              text(embedding.largest_distance()) + " off the body, which is " + text(diagonal) +
              " across. They follow its nearest part, which shows nothing of the body there.";
          }
        });
    });
  this->CarrierTime = carrierTime;
  this->SurfaceTime = time;
  return warning;
}

void vtkPalpateDisplaySurface::Follow(vtkPolyData* body) const
{
  const Embedded& embedded = *this->Surface;
  vtkNew<vtkPolyData> carrier;
  carrier->ShallowCopy(body);
  vtkPointData* arrays = carrier->GetPointData();
  vtkDataArray* displacement = arrays->GetArray(Displacement);
  Eigen::VectorXf u(3 * displacement->GetNumberOfTuples());
  for (vtkIdType i = 0; i < u.size(); ++i)
  {
    u[i] = static_cast<float>(displacement->GetComponent(i / 3, static_cast<int>(i % 3)));
  }
  const Eigen::VectorXf shown = embedded.Embedding.displacement(u);

  body->Initialize();
  body->ShallowCopy(embedded.Shown);
  body->GetFieldData()->ShallowCopy(carrier->GetFieldData());
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(static_cast<vtkIdType>(embedded.Rest.size()));
  vtkNew<vtkFloatArray> carried;
  carried->SetName(Displacement);
  carried->SetNumberOfComponents(3);
  carried->SetNumberOfTuples(points->GetNumberOfPoints());
  std::copy(shown.begin(), shown.end(), carried->GetPointer(0));
  for (std::size_t p = 0; p < embedded.Rest.size(); ++p)
  {
    const Vec3 place =
      embedded.Rest[p] + shown.segment<3>(3 * static_cast<Eigen::Index>(p)).cast<double>();
    points->SetPoint(static_cast<vtkIdType>(p), place.data());
  }
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
  embedded.AddNormals(body);
  body->GetPointData()->SetActiveScalars(Displacement);
}
