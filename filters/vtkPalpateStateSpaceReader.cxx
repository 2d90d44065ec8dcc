// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateStateSpaceReader.h"

#include <algorithm>

#include "base/error.h"
#include "state_space/state_space_file.h"
#include "state_space/touch_space.h"
#include "vtkFieldData.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkPalpateStateSpaceReader);

vtkPalpateStateSpaceReader::vtkPalpateStateSpaceReader()
{
  this->SetNumberOfInputPorts(0);
}

vtkPalpateStateSpaceReader::~vtkPalpateStateSpaceReader() = default;

int vtkPalpateStateSpaceReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  auto* output = vtkPartitionedDataSetCollection::GetData(outputVector);
  return vtkPalpateProduce(this, output,
    [&]
    {
      vtkPalpateNameBlocks(output);
      vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
      if (controller && controller->GetLocalProcessId() != 0)
      {
        return;
      }
      if (this->FileName.empty())
      {
        throw palpate::InputError("No file is named. Set FileName to a .palpate file.");
      }
      const auto file = palpate::StateSpaceFile::open_read_only(this->FileName);
      vtkPalpateFillCollection(
        file.read_scene(), palpate::make_touch_space(file, this->DisplacementBound), output);
      if (vtkPolyData* configurations = vtkPalpateConfigurations(output))
      {
        const auto sites = file.read_sites();
        const bool complete = std::all_of(
          sites.begin(), sites.end(), [](const auto& site) { return site.complete; });
        vtkPalpateAddFile(this->FileName, complete, configurations->GetFieldData());
        output->GetFieldData()->ShallowCopy(configurations->GetFieldData());
      }
    });
}

void vtkPalpateStateSpaceReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << '\n'
     << indent << "DisplacementBound: " << this->DisplacementBound << '\n';
}
