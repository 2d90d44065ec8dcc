// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateCutGrid.h"

#include <map>
#include <vector>

#include "cutting/straight_cells.h"
#include "elements/tetrahedron.h"
#include "mesh/cell_faces.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPalpateMeshGrid.h"
#include "vtkPalpateOpenedGrid.h"
#include "vtkPalpateScene.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::ElementOrder;
using palpate::Index;
using palpate::TetMesh;
using palpate::Vec3;
}

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateCutGrid(
  vtkUnstructuredGrid* grid, const TetMesh& mesh, const palpate::SheetMesh& cut, int stage)
{
  const TetMesh closed =
    mesh.order == ElementOrder::linear ? cut.mesh : palpate::with_middles(cut.mesh);
  auto result = vtkPalpateGridFromMesh(closed);
  const int nodes = palpate::nodes_per_cell(mesh.order);
  const std::vector<palpate::InCell> places = palpate::find_places(mesh, closed, cut.parents);
  vtkCellData* cells = result->GetCellData();
  cells->CopyGlobalIdsOff();
  cells->CopyAllocate(grid->GetCellData(), closed.num_cells());
  for (Index c = 0; c < closed.num_cells(); ++c)
  {
    cells->CopyData(grid->GetCellData(), cut.parents[c], c);
  }

  vtkPointData* points = result->GetPointData();
  points->InterpolateAllocate(grid->GetPointData(), closed.num_points());
  vtkNew<vtkIdList> ids;
  for (Index p = 0; p < closed.num_points(); ++p)
  {
    const palpate::InCell& before = places[p];
    ids->Reset();
    for (int k = 0; k < nodes; ++k)
    {
      ids->InsertNextId(mesh.cell(before.cell)[k]);
    }
    // Reference coordinates are the weights of the corners after the first.
    Eigen::VectorXd weights = palpate::shape_values(mesh.order, Vec3(before.weights.tail<3>()));
    points->InterpolatePoint(grid->GetPointData(), p, ids, weights.data());
  }
  const palpate::OpenedMesh opened = palpate::open_mesh(closed, cut.faces, stage);
  if (!opened.originals.empty())
  {
    result = vtkPalpateOpenedGrid(result, opened.mesh, opened.originals);
  }
  result->GetFieldData()->ShallowCopy(grid->GetFieldData());
  vtkNew<vtkDoubleArray> fronts;
  fronts->SetName("StageFront");
  for (const double front : cut.fronts)
  {
    fronts->InsertNextValue(front);
  }
  result->GetFieldData()->AddArray(fronts);
  vtkPalpateWriteCut({ cut.faces, stage, cut.areas }, result);
  return result;
}

void vtkPalpateCutFaces(const palpate::SheetMesh& cut, vtkPolyData* faces)
{
  std::map<palpate::FaceKey, int> stages;
  for (Index c = 0; c < cut.mesh.num_cells(); ++c)
  {
    for (int k = 0; k < 4; ++k)
    {
      if (cut.faces[c][k] > 0)
      {
        stages[palpate::face_opposite(cut.mesh.cell(c), k)] = cut.faces[c][k];
      }
    }
  }
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> triangles;
  vtkNew<vtkIntArray> array;
  array->SetName(vtkPalpateArray::CutStage);
  std::map<Index, vtkIdType> number;
  for (const auto& [face, stage] : stages)
  {
    triangles->InsertNextCell(3);
    for (const Index p : face)
    {
      const auto [entry, isNew] = number.emplace(p, points->GetNumberOfPoints());
      if (isNew)
      {
        points->InsertNextPoint(cut.mesh.points[p].data());
      }
      triangles->InsertCellPoint(entry->second);
    }
    array->InsertNextValue(stage);
  }
  faces->SetPoints(points);
  faces->SetPolys(triangles);
  faces->GetCellData()->SetScalars(array);
}

std::vector<palpate::Index> vtkPalpateRegionsOf(vtkUnstructuredGrid* body)
{
  std::vector<Index> regions;
  for (const char* name : { "Region", "RegionId" })
  {
    vtkDataArray* array = body->GetCellData()->GetArray(name);
    if (!array || array->GetNumberOfComponents() != 1)
    {
      continue;
    }
    for (vtkIdType c = 0; c < array->GetNumberOfTuples(); ++c)
    {
      regions.push_back(static_cast<Index>(array->GetTuple1(c)));
    }
    return regions;
  }
  return regions;
}
