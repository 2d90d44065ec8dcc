// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateFetch.h"

#include <stdexcept>

#include "pqOutputPort.h"
#include "pqPipelineSource.h"
#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMSourceProxy.h"
#include "vtkSmartPointer.h"

namespace
{
vtkPartitionedDataSetCollection* ClientSideData(vtkSMSourceProxy* proxy, int port)
{
  auto* algorithm = vtkAlgorithm::SafeDownCast(proxy->GetClientSideObject());
  return algorithm
    ? vtkPartitionedDataSetCollection::SafeDownCast(algorithm->GetOutputDataObject(port))
    : nullptr;
}

/// What the server's first rank has, which is the whole of a state space.
vtkSmartPointer<vtkSMSourceProxy> Fetcher(vtkSMSourceProxy* source, int port)
{
  vtkSmartPointer<vtkSMSourceProxy> fetcher;
  fetcher.TakeReference(vtkSMSourceProxy::SafeDownCast(
    source->GetSessionProxyManager()->NewProxy("filters", "ClientServerMoveData")));
  if (!fetcher)
  {
    throw std::runtime_error("This ParaView cannot move data from its server to the client.");
  }
  vtkSMPropertyHelper(fetcher, "Input").Set(source, port);
  vtkSMPropertyHelper(fetcher, "OutputDataType").Set(VTK_PARTITIONED_DATA_SET_COLLECTION);
  fetcher->UpdateVTKObjects();
  fetcher->UpdatePipeline();
  return fetcher;
}
}

bool pqPalpateGivesStateSpace(pqOutputPort* port)
{
  vtkPVDataInformation* data = port->getDataInformation();
  return data && data->GetCompositeDataSetType() == VTK_PARTITIONED_DATA_SET_COLLECTION &&
    data->GetArrayInformation("SceneHash", vtkDataObject::FIELD);
}

palpate::TouchSpace pqPalpateFetchSpace(pqOutputPort* port)
{
  vtkSMSourceProxy* source = port->getSourceProxy();
  const int number = port->getPortNumber();
  source->UpdatePipeline();
  if (source->GetClientSideObject())
  {
    if (auto* data = ClientSideData(source, number))
    {
      return vtkPalpateSpaceFromCollection(data, nullptr);
    }
  }
  else
  {
    const vtkSmartPointer<vtkSMSourceProxy> fetcher = Fetcher(source, number);
    if (auto* data = ClientSideData(fetcher, 0))
    {
      return vtkPalpateSpaceFromCollection(data, nullptr);
    }
  }
  throw std::runtime_error("This source gives no state space. Choose the output of Precompute "
                           "State Space or of State Space Reader.");
}

vtkMTimeType pqPalpateDataTime(pqOutputPort* port)
{
  auto* data = ClientSideData(port->getSourceProxy(), port->getPortNumber());
  return data ? data->GetMTime() : 0;
}
