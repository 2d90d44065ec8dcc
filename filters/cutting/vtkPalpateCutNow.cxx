// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateCutNow.h"

#include <array>
#include <string>
#include <vector>

#include "base/error.h"
#include "cutting/sheet_mesh.h"
#include "mesh/surface_tree.h"
#include "mesh/tet_mesh.h"
#include "vtkAdaptiveSubdivisionFilter.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkGenericCell.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCutGrid.h"
#include "vtkPalpateCutSheet.h"
#include "vtkPalpateScene.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStaticCellLocator.h"
#include "vtkTriangleFilter.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkPalpateCutNow);

namespace
{
using palpate::Vec3;

/// The triangles of a sheet that is drawn back with the body have edges of so many mean edges of
/// the cells at the most.
constexpr double EdgeOfCells = 0.5;

double MeanEdge(const palpate::TetMesh& cells)
{
  double sum = 0;
  for (palpate::Index c = 0; c < cells.num_cells(); ++c)
  {
    for (const auto& [a, b] : palpate::kTetEdges)
    {
      sum += (cells.points[cells.cell(c)[a]] - cells.points[cells.cell(c)[b]]).norm();
    }
  }
  return sum / (6. * cells.num_cells());
}

/// The sheet with triangles that are small beside the cells.
vtkSmartPointer<vtkPolyData> Divided(vtkPolyData* sheet, double edge)
{
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputData(sheet);
  triangles->PassLinesOff();
  triangles->PassVertsOff();
  vtkNew<vtkAdaptiveSubdivisionFilter> divide;
  divide->SetInputConnection(triangles->GetOutputPort());
  divide->SetMaximumEdgeLength(edge);
  divide->SetMaximumTriangleArea(edge * edge);
  divide->Update();
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->ShallowCopy(divide->GetOutput());
  return result;
}

/// Draws the sheet from the deformed body back to the one at rest. Beyond the body it moves as the
/// nearest point of the surface does.
void DrawBack(vtkUnstructuredGrid* body, vtkDataArray* displacement, vtkPolyData* sheet)
{
  palpate::TetMesh mesh = vtkPalpateMeshFromGrid(body);
  const auto triangles = palpate::boundary_triangles(mesh);
  vtkNew<vtkPoints> moved;
  moved->SetDataTypeToDouble();
  moved->SetNumberOfPoints(body->GetNumberOfPoints());
  std::vector<Vec3> displacements;
  for (vtkIdType p = 0; p < body->GetNumberOfPoints(); ++p)
  {
    Vec3& u = displacements.emplace_back();
    displacement->GetTuple(p, u.data());
    if (!u.allFinite())
    {
      throw palpate::InputError("The displacement of the body is no number somewhere. Solve for it "
                                "again, or turn OnDeformedBody off.");
    }
    Vec3& place = mesh.points[static_cast<std::size_t>(p)];
    place += u;
    moved->SetPoint(p, place.data());
  }
  const palpate::SurfaceTree surface(mesh.points, triangles);
  vtkNew<vtkUnstructuredGrid> deformed;
  deformed->ShallowCopy(body);
  deformed->SetPoints(moved);
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(deformed);
  locator->BuildLocator();

  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkGenericCell> cell;
  for (vtkIdType p = 0; p < sheet->GetNumberOfPoints(); ++p)
  {
    Vec3 place(sheet->GetPoint(p));
    Vec3 inCell;
    std::array<double, 10> weights{};
    if (locator->FindCell(place.data(), 0, cell, inCell.data(), weights.data()) >= 0)
    {
      for (vtkIdType k = 0; k < cell->GetNumberOfPoints(); ++k)
      {
        place -= weights[static_cast<std::size_t>(k)] *
          displacements[static_cast<std::size_t>(cell->GetPointId(k))];
      }
    }
    else
    {
      const palpate::SurfaceTree::Nearest nearest = surface.nearest(place);
      const auto& corners = surface.points_of(nearest.triangle);
      for (int k = 0; k < 3; ++k)
      {
        place -= nearest.weights[k] *
          displacements[static_cast<std::size_t>(corners[static_cast<std::size_t>(k)])];
      }
    }
    points->InsertNextPoint(place.data());
  }
  sheet->SetPoints(points);
}
}

vtkPalpateCutNow::vtkPalpateCutNow() = default;

vtkPalpateCutNow::~vtkPalpateCutNow() = default;

void vtkPalpateCutNow::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "OnDeformedBody: " << this->OnDeformedBody << "\n";
}

palpate::SheetMesh vtkPalpateCutNow::PutSheet(
  vtkUnstructuredGrid* body, const palpate::TetMesh& cells, vtkPolyData* surface, int& stage)
{
  vtkSmartPointer<vtkPolyData> sheet = surface;
  const double edge = MeanEdge(cells);
  vtkDataArray* displacement = body->GetPointData()->GetArray(vtkPalpateArray::Displacement);
  if (this->OnDeformedBody && displacement && displacement->GetNumberOfComponents() == 3)
  {
    sheet = Divided(surface, EdgeOfCells * edge);
    DrawBack(body, displacement, sheet);
  }
  palpate::SheetOptions options;
  // One front, which is where the sheet ends.
  options.spacing = sheet->GetLength();
  options.edge = this->CutEdge > 0 ? this->CutEdge : edge;
  stage = 1;
  return palpate::put_sheet(cells, vtkPalpateRegionsOf(body),
    vtkPalpateSheetFromPolyData(sheet, "None", Vec3::Zero(), Vec3(body->GetCenter())), options);
}
