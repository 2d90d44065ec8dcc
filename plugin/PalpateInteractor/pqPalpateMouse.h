// SPDX-License-Identifier: BSD-3-Clause
/// The mouse as a hand: what it does with active nodes is in pqPalpateNodeMouse.h, what with a
/// rigid tool in pqPalpateToolMouse.h, and what with a tool of a reduced body in
/// pqPalpateReducedMouse.h.
///
/// What it moves is the point of a simulated board, so that it touches by the servo loop as a
/// device does. Where it touches nothing the workspace is moved, so that the tool is elsewhere
/// without having been in between.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "haptic/servo/tick.h"
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
  virtual ~pqPalpateMouse();
  pqPalpateMouse(const pqPalpateMouse&) = delete;
  void operator=(const pqPalpateMouse&) = delete;

  /// Goes on with what another one of the same kind did: the space has grown.
  virtual void GoOnFrom(const pqPalpateMouse& /*other*/) {}

  /// Moves the board's point on, once a frame.
  virtual void Advance(const palpate::Tick& tick) = 0;

  /// The tool is to be bonded to what it touches.
  virtual bool IsHolding() const { return false; }
  /// The tool is somewhere, though it may touch nothing.
  virtual bool ShowsTool() const { return false; }

  /// Place in the scene of the board's centre, m.
  const palpate::Vec3& GetWorkspaceCentre() const { return this->Centre; }
  /// What the person is told, a sentence a line; empty: all is well.
  const std::string& GetHint() const { return this->Hint; }

protected:
  /// Of the body's diagonal: a notch of the wheel.
  static constexpr double Notch = 0.01;

  /// @param surface Of the body at rest.
  /// @param motion Of the board, the axes of which are those of the scene.
  pqPalpateMouse(vtkSMRenderViewProxy* view, const palpate::Surface& surface,
    std::shared_ptr<palpate::MouseMotion> motion);

  /// The left button is pressed.
  /// @return Whether the event is the mouse's and not the camera's.
  virtual bool Press() = 0;
  /// It is held, and the mouse has moved.
  virtual void Drag() = 0;
  /// It is not held, and the mouse has moved.
  virtual void Hover() {}
  /// It is held, and the wheel was turned.
  /// @param notches Away from the person.
  virtual void Turn(int notches) = 0;
  /// Ctrl is held, or is not any more.
  virtual void HoldCtrl(bool /*held*/) {}

  /// Takes what another one has of all this.
  void TakeOver(const pqPalpateMouse& other);

  /// Where the body at rest is under the pointer.
  /// @return Whether it is.
  bool Find(palpate::Vec3& place) const;
  /// Something of the body is in front of a place.
  bool IsHidden(const palpate::Vec3& place) const;
  /// Of the pixel under the pointer, in the depth of a place.
  palpate::Vec3 PointUnderCursor(const palpate::Vec3& depthOf) const;
  /// Where to press instead, in words.
  /// @param what The beginning of that.
  std::string WayTo(
    const char* what, const palpate::Vec3& node, const palpate::Vec3& pressed) const;
  /// The direction in which the person looks.
  palpate::Vec3 Away() const;
  bool CtrlIsHeld() const;

  void SetTarget(const palpate::Vec3& place, bool grasps = false);
  /// The point stands still, and the workspace is moved so that it is there.
  void PutTo(const palpate::Vec3& place) { this->Centre = place - this->Target; }

  vtkWeakPointer<vtkRenderWindowInteractor> Interactor;
  vtkWeakPointer<vtkRenderer> Renderer;
  /// The body's diagonal, m.
  double Size = 0;
  /// The left button is held, and was pressed on what can be touched.
  bool Pressed = false;
  std::string Hint;

private:
  bool HandleEvent(vtkObject* sender, unsigned long event, void* data);
  /// @return Whether nobody else shall hear of it.
  bool Handle(unsigned long event);

  std::shared_ptr<palpate::MouseMotion> Motion;
  vtkNew<vtkStaticCellLocator> Surface;
  std::vector<unsigned long> Observers;
  palpate::Vec3 Centre = palpate::Vec3::Zero();
  /// Of the board's point, in its own axes, m.
  palpate::Vec3 Target = palpate::Vec3::Zero();
};

/// The button of the simulated board that Ctrl holds down.
inline constexpr int pqPalpateGraspButton = 1;
