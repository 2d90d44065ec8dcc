// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateEdgeField.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkKdTreePointLocator.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPalpateRegionSample.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

vtkPalpateEdgeField::vtkPalpateEdgeField(vtkPalpateEdges edges, const std::array<double, 6>& bounds)
  : Edges(std::move(edges))
{
  std::sort(this->Edges.Sources.begin(), this->Edges.Sources.end(),
    [](const auto& a, const auto& b) { return a.Edge < b.Edge; });
  if (!this->Edges.Region || !(this->Edges.RegionEdge > 0))
  {
    return;
  }
  const auto image = vtkPalpateSampleRegion(this->Edges.Region, bounds);
  if (!image)
  {
    throw palpate::InputError(
      "RefineRegion has no point in the body, so that RefineEdge is without "
      "effect. Move it there, or set RefineEdge to 0.");
  }
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkDataArray* values = image->GetPointData()->GetArray("Region");
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    if (values->GetTuple1(i) <= 0)
    {
      points->InsertNextPoint(image->GetPoint(i));
    }
  }
  vtkNew<vtkPolyData> within;
  within->SetPoints(points);
  this->Within = vtkSmartPointer<vtkKdTreePointLocator>::New();
  this->Within->SetDataSet(within);
  this->Within->BuildLocator();
  const double* spacing = image->GetSpacing();
  this->HalfSpacing = 0.5 * vtkMath::Norm(spacing);
}

vtkPalpateEdgeField::~vtkPalpateEdgeField() = default;

double vtkPalpateEdgeField::At(const vtkPalpatePoint& place) const
{
  double edge = std::numeric_limits<double>::infinity();
  if (this->Within)
  {
    double nearest[3];
    const vtkIdType found = this->Within->FindClosestPoint(place.data());
    this->Within->GetDataSet()->GetPoint(found, nearest);
    const double distance =
      std::sqrt(vtkMath::Distance2BetweenPoints(nearest, place.data())) - this->HalfSpacing;
    edge = this->Edges.RegionEdge + this->Edges.Growth * std::max(0., distance);
  }
  for (const auto& [of_source, at] : this->Edges.Sources)
  {
    // The sources that follow ask for no less.
    if (of_source >= edge)
    {
      break;
    }
    const double distance = std::sqrt(vtkMath::Distance2BetweenPoints(at.data(), place.data()));
    edge = std::min(edge, of_source + this->Edges.Growth * distance);
  }
  return edge;
}
