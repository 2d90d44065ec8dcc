// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateMouse.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "pqPalpateHit.h"
#include "vtkCamera.h"
#include "vtkCellArray.h"
#include "vtkCommand.h"
#include "vtkInteractorObserver.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkStaticCellLocator.h"

using palpate::Vec3;

namespace
{
/// Before ParaView's own, which are at 0.
constexpr float Priority = 10;
/// Shares of the body's diagonal: how far outside of the body the tool waits; how far it goes in
/// before the mouse has moved; how far from an active node a press still takes hold of it; a notch
/// of the wheel.
constexpr double Clearance = 0.02;
constexpr double Overshoot = 0.002;
constexpr double Reach = 0.1;
constexpr double Notch = 0.01;
/// Of the half-width of the space: the drag ends within it, however the board rounds.
constexpr double Within = 0.999;
/// Of the body's diagonal: what is less far behind the surface is on it.
constexpr double OnSurface = 1e-3;
}

pqPalpateMouse::pqPalpateMouse(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space,
  std::shared_ptr<const palpate::Touchable> body, std::shared_ptr<palpate::MouseMotion> motion)
  : Body(std::move(body))
  , Motion(std::move(motion))
  , Interactor(view->GetInteractor())
  , Renderer(view->GetRenderer())
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec3& point : space.surface.points)
  {
    points->InsertNextPoint(point.data());
  }
  vtkNew<vtkCellArray> triangles;
  for (const auto& [a, b, c] : space.surface.triangles)
  {
    triangles->InsertNextCell({ a, b, c });
  }
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(points);
  surface->SetPolys(triangles);
  this->Surface->SetDataSet(surface);
  this->Surface->BuildLocator();
  for (const palpate::TouchToolSpace& toolSpace : space.tool_spaces)
  {
    this->HalfWidths.push_back(toolSpace.setup.grid.half_width);
  }
  const auto& bounds = this->Body->surface().bounds();
  this->Size = bounds.diagonal().norm();
  this->Centre = bounds.max() + bounds.diagonal();
  this->Hint = "Press the left button on the body\nnear a black dot, and drag.";

  if (this->Interactor)
  {
    for (const unsigned long event :
      { vtkCommand::LeftButtonPressEvent, vtkCommand::LeftButtonReleaseEvent,
        vtkCommand::LeftButtonDoubleClickEvent, vtkCommand::MouseMoveEvent,
        vtkCommand::MouseWheelForwardEvent, vtkCommand::MouseWheelBackwardEvent })
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

void pqPalpateMouse::GoOnFrom(const pqPalpateMouse& other)
{
  const auto& nodes = this->Body->nodes();
  const auto& others = other.Body->nodes();
  const bool areSame = this->HalfWidths == other.HalfWidths &&
    std::equal(nodes.begin(), nodes.end(), others.begin(), others.end(),
      [](const auto& a, const auto& b)
      { return a.mesh_point == b.mesh_point && a.rest_position == b.rest_position; });
  if (!areSame)
  {
    this->Motion->set_target(this->Target);
    return;
  }
  this->Phase = other.Phase;
  this->Hint = other.Hint;
  this->Pressed = other.Pressed;
  this->Wanted = other.Wanted;
  this->Node = other.Node;
  this->Normal = other.Normal;
  this->Grip = other.Grip;
  this->Depth = other.Depth;
  this->Displacement = other.Displacement;
  this->Centre = other.Centre;
  this->Target = other.Target;
}

bool pqPalpateMouse::HandleEvent(vtkObject*, unsigned long event, void*)
{
  switch (event)
  {
    case vtkCommand::LeftButtonPressEvent:
    case vtkCommand::LeftButtonDoubleClickEvent:
      return this->Press();
    case vtkCommand::MouseMoveEvent:
      this->Drag();
      return this->Pressed;
    case vtkCommand::MouseWheelForwardEvent:
    case vtkCommand::MouseWheelBackwardEvent:
      if (this->Pressed && this->Renderer)
      {
        const double sign = event == vtkCommand::MouseWheelForwardEvent ? 1 : -1;
        const Vec3 away(this->Renderer->GetActiveCamera()->GetDirectionOfProjection());
        this->Depth += sign * Notch * this->Size * away;
        this->Drag();
      }
      return this->Pressed;
    default:
      return std::exchange(this->Pressed, false);
  }
}

bool pqPalpateMouse::Press()
{
  if (!this->Renderer || !this->Interactor || this->Interactor->GetControlKey())
  {
    return false;
  }
  double hit[3];
  if (!pqPalpateHit(this->Renderer, this->Surface, this->Interactor->GetEventPosition(), hit))
  {
    return false;
  }
  const Vec3 place(hit);
  this->Wanted =
    this->Body->nearest(place, std::max(Reach * this->Size, this->Body->largest_tip_radius()));
  if (this->Wanted < 0)
  {
    this->Hint = this->WayToNearest(place);
    return false;
  }
  this->Hint.clear();
  this->Pressed = true;
  this->Grip = place;
  this->Depth.setZero();
  this->Displacement.setZero();
  return true;
}

std::string pqPalpateMouse::WayToNearest(const Vec3& place) const
{
  const int node = this->Body->nearest(place, std::numeric_limits<double>::infinity());
  const Vec3& rest = this->Body->nodes()[node].rest_position;
  char text[100];
  std::snprintf(text, sizeof text, "Press near a black dot: the nearest is\n%.0f mm away%s",
    1e3 * (rest - place).norm(),
    this->IsHidden(rest) ? ", on the other side. A drag turns the body." : ".");
  return text;
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

void pqPalpateMouse::Drag()
{
  if (!this->Pressed || !this->Renderer || !this->Interactor)
  {
    return;
  }
  const Vec3 moved = this->PointUnderCursor(this->Grip) - this->Grip + this->Depth;
  // No further than the space goes.
  const double most = Within * this->HalfWidths[this->Wanted];
  const double least = moved.cwiseAbs().maxCoeff();
  this->Displacement = least > most ? Vec3(most / least * moved) : moved;
}

void pqPalpateMouse::SetTarget(const Vec3& place)
{
  this->Target = place - this->Centre;
  this->Motion->set_target(this->Target);
}

Vec3 pqPalpateMouse::Outside() const
{
  return this->Body->nodes()[this->Node].rest_position + Clearance * this->Size * this->Normal;
}

void pqPalpateMouse::Advance(const palpate::Tick& tick)
{
  const bool attached = tick.contact.status == palpate::ContactStatus::attached;
  if (this->Phase == Phases::Away && this->Pressed)
  {
    this->Node = this->Wanted;
    const Vec3& rest = this->Body->nodes()[this->Node].rest_position;
    this->Normal = this->Body->surface().nearest(rest).normal;
    // The point stands still, and the workspace is moved so that it is outside of this node.
    this->Centre = this->Outside() - this->Target;
    this->Phase = Phases::Coming;
  }
  else if (this->Phase == Phases::Coming)
  {
    this->SetTarget(
      this->Body->nodes()[this->Node].rest_position - Overshoot * this->Size * this->Normal);
    if (attached)
    {
      this->Phase = Phases::Holding;
    }
    else if (!this->Pressed)
    {
      this->Phase = Phases::Leaving;
    }
  }
  if (this->Phase == Phases::Holding)
  {
    if (this->Pressed && this->Wanted == this->Node)
    {
      this->SetTarget(tick.contact.anchor + this->Displacement);
    }
    else
    {
      this->Phase = Phases::Leaving;
    }
  }
  if (this->Phase == Phases::Leaving)
  {
    this->SetTarget(this->Outside());
    const double left = (this->Outside() - tick.position).norm();
    if (!attached && left < Overshoot * this->Size)
    {
      this->Phase = Phases::Away;
    }
  }
}
