// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateFetch.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "pqOutputPort.h"
#include "pqPipelineSource.h"
#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkPalpatePrecomputeStateSpace.h"
#include "vtkPalpateReducedModel.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMSourceProxy.h"
#include "vtkUnstructuredGrid.h"

namespace
{
/// A field array of a collection; nullptr: there is no such array.
vtkPVArrayInformation* FindField(pqOutputPort* port, const char* name)
{
  vtkPVDataInformation* data = port->getDataInformation();
  return data && data->GetCompositeDataSetType() == VTK_PARTITIONED_DATA_SET_COLLECTION
    ? data->GetArrayInformation(name, vtkDataObject::FIELD)
    : nullptr;
}

vtkDataObject* ClientSideData(vtkSMSourceProxy* proxy, int port)
{
  auto* algorithm = vtkAlgorithm::SafeDownCast(proxy->GetClientSideObject());
  return algorithm ? algorithm->GetOutputDataObject(port) : nullptr;
}

/// Takes the data from this process where the server is built in. Otherwise it takes those of the
/// server's first rank, which has the whole of a state space and of a body.
vtkSmartPointer<vtkDataObject> Fetch(pqOutputPort* port, int type)
{
  vtkSMSourceProxy* source = port->getSourceProxy();
  source->UpdatePipeline();
  if (source->GetClientSideObject())
  {
    return ClientSideData(source, port->getPortNumber());
  }
  vtkSmartPointer<vtkSMSourceProxy> fetcher;
  fetcher.TakeReference(vtkSMSourceProxy::SafeDownCast(
    source->GetSessionProxyManager()->NewProxy("filters", "ClientServerMoveData")));
  if (!fetcher)
  {
    throw std::runtime_error("This ParaView cannot move data from its server to the client.");
  }
  vtkSMPropertyHelper(fetcher, "Input")
    .Set(source, static_cast<unsigned int>(port->getPortNumber()));
  vtkSMPropertyHelper(fetcher, "OutputDataType").Set(type);
  fetcher->UpdateVTKObjects();
  fetcher->UpdatePipeline();
  return ClientSideData(fetcher, 0);
}
}

bool pqPalpateGivesStateSpace(pqOutputPort* port)
{
  return FindField(port, "SceneHash") != nullptr;
}

bool pqPalpateGivesReducedModel(pqOutputPort* port)
{
  vtkPVDataInformation* data = port->getDataInformation();
  return data && data->GetDataSetType() == VTK_UNSTRUCTURED_GRID &&
    data->GetArrayInformation("ReducedBasis", vtkDataObject::POINT) != nullptr;
}

int pqPalpateCountTools(pqOutputPort* port)
{
  vtkPVArrayInformation* nodes =
    port->getDataInformation()->GetArrayInformation("ActiveNodes", vtkDataObject::FIELD);
  return nodes ? static_cast<int>(nodes->GetNumberOfTuples()) : 0;
}

std::vector<double> pqPalpateMarkReduced(pqOutputPort* port)
{
  std::vector<double> mark;
  for (const auto& [name, association] :
    { std::pair("ReducedBasis", vtkDataObject::POINT), { "ReducedRest", vtkDataObject::POINT },
      { "ReducedPointGradients", vtkDataObject::FIELD }, { "ActiveNodes", vtkDataObject::FIELD } })
  {
    vtkPVArrayInformation* array =
      port->getDataInformation()->GetArrayInformation(name, association);
    const int components = array ? array->GetNumberOfComponents() : 0;
    mark.push_back(components);
    for (int component = 0; component < components; ++component)
    {
      const double* range = array->GetComponentRange(component);
      mark.insert(mark.end(), range, range + 2);
    }
  }
  return mark;
}

bool pqPalpateHasRigidTool(pqOutputPort* port)
{
  return FindField(port, "ContactStiffness") != nullptr;
}

bool pqPalpateHasActiveNodes(pqOutputPort* port)
{
  // The rigid tool is in this list as -1.
  vtkPVArrayInformation* nodes = FindField(port, "ActiveNodes");
  return nodes && nodes->GetComponentRange(0)[1] >= 0;
}

bool pqPalpateHasCut(pqOutputPort* port)
{
  return FindField(port, "StagesOfCut") != nullptr;
}

bool pqPalpateIsExploredAroundHand(pqOutputPort* port)
{
  return vtkSMPropertyHelper(port->getSourceProxy(), "Exploration", true).GetAsInt() ==
    vtkPalpatePrecomputeStateSpace::AROUND_THE_HAND;
}

palpate::TouchSpace pqPalpateFetchSpace(pqOutputPort* port)
{
  const vtkSmartPointer<vtkDataObject> data = Fetch(port, VTK_PARTITIONED_DATA_SET_COLLECTION);
  if (auto* space = vtkPartitionedDataSetCollection::SafeDownCast(data))
  {
    return vtkPalpateSpaceFromCollection(space, nullptr);
  }
  throw std::runtime_error("This source gives no state space. Choose the output of Precompute "
                           "State Space or of State Space Reader.");
}

pqPalpateReducedSpace pqPalpateFetchReduced(pqOutputPort* port)
{
  const vtkSmartPointer<vtkUnstructuredGrid> body = pqPalpateFetchBody(port);
  if (!body)
  {
    throw std::runtime_error(
      "This source gives no reduced model. Choose the output of Build Reduced Model.");
  }
  vtkPalpateReducedModel reduced = vtkPalpateReadReducedModel(body);
  pqPalpateReducedSpace space;
  space.Model = std::make_shared<const palpate::ReducedModel>(std::move(reduced.Model));
  palpate::TetMesh mesh = vtkPalpateMeshFromGrid(body);
  palpate::check_and_orient(mesh);
  space.Surface = palpate::make_surface(mesh);
  for (std::size_t p = 0; p < space.Surface.points.size(); ++p)
  {
    space.Surface.points[p] +=
      reduced.Rest.segment<3>(3 * Eigen::Index{ space.Surface.mesh_points[p] });
  }
  space.ActiveNodes = std::move(reduced.ActiveNodes);
  for (const vtkIdType node : space.ActiveNodes)
  {
    if (node < 0 || node >= body->GetNumberOfPoints())
    {
      throw std::runtime_error("The reduced model has a tool at point " + std::to_string(node) +
        ", but the body has " + std::to_string(body->GetNumberOfPoints()) +
        " points. Build the model again.");
    }
    space.Places.emplace_back(
      palpate::Vec3(body->GetPoint(node)) + reduced.Rest.segment<3>(3 * node));
  }
  return space;
}

vtkSmartPointer<vtkUnstructuredGrid> pqPalpateFetchBody(pqOutputPort* port)
{
  return vtkUnstructuredGrid::SafeDownCast(Fetch(port, VTK_UNSTRUCTURED_GRID));
}

vtkMTimeType pqPalpateDataTime(pqOutputPort* port)
{
  auto* data = ClientSideData(port->getSourceProxy(), port->getPortNumber());
  return data ? data->GetMTime() : 0;
}
