// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpatePlaceCut.h"

#include <cmath>
#include <string>

#include "base/error.h"
#include "base/quantity.h"
#include "cutting/cut_scene.h"
#include "cutting/opened_scene.h"
#include "cutting/sheet_mesh.h"
#include "cutting/straight_cells.h"
#include "vtkCellData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateBodyCells.h"
#include "vtkPalpateCutGrid.h"
#include "vtkPalpateCutSheet.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPalpateWholeSurface.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkPalpatePlaceCut);

namespace
{
using palpate::InputError;

constexpr int SheetPort = 1;
/// The longest edge at the sheet by default, in distances of fronts.
constexpr double EdgeOfSpacing = 2.5;
}

vtkPalpatePlaceCut::vtkPalpatePlaceCut()
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(2);
}

vtkPalpatePlaceCut::~vtkPalpatePlaceCut() = default;

void vtkPalpatePlaceCut::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FrontArray: " << this->FrontArray << "\n"
     << indent << "CutDirection: " << this->CutDirection[0] << ' ' << this->CutDirection[1] << ' '
     << this->CutDirection[2] << "\n"
     << indent << "StageSpacing: " << this->StageSpacing << " m\n"
     << indent << "CutEdge: " << this->CutEdge << " m\n"
     << indent << "Stage: " << this->Stage << "\n";
}

int vtkPalpatePlaceCut::FillInputPortInformation(int port, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, port == SheetPort ? "vtkPolyData" : "vtkUnstructuredGrid");
  return 1;
}

int vtkPalpatePlaceCut::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkUnstructuredGrid" : "vtkPolyData");
  return 1;
}

int vtkPalpatePlaceCut::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* outputs)
{
  auto* output = vtkUnstructuredGrid::GetData(outputs, 0);
  auto* faces = vtkPolyData::GetData(outputs, 1);
  faces->Initialize();
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&]
    {
      const auto surface =
        vtkPalpateGatherSurface(vtkPalpateInput<vtkPolyData>(input[SheetPort]), controller, true);
      const auto gathered =
        vtkPalpateGatherBody(vtkPalpateInput<vtkUnstructuredGrid>(input[0]), controller);
      if (!gathered || vtkPalpatePassFailure(gathered, output))
      {
        return;
      }
      const vtkSmartPointer<vtkUnstructuredGrid> body = vtkPalpateToTetrahedra(gathered).Body;
      if (!(this->CutEdge >= 0) || !std::isfinite(this->CutEdge))
      {
        throw InputError(
          "CutEdge is " + palpate::quantity(this->CutEdge, "m") + ", but must be a length, or 0.");
      }
      const bool isScene = body->GetPointData()->HasArray(vtkPalpateArray::Fixed);
      palpate::Scene scene;
      if (isScene)
      {
        scene = vtkPalpateSceneFromGrid(body);
      }
      else
      {
        scene.body.mesh = vtkPalpateMeshFromGrid(body);
        palpate::check_and_orient(scene.body.mesh);
      }
      int stage = 0;
      const palpate::SheetMesh cut =
        this->PutSheet(body, palpate::straight_cells(scene.body.mesh), surface, stage);
      output->ShallowCopy(vtkPalpateCutGrid(body, scene.body.mesh, cut, stage));
      if (isScene)
      {
        vtkPalpateWriteBoundaryAnew(
          palpate::open_scene(palpate::cut_scene(scene, cut), stage).scene, output);
      }
      vtkPalpateCutFaces(cut, faces);
    });
  return 1;
}

palpate::SheetMesh vtkPalpatePlaceCut::PutSheet(
  vtkUnstructuredGrid* body, const palpate::TetMesh& cells, vtkPolyData* surface, int& stage)
{
  if (body->GetCellData()->HasArray(vtkPalpateArray::CutStage))
  {
    throw InputError(
      "The body has a cut already. Apply Cut Now in place of Place Cut, which leaves "
      "open what is open of it.");
  }
  if (!(this->StageSpacing > 0) || !std::isfinite(this->StageSpacing))
  {
    throw InputError("StageSpacing is " + palpate::quantity(this->StageSpacing, "m") +
      ", but must be a length above 0.");
  }
  palpate::Vec3 middle = palpate::Vec3::Zero();
  for (const palpate::Vec3& x : cells.points)
  {
    middle += x / cells.num_points();
  }
  const palpate::Sheet sheet = vtkPalpateSheetFromPolyData(
    surface, this->FrontArray, palpate::Vec3(this->CutDirection), middle);
  palpate::SheetOptions options;
  options.spacing = this->StageSpacing;
  options.edge = this->CutEdge > 0 ? this->CutEdge : EdgeOfSpacing * this->StageSpacing;
  palpate::SheetMesh cut = palpate::put_sheet(cells, vtkPalpateRegionsOf(body), sheet, options);
  if (this->Stage < 0 || this->Stage > cut.num_stages())
  {
    throw InputError("Stage is " + std::to_string(this->Stage) + ", but the cut has " +
      std::to_string(cut.num_stages()) + " stages. Choose one of 0 to " +
      std::to_string(cut.num_stages()) + ", or another StageSpacing.");
  }
  stage = this->Stage;
  return cut;
}
