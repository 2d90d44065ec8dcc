// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateEstimateError.h"

#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "interpolation/error_estimate.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPalpateStateSpaceArrays.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"

namespace
{
constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();

/// The key of a configuration: active node, check-point and body.
using Key = std::tuple<palpate::Index, int, int, int, int>;

/// The errors at the first levels, as rows of active node, check-point, body and error.
std::vector<double> Estimate(const palpate::TouchSpace& space)
{
  std::vector<double> rows;
  for (const palpate::TouchToolSpace& toolSpace : space.tool_spaces)
  {
    const std::vector<double> errors = palpate::estimate_errors_around(
      toolSpace.setup.grid, toolSpace.configurations, toolSpace.clearance);
    for (std::size_t i = 0; i < errors.size(); ++i)
    {
      const auto& [x, y, z] = toolSpace.configurations[i].check_point;
      rows.insert(rows.end(),
        { static_cast<double>(toolSpace.setup.number()), static_cast<double>(x),
          static_cast<double>(y), static_cast<double>(z), static_cast<double>(toolSpace.setup.body),
          errors[i] });
    }
  }
  return rows;
}

/// The rows of rank 0, on every rank.
std::map<Key, double> Share(std::vector<double> rows, vtkMultiProcessController* controller)
{
  if (controller && controller->GetNumberOfProcesses() > 1)
  {
    auto length = static_cast<vtkIdType>(rows.size());
    controller->Broadcast(&length, 1, 0);
    rows.resize(static_cast<std::size_t>(length));
    controller->Broadcast(rows.data(), length, 0);
  }
  std::map<Key, double> estimates;
  const auto integer = [&rows](std::size_t i) { return static_cast<int>(rows[i]); };
  for (std::size_t i = 0; i < rows.size(); i += 6)
  {
    estimates.emplace(
      Key(integer(i), integer(i + 1), integer(i + 2), integer(i + 3), integer(i + 4)), rows[i + 5]);
  }
  return estimates;
}

/// Replaces the partition with one that has the array.
void AddErrors(const std::map<Key, double>& estimates, vtkDataSet* partition,
  vtkPartitionedDataSetCollection* collection)
{
  const auto copy = vtk::TakeSmartPointer(partition->NewInstance());
  copy->ShallowCopy(partition);
  vtkPointData* arrays = copy->GetPointData();
  const auto get = [&](const char* name, vtkIdType i, int component = 0)
  { return static_cast<int>(arrays->GetArray(name)->GetComponent(i, component)); };
  const bool hasBodies = arrays->HasArray(vtkPalpateStateSpaceArrays::BodyNumber) != 0;
  vtkNew<vtkDoubleArray> errors;
  errors->SetName("EstimatedError");
  for (vtkIdType i = 0; i < copy->GetNumberOfPoints(); ++i)
  {
    const int body = hasBodies ? get(vtkPalpateStateSpaceArrays::BodyNumber, i)
                               : static_cast<int>(palpate::kFirstBody);
    const auto found = estimates.find(Key(get("ActiveNode", i), get("CheckPoint", i),
      get("CheckPoint", i, 1), get("CheckPoint", i, 2), body));
    errors->InsertNextValue(
      get("Level", i) == 0 && found != estimates.end() ? found->second : Nothing);
  }
  arrays->AddArray(errors);
  arrays->SetActiveScalars(errors->GetName());
  for (unsigned int i = 0; i < collection->GetNumberOfPartitionedDataSets(); ++i)
  {
    for (unsigned int p = 0; p < collection->GetNumberOfPartitions(i); ++p)
    {
      if (collection->GetPartitionAsDataObject(i, p) == partition)
      {
        collection->SetPartition(i, p, copy);
      }
    }
  }
}
}

vtkStandardNewMacro(vtkPalpateEstimateError);

vtkPalpateEstimateError::vtkPalpateEstimateError() = default;
vtkPalpateEstimateError::~vtkPalpateEstimateError() = default;

int vtkPalpateEstimateError::FillInputPortInformation(int, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, "vtkPartitionedDataSetCollection");
  return 1;
}

int vtkPalpateEstimateError::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkPartitionedDataSetCollection::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&](palpate::Communicator& ranks)
    {
      auto* input = vtkPalpateInput<vtkPartitionedDataSetCollection>(inputVector[0]);
      if (palpate::any(ranks, vtkPalpatePassFailure(input, output)))
      {
        return;
      }
      std::vector<double> rows;
      palpate::agree(ranks,
        [&]
        {
          const palpate::TouchSpace space = vtkPalpateSpaceFromCollection(input, controller);
          rows = Estimate(space);
          if (!space.list_turned().empty())
          {
            vtkPalpateWarn(this,
              "The tool is turned: the estimate is that between its places, "
              "at each orientation, and says nothing of those in between. "
              "Compare Touch State Space with Solve Equilibrium there.");
          }
        });
      const std::map<Key, double> estimates = Share(std::move(rows), controller);
      output->CompositeShallowCopy(input);
      for (const auto& partition : vtkPalpateConfigurations(output))
      {
        AddErrors(estimates, partition, output);
      }
    });
  return 1;
}
