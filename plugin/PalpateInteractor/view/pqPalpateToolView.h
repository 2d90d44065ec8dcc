// SPDX-License-Identifier: BSD-3-Clause
/// Draws over the body: the active nodes, the tool, the force on it as an arrow and in numbers
/// beside the tool, a line of text, and a grey veil where a rigid tool cannot press. These are
/// plain actors of the client, beside ParaView's representations, so that they follow without a
/// pipeline. The arrow and the tip of a bonded tool are visible through the body. A rigid tool is
/// drawn in its true size, and is transparent.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "haptic/servo/tick.h"
#include "haptic/touching/touchable.h"
#include "vtkActor.h"
#include "vtkCoordinate.h"
#include "vtkNew.h"
#include "vtkPalpateShownTool.h"
#include "vtkPalpateStateSpace.h"
#include "vtkWeakPointer.h"

class vtkPoints;
class vtkRenderer;
class vtkSMRenderViewProxy;
class vtkTextActor;

class pqPalpateToolView
{
public:
  /// @param pressable The points of the surface that a rigid tool can press; the others get a veil.
  /// @param largestForce The usual largest force, N, which sets the length of the arrow.
  /// @param beyond What is said of a force that is extrapolated.
  pqPalpateToolView(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space,
    const palpate::Touchable& body, const std::vector<char>& pressable, double largestForce,
    const char* beyond);
  /// Draws one tool of a reduced body.
  /// @param place The tool's place at rest [3], m.
  /// @param size The body's diagonal, m.
  pqPalpateToolView(
    vtkSMRenderViewProxy* view, const palpate::Vec3& place, double size, double largestForce);
  ~pqPalpateToolView();
  pqPalpateToolView(const pqPalpateToolView&) = delete;
  void operator=(const pqPalpateToolView&) = delete;

  /// @param free Whether the tool is drawn also where it touches nothing.
  /// @param depth How deep the tool is, or how far it has moved a node, m.
  void Show(const palpate::Tick& tick, bool free, double depth);
  /// Shows a tool of a reduced body, whose dot moves with it.
  /// @param has Whether a device moves the tool. Its tip is then drawn also while it does not hold.
  void ShowTool(const palpate::Contact& contact, bool has);
  /// Draws the tool in blue, so that the mouse's is told from the others.
  void MarkMouse();

  /// Writes a text at the top of the view; empty: none.
  /// @return Whether the text has changed.
  bool Say(const std::string& text);

private:
  /// The actors in the order in which they are drawn.
  std::array<vtkActor*, 6> GetActors() { return { Rims, Nodes, Veil, Mouth, Tool, Arrow }; }
  void MakeNodes(vtkPoints* places, double size);
  /// Makes the other actors, and adds all of them to the view.
  void MakeActors(vtkSMRenderViewProxy* view);
  /// Shows the tool as it is turned at a place.
  void PlaceTool(const palpate::Vec3& place);
  /// Shows the arrow, and the numbers beside the tool.
  void ShowForce(const palpate::Contact& contact, const palpate::Vec3& place, double depth);
  /// Puts the numbers beside a place, on the side where there is room.
  void PlaceNumbers(const palpate::Vec3& place);
  void MakeTip(double radius);
  void MakeRigidTool(const palpate::RigidTool& tool);
  void MakeMouth(const palpate::Surface& surface, double size);
  void MakeVeil(const palpate::Surface& surface, const std::vector<char>& pressable);

  vtkWeakPointer<vtkRenderer> Renderer;
  /// The dots have rims, so that they are visible on every colour.
  vtkNew<vtkActor> Nodes;
  vtkNew<vtkActor> Rims;
  vtkNew<vtkActor> Veil;
  /// Where a cut that opens meets the surface.
  vtkNew<vtkActor> Mouth;
  vtkNew<vtkActor> Tool;
  /// How a rigid tool is moved; null: there is none.
  palpate::PoseMapPtr Poses;
  vtkNew<vtkActor> Arrow;
  vtkNew<vtkTextActor> Text;
  /// Force and depth in numbers, and the place of the tool beside which they stand.
  vtkNew<vtkTextActor> Numbers;
  vtkNew<vtkCoordinate> NumbersPlace;
  std::string Beyond;
  /// Length of the arrow for a newton of the body, m.
  double ArrowScale = 0;
  /// The size of the tip of a blade, in those of the tool's.
  double BladeScale = 1;
  /// The least length of the arrow, m.
  double ShortestArrow = 0;
};
