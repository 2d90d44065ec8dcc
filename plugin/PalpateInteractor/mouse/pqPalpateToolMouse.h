// SPDX-License-Identifier: BSD-3-Clause
/// The mouse as a hand with a rigid tool. The tool hovers over the body where the pointer is. A
/// press of the left button pushes it in along the normal, a drag lets it glide at that depth, and
/// the wheel changes the depth. While Ctrl is held too, the tool holds the active node that is
/// near, if there is one; then a drag moves the node in the plane of the view, and the wheel away
/// and back. A press where the space does not reach says so. Such a press, a press beside the body,
/// and one with Ctrl move the camera as usual.
#pragma once

#include "haptic/touching/touchable.h"
#include "pqPalpateMouse.h"
#include "vtkPalpateStateSpace.h"

class pqPalpateToolMouse : public pqPalpateMouse
{
public:
  /// @param pressable The points of the surface that the tool can press.
  /// @param grows Whether more of the space becomes known while it is touched.
  pqPalpateToolMouse(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space,
    std::shared_ptr<const palpate::Touchable> body, std::shared_ptr<palpate::MouseMotion> motion,
    std::vector<char> pressable, bool grows);
  ~pqPalpateToolMouse() override;

  void GoOnFrom(const pqPalpateMouse& other) override;
  void Advance(const palpate::Tick& tick) override;
  bool IsHolding() const override { return this->Grasps; }
  bool ShowsTool() const override { return this->IsOverBody || this->Phase != Phases::Hovering; }

protected:
  bool Press() override;
  void Drag() override;
  void Hover() override;
  void Turn(int notches) override;
  void HoldCtrl(bool held) override;

private:
  enum class Phases
  {
    /// The tool is over the body, or nowhere.
    Hovering,
    /// The tool is in the body, or on its way in.
    Pressing,
    /// The tool is on its way out.
    Leaving
  };

  /// Points at the place of the surface under the pointer.
  /// @return Whether there is one, and the tool can press there.
  bool Point();
  void PointAt(const palpate::Vec3& place);
  /// The tool's place above the surface, where it surely touches nothing, and its place where it
  /// presses, m.
  palpate::Vec3 Above() const;
  palpate::Vec3 In() const;
  void ShowCursor(bool presses);

  std::shared_ptr<const palpate::Touchable> Body;
  palpate::RigidTool Shape;
  palpate::Clearance Clearance;
  std::vector<palpate::Vec3> Normals;
  std::vector<char> Pressable;
  /// The distance at which the tool touches nothing in any cell of the space, and the largest
  /// depth, m.
  double Room = 0;
  double Deepest = 0;
  std::string Welcome;
  /// What is said where the tool can press but there is no force.
  const char* IsUnknown;

  Phases Phase = Phases::Hovering;
  bool IsOverBody = false;
  /// The place of the surface that is pointed at, the normal there, and the tool's place where it
  /// touches the body at rest when it comes along that normal.
  palpate::Vec3 Pointed = palpate::Vec3::Zero();
  palpate::Vec3 Normal = palpate::Vec3::UnitZ();
  palpate::Vec3 Touching = palpate::Vec3::Zero();
  /// The depth at which the tool presses, m.
  double Depth = 0;
  /// The place to which the tool leaves.
  palpate::Vec3 Exit = palpate::Vec3::Zero();
  bool Grasps = false;
  /// The places of tool and pointer when the tool took hold, and the displacement that the wheel
  /// has added, m.
  palpate::Vec3 GraspedAt = palpate::Vec3::Zero();
  palpate::Vec3 Grip = palpate::Vec3::Zero();
  palpate::Vec3 Pulled = palpate::Vec3::Zero();
  palpate::Vec3 Dragged = palpate::Vec3::Zero();
};
