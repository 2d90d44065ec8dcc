// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateNodeMouse.h"

#include <algorithm>
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
  this->Hint = "Press the left button on the body\nnear a black dot, and drag.";
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
  this->Wanted = other->Wanted;
  this->Node = other->Node;
  this->Normal = other->Normal;
  this->Grip = other->Grip;
  this->Depth = other->Depth;
  this->Displacement = other->Displacement;
}

bool pqPalpateNodeMouse::Press()
{
  Vec3 place;
  if (!this->Find(place))
  {
    return false;
  }
  this->Wanted =
    this->Body->nearest(place, std::max(Reach * this->Size, this->Body->largest_tip_radius()));
  if (this->Wanted < 0)
  {
    const int nearest = this->Body->nearest(place, std::numeric_limits<double>::infinity());
    this->Hint = this->WayTo(
      "Press near a black dot: the nearest is", this->Body->nodes()[nearest].rest_position, place);
    return false;
  }
  this->Hint.clear();
  this->Grip = place;
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
  const Vec3 moved = this->PointUnderCursor(this->Grip) - this->Grip + this->Depth;
  // The displacement is cut to the tool space.
  const double most = Within * this->HalfWidths[this->Wanted];
  const double least = moved.cwiseAbs().maxCoeff();
  this->Displacement = least > most ? Vec3(most / least * moved) : moved;
}

Vec3 pqPalpateNodeMouse::Outside() const
{
  return this->Body->nodes()[this->Node].rest_position + Clearance * this->Size * this->Normal;
}

void pqPalpateNodeMouse::Advance(const palpate::Tick& tick)
{
  const bool attached = tick.contact.status == palpate::ContactStatus::attached;
  if (this->Phase == Phases::Away && this->Pressed)
  {
    this->Node = this->Wanted;
    const Vec3& rest = this->Body->nodes()[this->Node].rest_position;
    this->Normal = this->Body->surface().nearest(rest).normal;
    this->PutTo(this->Outside());
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
