// SPDX-License-Identifier: BSD-3-Clause
/// The mouse as a hand. pqPalpateNodeMouse.h says how it holds active nodes, pqPalpateToolMouse.h
/// how it moves a rigid tool, and pqPalpateReducedMouse.h how it holds a tool of a reduced body.
///
/// The mouse moves the point of a simulated board, so that it touches through the servo loop as a
/// device does. While it touches nothing, the workspace is moved instead, which puts the tool
/// elsewhere without passing the places in between.
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

  /// Goes on with what another mouse of the same kind was doing, after the space has grown.
  virtual void GoOnFrom(const pqPalpateMouse& /*other*/) {}

  /// Moves the point of the board on. Call this once a frame.
  virtual void Advance(const palpate::Tick& tick) = 0;

  /// Whether the tool is to be bonded to what it touches.
  virtual bool IsHolding() const { return false; }
  /// How far what the tool takes hold of may be from it, m; 0: as far as it is without the mouse.
  virtual double GetReach() const { return 0; }
  /// Whether the tool is a blade from now on.
  virtual void SetBlade(bool /*isBlade*/) {}
  /// Whether the tool is to be drawn, though it may touch nothing.
  virtual bool ShowsTool() const { return false; }

  /// The place of the board's centre in the scene, m.
  const palpate::Vec3& GetWorkspaceCentre() const { return this->Centre; }
  /// A hint for the person, one sentence a line; empty: there is none.
  const std::string& GetHint() const { return this->Hint; }

protected:
  /// The way of a notch of the wheel, as a share of the body's diagonal.
  static constexpr double Notch = 0.01;

  /// @param surface The surface of the body at rest.
  /// @param motion The motion of the board, whose axes are those of the scene.
  pqPalpateMouse(vtkSMRenderViewProxy* view, const palpate::Surface& surface,
    std::shared_ptr<palpate::MouseMotion> motion);

  /// Called when the left button is pressed.
  /// @return Whether the press is taken; otherwise it is the camera's.
  virtual bool Press() = 0;
  /// Called when the mouse has moved while the button is held.
  virtual void Drag() = 0;
  /// Called when the mouse has moved while the button is not held.
  virtual void Hover() {}
  /// Called when the wheel was turned while the button is held.
  /// @param notches The number of notches, positive away from the person.
  virtual void Turn(int notches) = 0;
  /// Called when Ctrl is pressed or let go.
  virtual void HoldCtrl(bool /*held*/) {}

  /// Takes over the state of another mouse.
  void TakeOver(const pqPalpateMouse& other);

  /// Finds the place of the body at rest under the pointer.
  /// @return Whether there is one.
  bool Find(palpate::Vec3& place) const;
  /// Whether a part of the body is in front of a place.
  bool IsHidden(const palpate::Vec3& place) const;
  /// The point under the pointer that is as deep in the view as a place, m.
  palpate::Vec3 PointUnderCursor(const palpate::Vec3& depthOf) const;
  /// Says where to press instead.
  /// @param what The beginning of the sentence.
  std::string WayTo(
    const char* what, const palpate::Vec3& node, const palpate::Vec3& pressed) const;
  /// The direction in which the person looks.
  palpate::Vec3 Away() const;
  bool CtrlIsHeld() const;

  void SetTarget(const palpate::Vec3& place, bool grasps = false);
  /// Puts the point to a place by moving the workspace: in the board's axes the point stands still.
  void PutTo(const palpate::Vec3& place) { this->Centre = place - this->Target; }

  /// The largest distance from an active node at which a press takes hold of it, as a share of the
  /// body's diagonal.
  static constexpr double Reach = 0.1;

  vtkWeakPointer<vtkRenderWindowInteractor> Interactor;
  vtkWeakPointer<vtkRenderer> Renderer;
  /// The body's diagonal, m.
  double Size = 0;
  /// Whether the left button is held and was pressed on a place that can be touched.
  bool Pressed = false;
  std::string Hint;

private:
  bool HandleEvent(vtkObject* sender, unsigned long event, void* data);
  /// @return Whether the event is used up, so that nobody else gets it.
  bool Handle(unsigned long event);

  std::shared_ptr<palpate::MouseMotion> Motion;
  vtkNew<vtkStaticCellLocator> Surface;
  std::vector<unsigned long> Observers;
  palpate::Vec3 Centre = palpate::Vec3::Zero();
  /// Where the board's point goes, in the board's axes, m.
  palpate::Vec3 Target = palpate::Vec3::Zero();
};

/// The button of the simulated board that Ctrl holds down.
inline constexpr int pqPalpateGraspButton = 1;
