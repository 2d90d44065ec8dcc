// SPDX-License-Identifier: BSD-3-Clause
/// The mouse as a hand that holds active nodes. A press of the left button on the body takes hold
/// of the nearest one, a drag moves it in the plane of the view, the wheel away from the viewer and
/// back, and letting go of the button lets go of the node. A press on the body where no active node
/// is near says where one is. That one, a press beside the body, and one with Ctrl move the camera
/// as ever.
///
/// The tool is put outside of the node, moved straight in until it is attached, then to where the
/// mouse is, and at last outside again.
#pragma once

#include "haptic/touching/touchable.h"
#include "pqPalpateMouse.h"
#include "vtkPalpateStateSpace.h"

class pqPalpateNodeMouse : public pqPalpateMouse
{
public:
  pqPalpateNodeMouse(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space,
    std::shared_ptr<const palpate::Touchable> body, std::shared_ptr<palpate::MouseMotion> motion);

  /// What is held is held on, where the nodes of the two spaces are the same.
  void GoOnFrom(const pqPalpateMouse& other) override;
  void Advance(const palpate::Tick& tick) override;
  bool IsHolding() const override { return this->Phase == Phases::Holding; }

protected:
  bool Press() override;
  void Drag() override;
  void Turn(int notches) override;

private:
  enum class Phases
  {
    /// Outside of the body, where it is not seen.
    Away,
    /// On its way into the node.
    Coming,
    Holding,
    /// On its way out.
    Leaving
  };

  palpate::Vec3 Outside() const;

  std::shared_ptr<const palpate::Touchable> Body;
  /// By node, m: how far the space goes.
  std::vector<double> HalfWidths;
  Phases Phase = Phases::Away;
  /// The node that the button was pressed at last, and the one that is touched.
  int Wanted = -1;
  int Node = -1;
  palpate::Vec3 Normal = palpate::Vec3::Zero();
  /// Where the button was pressed, and what the wheel adds, m.
  palpate::Vec3 Grip = palpate::Vec3::Zero();
  palpate::Vec3 Depth = palpate::Vec3::Zero();
  palpate::Vec3 Displacement = palpate::Vec3::Zero();
};
