// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTouchedSurface.h"

#include <algorithm>

#include "vtkCellArray.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"
#include "vtkPalpateScene.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTriangleMeshPointNormals.h"

void vtkPalpateShowDisplaced(const palpate::Surface& rest, vtkCellArray* triangles,
  const Eigen::VectorXf& u, vtkPolyData* output)
{
  vtkNew<vtkFloatArray> displacement;
  displacement->SetName(vtkPalpateArray::Displacement);
  displacement->SetNumberOfComponents(3);
  displacement->SetNumberOfTuples(rest.num_points());
  std::copy(u.begin(), u.end(), displacement->GetPointer(0));
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(rest.num_points());
  for (palpate::Index p = 0; p < rest.num_points(); ++p)
  {
    const palpate::Vec3& x = rest.points[static_cast<std::size_t>(p)];
    points->SetPoint(p, x[0] + u[3 * p], x[1] + u[3 * p + 1], x[2] + u[3 * p + 2]);
  }
  output->SetPoints(points);
  output->SetPolys(triangles);
  vtkPalpateAddDisplacement(displacement, output);
}

vtkPalpateDisplaySurface::Carrier vtkPalpateCarrierOfSpace(
  const palpate::TouchSpace& space, vtkPartitionedDataSetCollection* input)
{
  vtkPalpateDisplaySurface::Carrier carrier{ space.surface, {} };
  vtkDataArray* settled = nullptr;
  for (unsigned int block = 0; block < input->GetNumberOfPartitionedDataSets() && !settled; ++block)
  {
    vtkDataSet* body =
      input->GetNumberOfPartitions(block) > 0 ? input->GetPartition(block, 0) : nullptr;
    settled = body ? body->GetPointData()->GetArray(vtkPalpateArray::RestDisplacement) : nullptr;
  }
  if (!settled)
  {
    return carrier;
  }
  carrier.Settled.resize(3 * Eigen::Index{ carrier.Surface.num_points() });
  for (std::size_t p = 0; p < carrier.Surface.points.size(); ++p)
  {
    const palpate::Vec3 by(settled->GetTuple3(space.surface.mesh_points[p]));
    carrier.Settled.segment<3>(3 * static_cast<Eigen::Index>(p)) = by.cast<float>();
    carrier.Surface.points[p] -= by;
  }
  return carrier;
}

void vtkPalpateAddDisplacement(vtkFloatArray* displacement, vtkPolyData* displaced)
{
  displaced->GetPointData()->SetVectors(displacement);
  vtkNew<vtkTriangleMeshPointNormals> normals;
  normals->SetInputData(displaced);
  normals->Update();
  displaced->GetPointData()->SetNormals(normals->GetOutput()->GetPointData()->GetNormals());
  displaced->GetPointData()->SetActiveScalars(displacement->GetName());
}
