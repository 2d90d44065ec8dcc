// SPDX-License-Identifier: BSD-3-Clause
/// The mouse as a hand that holds one tool of a reduced body. A press of the left button on the
/// body near the tool's blue dot takes hold of the tool. A drag moves it in the plane of the view,
/// the wheel moves it away from the viewer and back, and letting go of the button lets go of the
/// tool, which then moves with the body. A press elsewhere on the body says where the dot is. Such
/// a press, a press beside the body, and one with Ctrl move the camera as usual.
///
/// While the hand does not hold the tool, it follows the tool.
#pragma once

#include "pqPalpateMouse.h"

class pqPalpateReducedMouse : public pqPalpateMouse
{
public:
  /// @param place The place of the tool at rest, m.
  pqPalpateReducedMouse(vtkSMRenderViewProxy* view, const palpate::Surface& surface,
    const palpate::Vec3& place, std::shared_ptr<palpate::MouseMotion> motion);

  void Advance(const palpate::Tick& tick) override;

protected:
  bool Press() override;
  void Drag() override;
  void Turn(int notches) override;

private:
  palpate::Vec3 Place;
  /// The place where the button was pressed, the displacement that the wheel has added, and the
  /// displacement that follows from both, m.
  palpate::Vec3 Grip = palpate::Vec3::Zero();
  palpate::Vec3 Depth = palpate::Vec3::Zero();
  palpate::Vec3 Moved = palpate::Vec3::Zero();
  /// The place of the hand while it does not hold the tool; then the place where it took hold, m.
  palpate::Vec3 Hand = palpate::Vec3::Zero();
};
