// SPDX-License-Identifier: BSD-3-Clause
/// What is drawn over the body: the active nodes, the tool, the force on it as an arrow and in
/// numbers beside the tool, a line of text, and a grey veil where a rigid tool cannot press. Plain
/// actors of the client's own, beside ParaView's representations: they follow without a pipeline.
/// The arrow, and the tip of a bonded tool, are seen through the body; a rigid tool has its size,
/// and is seen through.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "haptic/servo/tick.h"
#include "haptic/touching/touchable.h"
#include "vtkActor.h"
#include "vtkCoordinate.h"
#include "vtkNew.h"
#include "vtkPalpateStateSpace.h"
#include "vtkWeakPointer.h"

class vtkPoints;
class vtkRenderer;
class vtkSMRenderViewProxy;
class vtkTextActor;

class pqPalpateToolView
{
public:
  pqPalpateToolView(
    vtkSMRenderViewProxy* view, const palpate::TouchSpace& space, const palpate::Touchable& body);
  /// Of one tool of a reduced body.
  /// @param place At rest [3], m.
  /// @param size The body's diagonal, m.
  /// @param largestForce That is usual, N.
  pqPalpateToolView(
    vtkSMRenderViewProxy* view, const palpate::Vec3& place, double size, double largestForce);
  ~pqPalpateToolView();
  pqPalpateToolView(const pqPalpateToolView&) = delete;
  void operator=(const pqPalpateToolView&) = delete;

  /// @param free The tool is drawn where it touches nothing, too.
  /// @param depth How deep it is, or how far it has moved a node, m.
  void Show(const palpate::Tick& tick, bool free, double depth);
  /// Of a tool of a reduced body, which takes its dot with it.
  /// @param has The tip of a tool that a device has is seen also while it does not hold.
  void ShowTool(const palpate::Contact& contact, bool has);
  /// Blue, as the tip of the mouse among others.
  void MarkMouse();

  /// Writes it at the top of the view; empty: nothing.
  /// @return Whether that is something else than before.
  bool Say(const std::string& text);

private:
  /// In the order in which they are drawn.
  std::array<vtkActor*, 5> GetActors() { return { Rims, Nodes, Veil, Tool, Arrow }; }
  void MakeNodes(vtkPoints* places, double size);
  /// The rest, and adds all to the view.
  void MakeActors(vtkSMRenderViewProxy* view);
  /// The arrow, and the numbers beside the tool.
  void ShowForce(const palpate::Contact& contact, const palpate::Vec3& place, double depth);
  /// Beside a place, on that side of it where there is room.
  void PlaceNumbers(const palpate::Vec3& place);
  void MakeTip(double radius);
  void MakeRigidTool(const palpate::RigidTool& tool);
  void MakeVeil(const palpate::Surface& surface, const std::vector<char>& pressable);

  vtkWeakPointer<vtkRenderer> Renderer;
  /// Dots with rims: seen on every colour.
  vtkNew<vtkActor> Nodes;
  vtkNew<vtkActor> Rims;
  vtkNew<vtkActor> Veil;
  vtkNew<vtkActor> Tool;
  vtkNew<vtkActor> Arrow;
  vtkNew<vtkTextActor> Text;
  /// Force and depth, and the place of the tool that they stand beside.
  vtkNew<vtkTextActor> Numbers;
  vtkNew<vtkCoordinate> NumbersPlace;
  /// Length of the arrow for a newton of the body, m.
  double ArrowScale = 0;
  /// m.
  double ShortestArrow = 0;
};
