// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateToolMouse.h"

#include <algorithm>
#include <utility>

#include "haptic/touching/pressing_range.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"

using palpate::Vec3;

namespace
{
/// No cell in which the tool may touch reaches farther out than this, in sides of the coarsest
/// cells.
constexpr double RoomOfCell = 2;
/// The depth of the first press and the way of a notch of the wheel, as shares of the largest
/// depth.
constexpr double FirstDepth = 0.5;
constexpr double DepthNotch = 0.05;
/// The tool has left when it is this near to the place to which it leaves, as a share of the body's
/// diagonal.
constexpr double Near = 0.002;
/// The place that is pointed at has jumped to another part of the body when it has moved this many
/// times as far as the pointer has in the plane of the view.
constexpr double Jump = 4;
/// The search for the place where the tool touches ends at this distance, in half-widths of the
/// tool.
constexpr double CloseEnough = 1e-4;
constexpr int MostSteps = 60;
constexpr const char* NoNodeNear = "No black dot is near: there is nothing to hold.";
constexpr const char* SpaceEnds =
  "The space ends here. Let go, and press\nwhere the body is not grey.";
constexpr const char* NotYetKnown = "This place is being computed:\nthere is a force in a moment.";
}

pqPalpateToolMouse::pqPalpateToolMouse(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space,
  std::shared_ptr<const palpate::Touchable> body, std::shared_ptr<palpate::MouseMotion> motion,
  std::vector<char> pressable, bool grows)
  : pqPalpateMouse(view, space.surface, std::move(motion))
  , Body(std::move(body))
  , Normals(palpate::point_normals(space.surface))
  , Pressable(std::move(pressable))
  , IsUnknown(grows ? NotYetKnown : SpaceEnds)
{
  if (const palpate::TouchToolSpace* toolSpace = space.find_pressing())
  {
    const palpate::ToolSpaceSetup& setup = toolSpace->setup;
    this->Shape = setup.interaction.tool;
    this->Clearance = toolSpace->clearance;
    this->Room = RoomOfCell * setup.grid.coarsest * setup.grid.spacing();
    this->Deepest = setup.depth();
  }
  this->Depth = FirstDepth * this->Deepest;
  this->Welcome = "Press the left button on the body and drag:\nthe tool glides. The wheel presses "
                  "deeper.";
  if (!this->Body->nodes().empty())
  {
    this->Welcome += "\nCtrl takes hold near a black dot.";
  }
  this->Hint = this->Welcome;
}

pqPalpateToolMouse::~pqPalpateToolMouse()
{
  this->ShowCursor(false);
}

void pqPalpateToolMouse::GoOnFrom(const pqPalpateMouse& mouse)
{
  if (const auto* other = dynamic_cast<const pqPalpateToolMouse*>(&mouse))
  {
    const bool isWelcome = other->Hint == other->Welcome;
    this->TakeOver(mouse);
    if (isWelcome)
    {
      this->Hint = this->Welcome;
    }
    this->Phase = other->Phase;
    this->IsOverBody = other->IsOverBody;
    this->Pointed = other->Pointed;
    this->Normal = other->Normal;
    this->Touching = other->Touching;
    this->Depth = std::min(other->Depth, this->Deepest);
    this->Exit = other->Exit;
    this->Grasps = other->Grasps;
    this->GraspedAt = other->GraspedAt;
    this->Grip = other->Grip;
    this->Pulled = other->Pulled;
    this->Dragged = other->Dragged;
  }
}

void pqPalpateToolMouse::ShowCursor(bool presses)
{
  if (this->Renderer && this->Renderer->GetRenderWindow())
  {
    this->Renderer->GetRenderWindow()->SetCurrentCursor(
      presses ? VTK_CURSOR_CROSSHAIR : VTK_CURSOR_DEFAULT);
  }
}

void pqPalpateToolMouse::PointAt(const Vec3& place)
{
  const palpate::SurfaceTree::Nearest at = this->Body->surface().nearest(place);
  const auto& points = this->Body->surface().points_of(at.triangle);
  this->Pointed = place;
  this->Normal.setZero();
  for (int k = 0; k < 3; ++k)
  {
    this->Normal += at.weights[k] * this->Normals[static_cast<std::size_t>(points[k])];
  }
  this->Normal.normalize();
  // The tool moves inward as far as it is surely free, because it may touch another part of the
  // body first.
  this->Touching = palpate::touching_place(this->Shape, place, this->Normal) +
    (this->Room + palpate::half_width(this->Shape)) * this->Normal;
  for (int step = 0; step < MostSteps; ++step)
  {
    const double free = this->Clearance(this->Touching);
    if (free < CloseEnough * palpate::half_width(this->Shape))
    {
      break;
    }
    this->Touching -= free * this->Normal;
  }
}

bool pqPalpateToolMouse::Point()
{
  Vec3 place;
  this->IsOverBody = this->Find(place);
  if (!this->IsOverBody)
  {
    return false;
  }
  this->PointAt(place);
  const palpate::SurfaceTree::Nearest at = this->Body->surface().nearest(place);
  int nearest = 0;
  at.weights.maxCoeff(&nearest);
  const auto& points = this->Body->surface().points_of(at.triangle);
  return this->Pressable[static_cast<std::size_t>(points[static_cast<std::size_t>(nearest)])] != 0;
}

Vec3 pqPalpateToolMouse::Above() const
{
  return this->Touching + this->Room * this->Normal;
}

Vec3 pqPalpateToolMouse::In() const
{
  return this->Touching - this->Depth * this->Normal;
}

void pqPalpateToolMouse::Hover()
{
  this->ShowCursor(this->Point());
}

bool pqPalpateToolMouse::Press()
{
  if (this->Point())
  {
    this->Hint.clear();
    this->Grasps = false;
    return true;
  }
  if (this->IsOverBody)
  {
    this->Hint = "The space does not reach here. Press\nwhere the body is not grey.";
  }
  return false;
}

void pqPalpateToolMouse::Drag()
{
  const Vec3 moved = this->PointUnderCursor(this->Grasps ? this->Grip : this->Pointed);
  if (this->Grasps)
  {
    this->Dragged = moved - this->Grip;
    return;
  }
  Vec3 place;
  if (!this->Find(place))
  {
    return;
  }
  const double most = Jump * ((moved - this->Pointed).norm() + palpate::half_width(this->Shape));
  if ((place - this->Pointed).norm() <= most)
  {
    this->PointAt(place);
  }
}

void pqPalpateToolMouse::Turn(int notches)
{
  if (this->Grasps)
  {
    this->Pulled += notches * Notch * this->Size * this->Away();
  }
  else
  {
    this->Depth =
      std::min(std::max(this->Depth + notches * DepthNotch * this->Deepest, 0.0), this->Deepest);
  }
}

void pqPalpateToolMouse::HoldCtrl(bool held)
{
  if (held == this->Grasps || this->Body->nodes().empty())
  {
    return;
  }
  this->Grasps = held;
  if (held)
  {
    this->GraspedAt = this->In();
    this->Grip = this->PointUnderCursor(this->Pointed);
    this->Pulled.setZero();
    this->Dragged.setZero();
  }
}

void pqPalpateToolMouse::Advance(const palpate::Tick& tick)
{
  const palpate::ContactStatus status = tick.contact.status;
  switch (this->Phase)
  {
    case Phases::Hovering:
      if (this->IsOverBody)
      {
        this->PutTo(this->Above());
      }
      if (this->Pressed)
      {
        this->Phase = Phases::Pressing;
      }
      break;
    case Phases::Pressing:
      if (this->Pressed)
      {
        const Vec3 held = this->GraspedAt + this->Dragged + this->Pulled;
        this->SetTarget(this->Grasps ? held : this->In(), this->Grasps);
        if (status == palpate::ContactStatus::inside)
        {
          this->Hint = this->IsUnknown;
        }
        else if (this->Hint == this->IsUnknown || this->Hint == NoNodeNear)
        {
          this->Hint.clear();
        }
        if (this->Grasps && status == palpate::ContactStatus::pressing)
        {
          this->Hint = NoNodeNear;
        }
        break;
      }
      this->Grasps = false;
      this->Exit = this->Above();
      this->Phase = Phases::Leaving;
      [[fallthrough]];
    case Phases::Leaving:
      this->SetTarget(this->Exit);
      if (status == palpate::ContactStatus::free &&
        (this->Exit - tick.position).norm() < Near * this->Size)
      {
        this->Phase = Phases::Hovering;
      }
  }
}
