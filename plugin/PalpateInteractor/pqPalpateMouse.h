// SPDX-License-Identifier: BSD-3-Clause
/// The mouse as a hand. A press of the left button on the body takes hold of the nearest active
/// node, a drag moves it in the plane of the view, the wheel away from the viewer and back, and
/// letting go of the button lets go of the node. A press on the body where no active node is near
/// says where one is. That one, a press beside the body, and one with Ctrl move the camera as ever.
///
/// What it moves is the point of a simulated board, so that it touches by the servo loop as a
/// device does: the tool is put outside of the node, moved straight in until it is attached, then
/// to where the mouse is, and at last outside again.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "haptic/servo/tick.h"
#include "haptic/touching/touchable.h"
#include "haptic/transport/motion.h"
#include "vtkNew.h"
#include "vtkPalpateStateSpace.h"
#include "vtkWeakPointer.h"

class vtkObject;
class vtkRenderWindowInteractor;
class vtkRenderer;
class vtkSMRenderViewProxy;
class vtkStaticCellLocator;

class pqPalpateMouse
{
public:
  /// @param motion Of the board, the axes of which are those of the scene.
  pqPalpateMouse(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space,
    std::shared_ptr<const palpate::Touchable> body, std::shared_ptr<palpate::MouseMotion> motion);
  ~pqPalpateMouse();
  pqPalpateMouse(const pqPalpateMouse&) = delete;
  void operator=(const pqPalpateMouse&) = delete;

  /// Goes on with what another one held, where the nodes of the two spaces are the same: one has
  /// grown.
  void GoOnFrom(const pqPalpateMouse& other);

  /// Moves the board's point on, once a frame.
  void Advance(const palpate::Tick& tick);

  /// Place in the scene of the board's centre, m.
  const palpate::Vec3& GetWorkspaceCentre() const { return this->Centre; }
  /// The tool is to be bonded to what it touches.
  bool IsHolding() const { return this->Phase == Phases::Holding; }
  /// What the person is told, a sentence a line; empty: all is well.
  const std::string& GetHint() const { return this->Hint; }

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

  /// @return Whether the event is the mouse's and not the camera's.
  bool HandleEvent(vtkObject* caller, unsigned long event, void* data);
  bool Press();
  /// Where to press instead.
  std::string WayToNearest(const palpate::Vec3& place) const;
  /// Something of the body is in front of it.
  bool IsHidden(const palpate::Vec3& place) const;
  void Drag();
  /// Of a pixel, in the depth of a place.
  palpate::Vec3 PointUnderCursor(const palpate::Vec3& depthOf) const;
  void SetTarget(const palpate::Vec3& place);
  palpate::Vec3 Outside() const;

  std::shared_ptr<const palpate::Touchable> Body;
  std::shared_ptr<palpate::MouseMotion> Motion;
  vtkWeakPointer<vtkRenderWindowInteractor> Interactor;
  vtkWeakPointer<vtkRenderer> Renderer;
  vtkNew<vtkStaticCellLocator> Surface;
  std::vector<unsigned long> Observers;
  /// By node, m: how far the space goes.
  std::vector<double> HalfWidths;
  double Size = 0;

  Phases Phase = Phases::Away;
  bool Pressed = false;
  std::string Hint;
  /// The node that the button was pressed at last, and the one that is touched.
  int Wanted = -1;
  int Node = -1;
  palpate::Vec3 Normal = palpate::Vec3::Zero();
  /// Where the button was pressed, and what the wheel adds, m.
  palpate::Vec3 Grip = palpate::Vec3::Zero();
  palpate::Vec3 Depth = palpate::Vec3::Zero();
  palpate::Vec3 Displacement = palpate::Vec3::Zero();
  palpate::Vec3 Centre = palpate::Vec3::Zero();
  /// Of the board's point, in its own axes, m.
  palpate::Vec3 Target = palpate::Vec3::Zero();
};
