// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateMouse.h"

#include <cstdio>
#include <cstring>
#include <utility>

#include "pqPalpateHit.h"
#include "vtkCamera.h"
#include "vtkCellArray.h"
#include "vtkCommand.h"
#include "vtkInteractorObserver.h"
#include "vtkPalpateGuard.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkStaticCellLocator.h"

using palpate::Vec3;

namespace
{
/// The observers come before ParaView's own, which have the priority 0.
constexpr float Priority = 10;
/// A place that is less far behind the surface than this share of the body's diagonal counts as on
/// it.
constexpr double OnSurface = 1e-3;
constexpr const char* Ctrl = "Control_";
}

pqPalpateMouse::pqPalpateMouse(vtkSMRenderViewProxy* view, const palpate::Surface& surface,
  std::shared_ptr<palpate::MouseMotion> motion)
  : Interactor(view->GetInteractor())
  , Renderer(view->GetRenderer())
  , Motion(std::move(motion))
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  Eigen::AlignedBox3d bounds;
  for (const Vec3& point : surface.points)
  {
    points->InsertNextPoint(point.data());
    bounds.extend(point);
  }
  vtkNew<vtkCellArray> triangles;
  for (const auto& [a, b, c] : surface.triangles)
  {
    triangles->InsertNextCell({ a, b, c });
  }
  vtkNew<vtkPolyData> whole;
  whole->SetPoints(points);
  whole->SetPolys(triangles);
  this->Surface->SetDataSet(whole);
  this->Surface->BuildLocator();
  this->Size = bounds.diagonal().norm();
  this->Centre = bounds.max() + bounds.diagonal();

  if (this->Interactor)
  {
    for (const unsigned long event :
      { vtkCommand::LeftButtonPressEvent, vtkCommand::LeftButtonReleaseEvent,
        vtkCommand::LeftButtonDoubleClickEvent, vtkCommand::MouseMoveEvent,
        vtkCommand::MouseWheelForwardEvent, vtkCommand::MouseWheelBackwardEvent,
        vtkCommand::KeyPressEvent, vtkCommand::KeyReleaseEvent })
    {
      this->Observers.push_back(
        this->Interactor->AddObserver(event, this, &pqPalpateMouse::HandleEvent, Priority));
    }
  }
}

pqPalpateMouse::~pqPalpateMouse()
{
  for (const unsigned long observer : this->Observers)
  {
    if (this->Interactor)
    {
      this->Interactor->RemoveObserver(observer);
    }
  }
}

void pqPalpateMouse::TakeOver(const pqPalpateMouse& other)
{
  this->Pressed = other.Pressed;
  this->Hint = other.Hint;
  this->Centre = other.Centre;
  this->Target = other.Target;
}

bool pqPalpateMouse::HandleEvent(vtkObject* sender, unsigned long event, void*)
{
  if (!this->Renderer || !this->Interactor)
  {
    return false;
  }
  return vtkPalpateGuard(sender, [&] { return this->Handle(event) ? 1 : 0; }) != 0;
}

bool pqPalpateMouse::Handle(unsigned long event)
{
  switch (event)
  {
    case vtkCommand::LeftButtonPressEvent:
    case vtkCommand::LeftButtonDoubleClickEvent:
      this->Pressed = !this->CtrlIsHeld() && this->Press();
      return this->Pressed;
    case vtkCommand::MouseMoveEvent:
      if (this->Pressed)
      {
        this->HoldCtrl(this->CtrlIsHeld());
        this->Drag();
      }
      else
      {
        this->Hover();
      }
      return this->Pressed;
    case vtkCommand::MouseWheelForwardEvent:
    case vtkCommand::MouseWheelBackwardEvent:
      if (this->Pressed)
      {
        this->Turn(event == vtkCommand::MouseWheelForwardEvent ? 1 : -1);
      }
      return this->Pressed;
    case vtkCommand::KeyPressEvent:
    case vtkCommand::KeyReleaseEvent:
    {
      const char* key = this->Interactor->GetKeySym();
      if (this->Pressed && key && std::strncmp(key, Ctrl, std::strlen(Ctrl)) == 0)
      {
        this->HoldCtrl(event == vtkCommand::KeyPressEvent);
      }
      return false;
    }
    default:
      return std::exchange(this->Pressed, false);
  }
}

bool pqPalpateMouse::Find(Vec3& place) const
{
  return pqPalpateHit(
    this->Renderer, this->Surface, this->Interactor->GetEventPosition(), place.data());
}

bool pqPalpateMouse::IsHidden(const Vec3& place) const
{
  double seen[3];
  vtkInteractorObserver::ComputeWorldToDisplay(
    this->Renderer, place.x(), place.y(), place.z(), seen);
  double near[4];
  vtkInteractorObserver::ComputeDisplayToWorld(this->Renderer, seen[0], seen[1], 0, near);
  double along;
  double hit[3];
  double parametric[3];
  int subId;
  const Vec3 eye(near);
  const Vec3 before = place + OnSurface * this->Size * (eye - place).normalized();
  const int hits =
    this->Surface->IntersectWithLine(near, before.data(), 0, along, hit, parametric, subId);
  return hits != 0;
}

std::string pqPalpateMouse::WayTo(const char* what, const Vec3& node, const Vec3& pressed) const
{
  char text[100];
  std::snprintf(text, sizeof text, "%s\n%.0f mm away%s", what, 1e3 * (node - pressed).norm(),
    this->IsHidden(node) ? ", on the other side. A drag turns the body." : ".");
  return text;
}

Vec3 pqPalpateMouse::PointUnderCursor(const Vec3& depthOf) const
{
  double display[3];
  vtkInteractorObserver::ComputeWorldToDisplay(
    this->Renderer, depthOf.x(), depthOf.y(), depthOf.z(), display);
  const int* pixel = this->Interactor->GetEventPosition();
  double world[4];
  vtkInteractorObserver::ComputeDisplayToWorld(
    this->Renderer, pixel[0], pixel[1], display[2], world);
  return Vec3(world);
}

Vec3 pqPalpateMouse::Away() const
{
  return Vec3(this->Renderer->GetActiveCamera()->GetDirectionOfProjection());
}

bool pqPalpateMouse::CtrlIsHeld() const
{
  return this->Interactor->GetControlKey() != 0;
}

void pqPalpateMouse::SetTarget(const Vec3& place, bool grasps)
{
  this->Target = place - this->Centre;
  this->Motion->set_target(
    this->Target, static_cast<std::uint8_t>(grasps ? 1U << pqPalpateGraspButton : 0U));
}
