// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioReader.h"

#include <algorithm>

#include "base/error.h"
#include "base/printable.h"
#include "mesh/touching_pieces.h"
#include "vtkAlgorithm.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateFEBioModel.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpateScene.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

namespace
{
void AddRegions(const vtkPalpateFEBioModel& model, vtkUnstructuredGrid* body)
{
  vtkNew<vtkIntArray> ids;
  ids->SetName("RegionId");
  ids->SetNumberOfValues(body->GetNumberOfCells());
  std::copy(model.RegionOfCell.begin(), model.RegionOfCell.end(), ids->GetPointer(0));
  body->GetCellData()->AddArray(ids);
  vtkNew<vtkStringArray> names;
  names->SetName("Regions");
  for (const std::string& name : model.Regions)
  {
    names->InsertNextValue(name);
  }
  body->GetFieldData()->AddArray(names);
}
}

vtkStandardNewMacro(vtkPalpateFEBioReader);

vtkPalpateFEBioReader::vtkPalpateFEBioReader()
{
  this->SetNumberOfInputPorts(0);
}

vtkPalpateFEBioReader::~vtkPalpateFEBioReader() = default;

int vtkPalpateFEBioReader::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  // This makes every rank execute RequestData, where the ranks agree whether it has failed.
  outputVector->GetInformationObject(0)->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  return 1;
}

int vtkPalpateFEBioReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  auto* output = vtkUnstructuredGrid::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&]
    {
      if (controller && controller->GetLocalProcessId() != 0)
      {
        return;
      }
      if (this->FileName.empty())
      {
        throw palpate::InputError("No file is named. Set FileName to a .feb file.");
      }
      const vtkPalpateFEBioModel model = vtkPalpateReadFEBio(this->FileName, this->Units);
      // The body's rest under the loads is not known.
      palpate::Scene unloaded = model.Scene;
      unloaded.body.applied_pressure.clear();
      unloaded.body.applied_traction.clear();
      output->ShallowCopy(vtkPalpateGridFromScene(unloaded));
      vtkPalpateWriteBoundary(model.Scene, output);
      vtkPalpateAddBoundaryKinds(model.Scene, output);
      vtkPalpateWriteRheologies(model.Rheologies, model.Scene.body.material_of_cell, output);
      AddRegions(model, output);
      std::vector<std::string> warnings = model.Warnings;
      const palpate::TetMesh& mesh = model.Scene.body.mesh;
      const palpate::Pieces pieces = palpate::find_pieces(mesh);
      if (const auto touching =
            palpate::describe(palpate::find_touching_pieces(mesh, pieces), pieces.size(), false))
      {
        warnings.push_back(*touching);
      }
      if (!warnings.empty())
      {
        std::string text;
        for (const std::string& warning : warnings)
        {
          text += (text.empty() ? "" : " ") + warning;
        }
        vtkPalpateWarn(this, "The file " + palpate::quoted(this->FileName) + ": " + text);
      }
    });
  return 1;
}

void vtkPalpateFEBioReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << '\n'
     << indent << "Units: " << this->Units << '\n';
}
