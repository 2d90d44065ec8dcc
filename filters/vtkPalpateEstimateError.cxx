// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateEstimateError.h"

#include <limits>
#include <map>
#include <tuple>
#include <vector>

#include "interpolation/error_estimate.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

namespace
{
constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();

/// Active node, check-point.
using Key = std::tuple<palpate::Index, int, int, int>;

/// Of the first levels.
std::map<Key, double> Estimate(const palpate::TouchSpace& space)
{
  std::map<Key, double> estimates;
  for (const palpate::TouchSite& site : space.sites)
  {
    const std::vector<double> errors =
      palpate::estimate_errors_around(site.site, site.configurations);
    for (std::size_t i = 0; i < errors.size(); ++i)
    {
      const auto& [x, y, z] = site.configurations[i].check_point;
      estimates.emplace(Key(site.site.active_node, x, y, z), errors[i]);
    }
  }
  return estimates;
}

/// Replaces the block with one that has the array.
void AddErrors(const std::map<Key, double>& estimates, vtkPolyData* block,
  vtkPartitionedDataSetCollection* collection)
{
  vtkNew<vtkPolyData> copy;
  copy->ShallowCopy(block);
  vtkPointData* arrays = copy->GetPointData();
  const auto get = [&](const char* name, vtkIdType i, int component = 0)
  { return static_cast<int>(arrays->GetArray(name)->GetComponent(i, component)); };
  vtkNew<vtkDoubleArray> errors;
  errors->SetName("EstimatedError");
  for (vtkIdType i = 0; i < copy->GetNumberOfPoints(); ++i)
  {
    const auto found = estimates.find(Key(get("ActiveNode", i), get("CheckPoint", i),
      get("CheckPoint", i, 1), get("CheckPoint", i, 2)));
    errors->InsertNextValue(
      get("Level", i) == 0 && found != estimates.end() ? found->second : Nothing);
  }
  arrays->AddArray(errors);
  arrays->SetActiveScalars(errors->GetName());
  for (unsigned int i = 0; i < collection->GetNumberOfPartitionedDataSets(); ++i)
  {
    for (unsigned int p = 0; p < collection->GetNumberOfPartitions(i); ++p)
    {
      if (collection->GetPartitionAsDataObject(i, p) == block)
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

int vtkPalpateEstimateError::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* input = vtkPartitionedDataSetCollection::GetData(inputVector[0]);
  auto* output = vtkPartitionedDataSetCollection::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  // Every rank meets the same error; rank 0 reports it.
  const bool reports = !controller || controller->GetLocalProcessId() == 0;
  return vtkPalpateProduce(reports ? this : nullptr, output,
    [&]
    {
      const auto ranks = vtkPalpateCommunicator(controller);
      if (palpate::any(*ranks, vtkPalpatePassFailure(input, output)))
      {
        return;
      }
      palpate::TouchSpace space;
      palpate::agree(*ranks, [&] { space = vtkPalpateSpaceFromCollection(input, controller); });
      output->CompositeShallowCopy(input);
      vtkPolyData* block = vtkPalpateConfigurations(output);
      if (reports && block)
      {
        AddErrors(Estimate(space), block, output);
      }
    });
}
