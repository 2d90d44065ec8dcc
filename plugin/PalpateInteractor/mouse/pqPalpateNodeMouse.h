// SPDX-License-Identifier: BSD-3-Clause
/// The mouse as a hand that holds active nodes. A press of the left button on the body takes hold
/// of the nearest active node. A drag moves the node in the plane of the view, the wheel moves it
/// away from the viewer and back, and letting go of the button lets go of the node. A press on the
/// body where no active node is near says where one is. Such a press, a press beside the body, and
/// one with Ctrl move the camera as usual.
///
/// For that, the tool is put outside of the body beside the node, moved straight in until it is
/// attached, then to where the mouse is, and at last outside again.
#pragma once

#include "haptic/touching/touchable.h"
#include "pqPalpateMouse.h"
#include "vtkPalpateStateSpace.h"

class pqPalpateNodeMouse : public pqPalpateMouse
{
public:
  pqPalpateNodeMouse(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space,
    std::shared_ptr<const palpate::Touchable> body, std::shared_ptr<palpate::MouseMotion> motion);

  /// Goes on holding the node, where the two spaces have the same nodes.
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
    /// The tool is outside of the body, and is not drawn.
    Away,
    /// The tool is on its way to the node.
    Coming,
    Holding,
    /// The tool is on its way out.
    Leaving
  };

  palpate::Vec3 Outside() const;

  std::shared_ptr<const palpate::Touchable> Body;
  /// The half-width of the tool space of each node, m.
  std::vector<double> HalfWidths;
  Phases Phase = Phases::Away;
  /// The node at which the button was last pressed, and the node that is touched.
  int Wanted = -1;
  int Node = -1;
  palpate::Vec3 Normal = palpate::Vec3::Zero();
  /// The place where the button was pressed, and the displacement that the wheel has added, m.
  palpate::Vec3 Grip = palpate::Vec3::Zero();
  palpate::Vec3 Depth = palpate::Vec3::Zero();
  palpate::Vec3 Displacement = palpate::Vec3::Zero();
};
