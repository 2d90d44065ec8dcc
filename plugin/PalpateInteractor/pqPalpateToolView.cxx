// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateToolView.h"

#include <algorithm>
#include <cmath>

#include "vtkArrowSource.h"
#include "vtkCoordinate.h"
#include "vtkGlyph3D.h"
#include "vtkMatrix4x4.h"
#include "vtkPVRenderView.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSphereSource.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"

namespace
{
/// Of the diagonal of the body.
constexpr double ToolRadius = 0.012;
constexpr double LongestArrow = 0.4;
constexpr double NodeRadius = 0.008;
constexpr double RimRadius = 0.012;

constexpr int TextSize = 14;
/// Of the height of the view.
constexpr double TextPlace = 0.98;

/// Units of depth that bring anything to the front: a force that points into the body is seen too.
constexpr double ToFront = -66000;
/// A dot in front of its rim, and behind what is in front of both.
constexpr double ToRim = -20000;

// Real spheres: points that a driver shall draw as spheres are not drawn at all by Mesa's llvmpipe.
void ShowSpheres(
  vtkActor* actor, vtkPolyData* places, double radius, double brightness, double offset)
{
  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(radius);
  vtkNew<vtkGlyph3D> spheres;
  spheres->SetInputData(places);
  spheres->SetSourceConnection(sphere->GetOutputPort());
  spheres->ScalingOff();
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(spheres->GetOutputPort());
  mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(0, offset);
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(brightness, brightness, brightness);
  actor->GetProperty()->LightingOff();
}

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
  double largestForce = 0;
  double radius = ToolRadius * size;
  for (const palpate::TouchToolSpace& toolSpace : space.tool_spaces)
  {
    points->InsertNextPoint(toolSpace.setup.interaction.material_point.data());
    radius = std::max(radius, toolSpace.setup.interaction.tip_radius);
    for (const palpate::ConfigurationSummary& configuration : toolSpace.configurations)
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
  ShowSpheres(this->Rims, nodes, RimRadius * size, 1, 0);
  ShowSpheres(this->Nodes, nodes, NodeRadius * size, 0, ToRim);

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
  for (vtkActor* actor : this->GetActors())
  {
    actor->PickableOff();
    if (this->Renderer)
    {
      this->Renderer->AddActor(actor);
    }
  }
  this->Tool->VisibilityOff();
  this->Arrow->VisibilityOff();

  vtkTextProperty* style = this->Text->GetTextProperty();
  style->SetFontSize(TextSize);
  style->SetColor(0, 0, 0);
  style->SetBackgroundColor(1, 1, 0.85);
  style->SetBackgroundOpacity(0.85);
  style->SetJustificationToCentered();
  style->SetVerticalJustificationToTop();
  this->Text->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  this->Text->SetPosition(0.5, TextPlace);
  this->Text->PickableOff();
  this->Text->VisibilityOff();
  if (this->Renderer)
  {
    this->Renderer->AddViewProp(this->Text);
  }
}

pqPalpateToolView::~pqPalpateToolView()
{
  for (vtkActor* actor : this->GetActors())
  {
    if (this->Renderer)
    {
      this->Renderer->RemoveActor(actor);
    }
  }
  if (this->Renderer)
  {
    this->Renderer->RemoveViewProp(this->Text);
  }
}

bool pqPalpateToolView::Say(const std::string& text)
{
  const char* before = this->Text->GetInput();
  if (text == (before ? before : ""))
  {
    return false;
  }
  this->Text->SetInput(text.c_str());
  this->Text->SetVisibility(!text.empty());
  return true;
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
