// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateReducedMouse.h"

#include <utility>

using palpate::Vec3;

pqPalpateReducedMouse::pqPalpateReducedMouse(vtkSMRenderViewProxy* view,
  const palpate::Surface& surface, const Vec3& place, std::shared_ptr<palpate::MouseMotion> motion)
  : pqPalpateMouse(view, surface, std::move(motion))
  , Place(place)
  , Hand(place)
{
  this->PutTo(place);
  this->Hint = "Press the left button on the body\nnear the blue dot, and drag.";
}

bool pqPalpateReducedMouse::Press()
{
  Vec3 pressed;
  if (!this->Find(pressed))
  {
    return false;
  }
  if ((pressed - this->Place).norm() > Reach * this->Size)
  {
    this->Hint = this->WayTo("Press near the blue dot: it is", this->Place, pressed);
    return false;
  }
  this->Hint.clear();
  this->Grip = pressed;
  this->Depth.setZero();
  this->Moved.setZero();
  return true;
}

void pqPalpateReducedMouse::Drag()
{
  this->Moved = this->PointUnderCursor(this->Grip) - this->Grip + this->Depth;
}

void pqPalpateReducedMouse::Turn(int notches)
{
  this->Depth += notches * Notch * this->Size * this->Away();
  this->Drag();
}

void pqPalpateReducedMouse::Advance(const palpate::Tick& tick)
{
  if (!this->Pressed)
  {
    this->Hand = this->Place + tick.contact.displacement;
  }
  this->SetTarget(this->Pressed ? Vec3(this->Hand + this->Moved) : this->Hand, this->Pressed);
}
