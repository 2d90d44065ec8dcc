// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateRegionSample.h"

#include <algorithm>
#include <cmath>

#include "vtkBoundingBox.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkNew.h"
#include "vtkPointData.h"

namespace
{
vtkSmartPointer<vtkImageData> Sample(vtkImplicitFunction* region, const vtkBoundingBox& box)
{
  constexpr int cells_along_longest_side = 96;
  const double step = box.GetMaxLength() / cells_along_longest_side;
  auto image = vtkSmartPointer<vtkImageData>::New();
  double lengths[3];
  box.GetLengths(lengths);
  int dimensions[3];
  double spacing[3];
  for (int i = 0; i < 3; ++i)
  {
    // The points at the ends lie on the box.
    const int cells = std::max(1, static_cast<int>(std::ceil(lengths[i] / step)));
    dimensions[i] = cells + 1;
    spacing[i] = lengths[i] > 0 ? lengths[i] / cells : step;
  }
  image->SetOrigin(box.GetMinPoint()[0], box.GetMinPoint()[1], box.GetMinPoint()[2]);
  image->SetSpacing(spacing);
  image->SetDimensions(dimensions);
  vtkNew<vtkDoubleArray> values;
  values->SetName("Region");
  values->SetNumberOfValues(image->GetNumberOfPoints());
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    values->SetValue(i, region->FunctionValue(image->GetPoint(i)));
  }
  image->GetPointData()->AddArray(values);
  return image;
}
}

vtkSmartPointer<vtkImageData> vtkPalpateSampleRegion(
  vtkImplicitFunction* region, const std::array<double, 6>& bounds)
{
  const vtkBoundingBox whole(bounds.data());
  const auto coarse = Sample(region, whole);
  auto* values = coarse->GetPointData()->GetArray("Region");
  vtkBoundingBox part;
  for (vtkIdType i = 0; i < coarse->GetNumberOfPoints(); ++i)
  {
    if (values->GetTuple1(i) <= 0)
    {
      part.AddPoint(coarse->GetPoint(i));
    }
  }
  if (!part.IsValid())
  {
    return nullptr;
  }
  const double* spacing = coarse->GetSpacing();
  part.Inflate(spacing[0], spacing[1], spacing[2]);
  part.IntersectBox(whole);
  return Sample(region, part);
}
