// SPDX-License-Identifier: BSD-3-Clause
/// The mouse as a hand that holds one tool of a reduced body. A press of the left button on the
/// body near the tool's blue dot takes hold of it, a drag moves it in the plane of the view, the
/// wheel away from the viewer and back, and letting go of the button lets go of it: then it moves
/// with the body. A press elsewhere on the body says where the dot is. That one, a press beside the
/// body, and one with Ctrl move the camera as ever.
///
/// As long as it does not hold the tool it goes where that is.
#pragma once

#include "pqPalpateMouse.h"

class pqPalpateReducedMouse : public pqPalpateMouse
{
public:
  /// @param place Of the tool at rest, m.
  pqPalpateReducedMouse(vtkSMRenderViewProxy* view, const palpate::Surface& surface,
    const palpate::Vec3& place, std::shared_ptr<palpate::MouseMotion> motion);

  void Advance(const palpate::Tick& tick) override;

protected:
  bool Press() override;
  void Drag() override;
  void Turn(int notches) override;

private:
  palpate::Vec3 Place;
  /// Where the button was pressed, what the wheel has added, and how far both have led, m.
  palpate::Vec3 Grip = palpate::Vec3::Zero();
  palpate::Vec3 Depth = palpate::Vec3::Zero();
  palpate::Vec3 Moved = palpate::Vec3::Zero();
  /// Where the hand is as long as it does not hold, and where it took hold, m.
  palpate::Vec3 Hand = palpate::Vec3::Zero();
};
