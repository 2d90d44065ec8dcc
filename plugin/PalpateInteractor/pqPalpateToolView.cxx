// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateToolView.h"

#include <algorithm>
#include <cmath>

#include "vtkActor.h"
#include "vtkArrowSource.h"
#include "vtkCellArray.h"
#include "vtkMatrix4x4.h"
#include "vtkPVRenderView.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSphereSource.h"

namespace
{
/// Of the diagonal of the body.
constexpr double ToolRadius = 0.012;
constexpr double LongestArrow = 0.4;
constexpr double NodeSize = 8; // pixels

/// Units of depth that bring anything to the front: a force that points into the body is seen too.
constexpr double ToFront = -66000;
/// A node in front of the surface that it lies in, and behind what is in front of that.
constexpr double ToSurface = -500;

void SetMapper(vtkActor* actor, vtkAlgorithmOutput* output)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(output);
  mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(0, ToFront);
  actor->SetMapper(mapper);
  // At the front all depths are the same.
  actor->GetProperty()->BackfaceCullingOn();
}
}

pqPalpateToolView::pqPalpateToolView(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space)
{
  palpate::Vec3 low = space.surface.points.front();
  palpate::Vec3 high = low;
  for (const palpate::Vec3& point : space.surface.points)
  {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const double size = (high - low).norm();

  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> vertices;
  double largestForce = 0;
  double radius = ToolRadius * size;
  for (const palpate::TouchSite& site : space.sites)
  {
    const vtkIdType id = points->InsertNextPoint(site.rest_position.data());
    vertices->InsertNextCell(1, &id);
    radius = std::max(radius, site.site.tip_radius);
    for (const palpate::ConfigurationSummary& configuration : site.configurations)
    {
      if (configuration.usable())
      {
        largestForce = std::max(largestForce, configuration.force.norm());
      }
    }
  }
  this->ArrowScale = largestForce > 0 ? LongestArrow * size / largestForce : 0;

  vtkNew<vtkPolyData> nodes;
  nodes->SetPoints(points);
  nodes->SetVerts(vertices);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(nodes);
  mapper->SetRelativeCoincidentTopologyPointOffsetParameter(ToSurface);
  this->Nodes->SetMapper(mapper);
  this->Nodes->GetProperty()->SetPointSize(NodeSize);
  this->Nodes->GetProperty()->RenderPointsAsSpheresOn();
  this->Nodes->GetProperty()->SetColor(0.15, 0.15, 0.15);

  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(radius);
  sphere->SetThetaResolution(24);
  sphere->SetPhiResolution(16);
  SetMapper(this->Tool, sphere->GetOutputPort());
  this->Tool->GetProperty()->SetColor(0.95, 0.75, 0.1);

  vtkNew<vtkArrowSource> arrow;
  arrow->SetTipResolution(20);
  arrow->SetShaftResolution(16);
  SetMapper(this->Arrow, arrow->GetOutputPort());
  this->Arrow->GetProperty()->SetColor(0.8, 0.1, 0.1);

  if (auto* client = vtkPVRenderView::SafeDownCast(view->GetClientSideObject()))
  {
    this->Renderer = client->GetNonCompositedRenderer();
  }
  for (vtkActor* actor : { this->Nodes.Get(), this->Tool.Get(), this->Arrow.Get() })
  {
    actor->PickableOff();
    if (this->Renderer)
    {
      this->Renderer->AddActor(actor);
    }
  }
  this->Tool->VisibilityOff();
  this->Arrow->VisibilityOff();
}

pqPalpateToolView::~pqPalpateToolView()
{
  for (vtkActor* actor : { this->Nodes.Get(), this->Tool.Get(), this->Arrow.Get() })
  {
    if (this->Renderer)
    {
      this->Renderer->RemoveActor(actor);
    }
  }
}

void pqPalpateToolView::Show(const palpate::Tick& tick, bool free)
{
  const palpate::Contact& contact = tick.contact;
  const bool touches = contact.status == palpate::ContactStatus::attached;
  const palpate::Vec3 place =
    touches ? palpate::Vec3(contact.anchor + contact.displacement) : tick.position;
  this->Tool->SetVisibility(touches || free);
  this->Tool->SetPosition(place.x(), place.y(), place.z());

  const double force = contact.force.norm();
  this->Arrow->SetVisibility(touches && force > 0 && std::isfinite(force));
  if (!this->Arrow->GetVisibility())
  {
    return;
  }
  // From the arrow's own axis, x, to the force, at the tool.
  const palpate::Vec3 along = contact.force / force;
  const palpate::Vec3 across = along.unitOrthogonal();
  const palpate::Vec3 third = along.cross(across);
  const double length = this->ArrowScale * force;
  vtkNew<vtkMatrix4x4> matrix;
  for (int i = 0; i < 3; ++i)
  {
    matrix->SetElement(i, 0, length * along[i]);
    matrix->SetElement(i, 1, length * across[i]);
    matrix->SetElement(i, 2, length * third[i]);
    matrix->SetElement(i, 3, place[i]);
  }
  this->Arrow->SetUserMatrix(matrix);
}
