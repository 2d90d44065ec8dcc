// SPDX-License-Identifier: BSD-3-Clause
/// The mouse as a hand that holds active nodes. A press of the left button on the body takes hold
/// of the nearest active node. A drag moves the node in the plane of the view, the wheel moves it
/// away from the viewer and back, and letting go of the button lets go of the node. A press on the
/// body where no active node is near says where one is. Such a press, a press beside the body, and
/// one with Ctrl move the camera as usual.
///
/// As a blade it goes in where the cut begins or is open, and a drag draws it along the cut. A node
/// that was let go of while Ctrl was held stays held, so that the mouse can become a blade.
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
  bool IsHolding() const override
  {
    return this->Phase == Phases::Holding || this->Phase == Phases::Kept;
  }
  double GetReach() const override;
  void SetBlade(bool isBlade) override;

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
    /// The node stays held, although the button is let go of.
    Kept,
    /// The tool is on its way out.
    Leaving
  };

  /// What the tool takes hold of.
  struct Grip
  {
    /// The node; −1: a blade goes in.
    int Node = -1;
    /// Where the tool goes in [3], m, and the normal of the surface there.
    palpate::Vec3 Place = palpate::Vec3::Zero();
    palpate::Vec3 Normal = palpate::Vec3::Zero();

    bool operator==(const Grip& other) const
    {
      return this->Node == other.Node && this->Place == other.Place;
    }
  };

  /// The grip for a press on a place of the body. Its hint says why there is none.
  /// @return Whether there is one.
  bool FindNode(const palpate::Vec3& pressed, Grip& grip);
  bool FindCut(const palpate::Vec3& pressed, Grip& grip);
  void PutHint();
  palpate::Vec3 Outside() const;
  /// Where the tool is to be while it is dragged.
  palpate::Vec3 Dragged(const palpate::Contact& contact) const;

  std::shared_ptr<const palpate::Touchable> Body;
  /// The half-width of the tool space of each node, m.
  std::vector<double> HalfWidths;
  Phases Phase = Phases::Away;
  bool IsBlade = false;
  /// Where the button was last pressed, and what is touched.
  Grip Wanted;
  Grip Held;
  /// The area of the cut that is open, m².
  double TornArea = 0;
  /// The place where the button was pressed, and the displacement that the wheel has added, m.
  palpate::Vec3 Pressing = palpate::Vec3::Zero();
  palpate::Vec3 Depth = palpate::Vec3::Zero();
  palpate::Vec3 Displacement = palpate::Vec3::Zero();
};
