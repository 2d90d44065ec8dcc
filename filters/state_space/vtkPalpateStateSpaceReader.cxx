// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateStateSpaceReader.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/error.h"
#include "schedule/communicator.h"
#include "state_space/touch_space.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"
#include "vtkFieldData.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGrowth.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkPalpateStateSpaceReader);

vtkPalpateStateSpaceReader::vtkPalpateStateSpaceReader()
{
  this->SetNumberOfInputPorts(0);
}

vtkPalpateStateSpaceReader::~vtkPalpateStateSpaceReader()
{
  vtkPalpateStopGrowing(this);
}

bool vtkPalpateStateSpaceReader::GetNeedsUpdate()
{
  if (!vtkPalpateGrows(this) || palpate::StateSpaceFile::is_being_written(this->FileName))
  {
    return false;
  }
  std::error_code missing; // It may come again.
  const auto written = std::filesystem::last_write_time(this->FileName, missing);
  if (missing || written == this->Written)
  {
    return false;
  }
  vtkPalpateGoOn();
  return true;
}

int vtkPalpateStateSpaceReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  auto* output = vtkPartitionedDataSetCollection::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  vtkPalpateStopGrowing(this);
  const bool reads = !controller || controller->GetLocalProcessId() == 0;
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&](palpate::Communicator& communicator)
    {
      std::vector<palpate::SpaceBody> bodies;
      palpate::TouchSpace space;
      bool complete = false;
      palpate::agree(communicator,
        [&]
        {
          if (!reads)
          {
            return;
          }
          if (this->FileName.empty())
          {
            throw palpate::InputError("No file is named. Set FileName to a .palpate file.");
          }
          std::error_code missing; // Opening it says so.
          this->Written = std::filesystem::last_write_time(this->FileName, missing);
          const auto file = palpate::StateSpaceFile::open_read_only(this->FileName);
          bodies = file.read_bodies();
          space = palpate::make_touch_space(file, this->DisplacementBound);
          const auto toolSpaces = file.read_tool_spaces();
          complete = space.left_out.empty() &&
            std::all_of(toolSpaces.begin(), toolSpaces.end(),
              [](const auto& toolSpace) { return toolSpace.complete; });
        });
      if (!palpate::any(communicator, complete))
      {
        vtkPalpateGrow(this, controller);
      }
      // The blocks are the same on every rank.
      vtkPalpateNameBlocks(output,
        palpate::any(communicator, vtkPalpateHasIntermediateStates(space)),
        vtkPalpateNumberOfBodies(bodies, communicator));
      if (!reads)
      {
        return;
      }
      const std::vector<std::string> leftOut = space.left_out;
      vtkPalpateFillCollection(bodies, std::move(space), output);
      for (const auto& configurations : vtkPalpateConfigurations(output))
      {
        vtkPalpateAddFile(this->FileName, complete, configurations->GetFieldData());
        vtkPalpateAddLeftOut(leftOut, configurations->GetFieldData());
        output->GetFieldData()->ShallowCopy(configurations->GetFieldData());
      }
      if (!leftOut.empty())
      {
        vtkWarningMacro(<< palpate::describe_left_out(this->FileName, leftOut)
                        << " This is left out. Precompute State Space with this file computes it "
                        << "again.");
      }
    });
  return 1;
}

void vtkPalpateStateSpaceReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << '\n'
     << indent << "DisplacementBound: " << this->DisplacementBound << '\n';
}
