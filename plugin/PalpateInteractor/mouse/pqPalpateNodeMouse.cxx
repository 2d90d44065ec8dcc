// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateNodeMouse.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

using palpate::Vec3;

namespace
{
/// Shares of the body's diagonal: how far outside of the body the tool waits; how far it goes in
/// before the mouse has moved.
constexpr double Clearance = 0.02;
constexpr double Overshoot = 0.002;
/// A drag ends at this share of the half-width, so that it stays within the space however the board
/// rounds.
constexpr double Within = 0.999;
/// The reach of a blade, as a share of the body's diagonal, and how far beside the sheet the mouse
/// leads it, as a share of the reach.
constexpr double ReachOfBlade = 0.05;
constexpr double Beside = 0.5;
}

pqPalpateNodeMouse::pqPalpateNodeMouse(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space,
  std::shared_ptr<const palpate::Touchable> body, std::shared_ptr<palpate::MouseMotion> motion)
  : pqPalpateMouse(view, space.surface, std::move(motion))
  , Body(std::move(body))
{
  for (const palpate::TouchToolSpace& toolSpace : space.tool_spaces)
  {
    this->HalfWidths.push_back(toolSpace.setup.grid.half_width);
  }
  this->PutHint();
}

void pqPalpateNodeMouse::PutHint()
{
  this->Hint = this->IsBlade
    ? "Press the left button on the dark line\nwhere the cut begins or is open, and drag."
    : "Press the left button on the body\nnear a black dot, and drag.";
}

void pqPalpateNodeMouse::SetBlade(bool isBlade)
{
  if (isBlade == this->IsBlade)
  {
    return;
  }
  this->IsBlade = isBlade;
  this->Pressed = false;
  this->PutHint();
  // What is held stays held as the tool becomes a blade, and is let go of as it was one.
  this->Phase = Phases::Away;
}

double pqPalpateNodeMouse::GetReach() const
{
  return this->IsBlade ? ReachOfBlade * this->Size : 0;
}

void pqPalpateNodeMouse::GoOnFrom(const pqPalpateMouse& mouse)
{
  const auto* other = dynamic_cast<const pqPalpateNodeMouse*>(&mouse);
  const auto& nodes = this->Body->nodes();
  // Where the body was cut, its points have other numbers.
  const auto areSame = [](const auto& a, const auto& b)
  { return a.body == b.body && a.rest_position == b.rest_position; };
  if (!other || this->HalfWidths != other->HalfWidths ||
    !std::equal(nodes.begin(), nodes.end(), other->Body->nodes().begin(),
      other->Body->nodes().end(), areSame))
  {
    this->SetTarget(this->GetWorkspaceCentre());
    return;
  }
  this->TakeOver(mouse);
  this->Phase = other->Phase;
  this->IsBlade = other->IsBlade;
  this->Wanted = other->Wanted;
  this->Held = other->Held;
  this->TornArea = other->TornArea;
  this->Pressing = other->Pressing;
  this->Depth = other->Depth;
  this->Displacement = other->Displacement;
}

bool pqPalpateNodeMouse::FindNode(const Vec3& pressed, Grip& grip)
{
  grip.Node =
    this->Body->nearest(pressed, std::max(Reach * this->Size, this->Body->largest_tip_radius()));
  if (grip.Node < 0)
  {
    const int nearest = this->Body->nearest(pressed, std::numeric_limits<double>::infinity());
    this->Hint = this->WayTo("Press near a black dot: the nearest is",
      this->Body->nodes()[nearest].rest_position, pressed);
    return false;
  }
  grip.Place = this->Body->nodes()[grip.Node].rest_position;
  return true;
}

bool pqPalpateNodeMouse::FindCut(const Vec3& pressed, Grip& grip)
{
  // As Blade::enter() has it.
  const palpate::CutSheet::Nearest at =
    this->Body->sheet().nearest(pressed, std::max(this->TornArea, this->Body->torn().areas()[1]));
  const palpate::SurfaceTree::Nearest mouth = this->Body->surface().nearest(at.point);
  if (at.distance > this->GetReach() || std::abs(mouth.distance) > this->GetReach())
  {
    this->Hint = this->WayTo("Press where the cut begins or is open: it is", mouth.point, pressed);
    return false;
  }
  grip.Place = mouth.point;
  return true;
}

bool pqPalpateNodeMouse::Press()
{
  Vec3 place;
  Grip grip;
  if (!this->Find(place) ||
    !(this->IsBlade ? this->FindCut(place, grip) : this->FindNode(place, grip)))
  {
    return false;
  }
  grip.Normal = this->Body->surface().nearest(grip.Place).normal;
  this->Hint.clear();
  this->Wanted = grip;
  this->Pressing = place;
  this->Depth.setZero();
  this->Displacement.setZero();
  return true;
}

void pqPalpateNodeMouse::Turn(int notches)
{
  this->Depth += notches * Notch * this->Size * this->Away();
  this->Drag();
}

void pqPalpateNodeMouse::Drag()
{
  const Vec3 moved = this->PointUnderCursor(this->Pressing) - this->Pressing + this->Depth;
  if (this->Wanted.Node < 0)
  {
    this->Displacement = moved;
    return;
  }
  // The displacement is cut to the tool space.
  const double most = Within * this->HalfWidths[this->Wanted.Node];
  const double least = moved.cwiseAbs().maxCoeff();
  this->Displacement = least > most ? Vec3(most / least * moved) : moved;
}

Vec3 pqPalpateNodeMouse::Outside() const
{
  return this->Held.Place + Clearance * this->Size * this->Held.Normal;
}

Vec3 pqPalpateNodeMouse::Dragged(const palpate::Contact& contact) const
{
  if (this->Held.Node >= 0)
  {
    return contact.anchor + this->Displacement;
  }
  // The mouse moves in the plane of the view, which need not be that of the cut.
  const Vec3 place = this->Held.Place + this->Displacement;
  const palpate::CutSheet::Nearest at =
    this->Body->sheet().nearest(place, std::numeric_limits<double>::infinity());
  const double most = Beside * this->GetReach();
  return at.distance > most ? Vec3(at.point + most / at.distance * (place - at.point)) : place;
}

void pqPalpateNodeMouse::Advance(const palpate::Tick& tick)
{
  this->TornArea = tick.contact.torn_area;
  const bool attached = tick.contact.status ==
    (this->IsBlade ? palpate::ContactStatus::cutting : palpate::ContactStatus::attached);
  if (this->Phase == Phases::Kept && this->Pressed)
  {
    this->Phase = Phases::Leaving;
  }
  if (this->Phase == Phases::Away && this->Pressed)
  {
    this->Held = this->Wanted;
    this->PutTo(this->Outside());
    this->Phase = Phases::Coming;
  }
  else if (this->Phase == Phases::Coming)
  {
    this->SetTarget(this->Held.Place - Overshoot * this->Size * this->Held.Normal);
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
    if (this->Pressed && this->Wanted == this->Held)
    {
      this->SetTarget(this->Dragged(tick.contact));
    }
    else
    {
      const bool stays = !this->IsBlade && this->Body->torn().is_cut() && this->CtrlIsHeld();
      this->Phase = stays ? Phases::Kept : Phases::Leaving;
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
